"""Plants one breach of each rule in a small house and expects tools/check_house to find it, and nothing else."""

import os
import subprocess
import sys
import tempfile
import unittest

CHECK = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tools", "check_house")

KNOB = 'constexpr std::array kKnobs = {\n    Knob{.name = "spp", .what = "samples", .buys = "time", .costs = "noise"},\n};\n'
CLEAN = {
    "engine/base/error.h": "#pragma once\n",
    "engine/scene/knobs.cpp": '#include "engine/base/error.h"\n' + KNOB,
    "engine/reference/path.cpp": '// (SH-1)\n#include "engine/scene/knobs.h"\n',
    "shaders/lib/lambert.glsl": "// (SH-1) as docs/shading.md\n",
    "docs/shading.md": "# Shading\n- (SH-1) f = rho/pi\n\n| knob | |\n|---|---|\n| `spp` | samples |\n\nSee [above](#shading) and [base](../engine/base/error.h).\n",
    "tests/unit/scene/knobs_test.cpp": 'if (folder.empty())\n    GTEST_SKIP() << "no input";\n',
}
# What is planted, and the rule that must find it.
BREACHES = {
    "an include that points up": ("engine/base/a.cpp", '#include "engine/scene/scene.h"\n', "layers"),
    "a room that is in no table": ("engine/attic/a.cpp", '#include "engine/base/error.h"\n', "layers"),
    "the reference reads a shader's formula": ("engine/reference/a.cpp", '#include "shaders/lib/lambert.glsl"\n', "layers"),
    "the reference uses a renderer": ("engine/reference/a.cpp", '#include "engine/render/render.h"\n', "layers"),
    "the device layer knows scenes": ("engine/gpu/a.cpp", '#include "engine/scene/scene.h"\n', "layers"),
    "a scene knows Vulkan": ("engine/scene/a.cpp", "#include <vulkan/vulkan.h>\n", "layers"),
    "a product includes a test": ("tools/etalon/a.cpp", '#include "tests/support/nasty.h"\n', "layers"),
    "two includers of a heavy header": ("tools/a.cpp", "#include <CLI/CLI.hpp>\n", "single includer"),
    "JSON in a room that has no format": ("engine/render/a.cpp", "#include <nlohmann/json.hpp>\n", "single includer"),
    "an equation that is stated nowhere": ("shaders/lib/a.glsl", "// (SH-99)\n", "equations"),
    "a knob that no run has measured": ("docs/tradeoffs.md", "# Knobs\n<!-- measured: begin -->\n<!-- measured: end -->\n", "knobs"),
    "a link that leads nowhere": ("docs/a.md", "[x](absent.md)\n", "links"),
    "an anchor that is not there": ("docs/a.md", "[x](shading.md#absent)\n", "links"),
    "code switched off": ("engine/base/a.cpp", "#if 0\n#endif\n", "disabled"),
    "a disabled test": ("tests/unit/a.cpp", "TEST(Film, DISABLED_x)\n", "disabled"),
    "an unconditional skip": ("tests/unit/a.cpp", "TEST(Film, x)\n{\n    GTEST_SKIP();\n}\n", "disabled"),
    "a file of a thousand lines": ("engine/base/a.cpp", "\n" * 1000, "size"),
    "a path of one machine": ("tools/a", "cd /ho" + "me/somebody\n", "machine paths"),
}


def check(files):
    with tempfile.TemporaryDirectory() as root:
        for name, text in files.items():
            path = os.path.join(root, name)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
        done = subprocess.run([sys.executable, CHECK, root], capture_output=True, text=True, timeout=60)
        return done.returncode, done.stdout


class CheckHouse(unittest.TestCase):
    def test_a_clean_house_passes(self):
        self.assertEqual(check(CLEAN)[0], 0, check(CLEAN)[1])

    def test_each_breach_is_found_by_its_rule_alone(self):
        for why, (path, text, rule) in BREACHES.items():
            with self.subTest(why):
                files = {**CLEAN, path: text}
                if rule == "single includer" and "CLI" in text:
                    files["tools/b.cpp"] = text
                code, out = check(files)
                faults = [line for line in out.splitlines()[:-1] if "warning" not in line]
                self.assertEqual(code, 1)
                self.assertTrue(faults and all(f": {rule}: " in line for line in faults), out)

    def test_an_equation_that_only_shaders_cite_is_found(self):
        code, out = check({**CLEAN, "engine/reference/path.cpp": ""})
        self.assertEqual(code, 1)
        self.assertIn("SH-1 is cited by no reference and no test", out)

    def test_a_knob_without_a_row_or_a_cost_is_found(self):
        code, out = check({**CLEAN, "engine/scene/knobs.cpp": KNOB.replace('.costs = "noise"', '.costs = ""').replace("spp", "spq")})
        self.assertEqual(code, 1)
        self.assertIn("spq does not say .costs", out)
        self.assertIn("spq has no row", out)


if __name__ == "__main__":
    unittest.main()
