"""What runs need in memory is predicted and refused with need against have; where memory ends all the same, it is said."""

import os
import re
import resource
import subprocess
import sys
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "cli"))
from program import BINARY, Case, environment  # noqa: E402

MIB = 1 << 20
EVERY = os.environ.get("ETALON_FAULTS") == "every"
SANITIZED = os.environ.get("ETALON_SANITIZED") == "1"  # reserves terabytes of address space


class Measured:
    """A run with what it held at most, and under a limit on its address space."""

    def __init__(self, *arguments, address_space=None):
        def limit():
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            if address_space is not None:
                resource.setrlimit(resource.RLIMIT_AS, (address_space, address_space))

        with subprocess.Popen([BINARY, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=limit,
                              env=environment(HOME="/nonexistent")) as process:
            self.out, err = process.stdout.read(), process.stderr.read()
            _, status, used = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        self.code, self.err, self.peak = process.returncode, err.decode("utf-8", "replace"), used.ru_maxrss * 1024


def in_bytes(text):
    number, unit = re.fullmatch(r"([\d.]+) (\w+)", text).groups()
    return float(number) * 1024 ** ["bytes", "KiB", "MiB", "GiB", "TiB"].index(unit)


class MemoryIsPredicted(Case):
    def needed(self, *arguments):
        run = Measured("render", *arguments, "-o", self.path("never.png"), "--memory", "1M", "--progress", "none")
        self.assertEqual(run.code, 3, run.err)
        found = re.search(r"needs about ([\d.]+ \w+) of memory .* it may have 1.0 MiB", run.err)
        self.assertTrue(found, run.err)
        self.assert_only()
        return in_bytes(found.group(1))

    def test_a_picture_too_large_is_refused_before_anything_is_read(self):
        most = 1 << 50 if SANITIZED else 64 * MIB
        for arguments in (["--size", "30000x30000", "--memory", "16G"], ["--size", "2000x2000", "--memory", "200M"]):
            run = Measured("render", "missing.glb", *arguments, "-o", self.path("never.png"))
            self.assertEqual(run.code, 3, run.err)
            self.assertRegex(run.err, r"this needs about .* of memory .*; it may have \d")
            self.assertLess(run.peak, most)
        self.assert_only()

    def test_the_limits_of_a_size_follow_the_level(self):
        self.assertEqual(self.run_etalon("render", "builtin:triangle", "--size", "9000x1", "--limits", "strict", "-o",
                                         self.path("a.png"), code=2).code, 2)
        self.run_etalon("render", "builtin:triangle", "--size", "100000x1", "--limits", "none", "-o", self.path("a.png"),
                        code=2)

    def test_bytes_are_read_with_their_suffix(self):
        for text in ("much", "-1", "0", "4X", "", "1e30"):
            run = self.run_etalon("info", "builtin:triangle", "--memory", text, code=2)
            self.assertIn("--memory", run.err)
        for text in ("1000000000", "800M", "1.5GiB", "4GB", "2T"):
            self.run_etalon("info", "builtin:triangle", "--memory", text)

    def test_what_is_too_much_is_made_smaller_when_asked_and_said(self):
        arguments = ["render", "builtin:triangle", "--renderer", "reference", "--spp", "4", "--size", "640x400", "--progress",
                     "none", "--json", "-o", self.path("a.exr")]
        whole = self.run_etalon(*arguments, "--degrade").json["pictures"][0]
        self.assertEqual((whole["width"], whole["degraded"]), (640, None))
        self.assertNotIn("bias", whole["error_text"])
        program = 134 * MIB  # what the libraries take; the picture takes 304 bytes a pixel, a quarter of it fits
        room = ["--memory", str(program + 304 * 640 * 400 // 3)]
        self.run_etalon(*arguments, *room, code=3)
        run = self.run_etalon(*arguments, *room, "--degrade")
        less = run.json["pictures"][0]
        self.assertEqual((less["width"], less["height"]), (320, 200))
        self.assertEqual(less["degraded"], "320x200 pixels instead of 640x400")
        self.assertIn("without the bias of --degrade, not measured", less["error_text"])
        self.assertIn("degraded to fit into memory", run.err)
        run = self.run_etalon(*arguments, "--memory", "100M", "--degrade", code=3)
        self.assertIn("needs about", run.err)

    @unittest.skipIf(SANITIZED, "a sanitizer's shadow counts as memory held")
    def test_the_prediction_is_good_to_a_half(self):
        for renderer in ("raster", "path", "reference", "reference-raster"):
            for size in ("64x64", "800x800"):
                arguments = ["builtin:triangle", "--renderer", renderer, "--size", size, "--spp", "1"]
                run = Measured("render", *arguments, "--progress", "none", "-o", self.path("a.png"))
                self.assertEqual(run.code, 0, run.err)
                os.remove(self.path("a.png"))
                self.assertLess(max(run.peak / self.needed(*arguments), self.needed(*arguments) / run.peak), 1.5,
                                f"{arguments}: {run.peak / MIB:.0f} MiB")


@unittest.skipIf(SANITIZED, "a sanitizer needs the address space")
class MemoryEnds(Case):
    """Address space from 200 MB up in steps of 5%: refused, then failing with a sentence, then the same picture."""

    def sweep(self, renderer):
        arguments = ["render", "builtin:maps", "--renderer", renderer, "--size", "64x64", "--spp", "2", "--progress", "none",
                     "--memory", "4G", "-o", self.path("a.png")]
        whole = Measured(*arguments)
        self.assertEqual(whole.code, 0, whole.err)
        with open(self.path("a.png"), "rb") as file:
            expected = file.read()
        codes = []
        step = 1.05 if EVERY else 1.25
        space = 200e6
        while space < 3e9:
            if os.path.exists(self.path("a.png")):
                os.remove(self.path("a.png"))
            if Measured("--version", address_space=int(space)).code != 0:  # no room for the libraries: main is not reached
                space *= step
                continue
            run = Measured(*arguments, address_space=int(space))
            codes.append(run.code)
            what = f"{renderer} in {space / 1e6:.0f} MB: {run.code}\n{run.err}"
            self.assertIn(run.code, (0, 3), what)
            if run.code == 0:
                with open(self.path("a.png"), "rb") as file:
                    self.assertEqual(file.read(), expected, what)
            else:
                self.assertRegex(run.err, r"(?m)^etalon: ", what)
                self.assert_only()
            space *= step
        self.assertEqual(codes[-1], 0)

    def test_of_the_rasterizer(self):
        self.sweep("raster")

    def test_of_the_path_tracer(self):
        self.sweep("path")

    def test_of_the_reference(self):
        self.sweep("reference")

    def test_of_the_reference_rasterizer(self):
        self.sweep("reference-raster")
