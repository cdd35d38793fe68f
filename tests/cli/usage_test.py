"""What is typed: commands, options, help, completion, manual."""

import re
import shutil
import subprocess
import unittest

from program import BINARY, Case, Run, environment

# A call of each command that is complete but for what a test breaks in it.
COMMANDS = {
    "render": ["builtin:cornell", "-o", "x.png"],
    "compare": ["builtin:cornell"],
    "diff": ["a.exr", "b.exr"],
    "explain": ["builtin:cornell"],
    "info": [],
    "view": ["builtin:cornell"],
    "completion": ["bash"],
    "man": [],
}


class Usage(Case):
    def test_nothing_typed_is_bad_usage_and_shows_the_commands(self):
        run = self.run_etalon(code=2)
        self.assertEqual(run.out, b"")
        for command in COMMANDS:
            self.assertIn(f"  {command}", run.err)

    def test_help_and_version_are_data(self):
        self.assertIn(b"usage: etalon", self.run_etalon("--help").out)
        self.assertRegex(self.run_etalon("--version").out.decode(), r"^etalon \d+\.\d+\.\d+")
        for command in COMMANDS:
            run = self.run_etalon(command, "--help")
            self.assertEqual(run.err, "")
            self.assertIn(b"Examples:\n  ", run.out)
            self.assertIn(b"Exit codes: ", run.out)

    def test_a_misspelt_command_names_the_nearest(self):
        run = self.run_etalon("redner", "x.glb", code=2)
        self.assertIn("no command 'redner'", run.err)
        self.assertIn("did you mean render?", run.err)
        self.assertNotIn("did you mean", self.run_etalon("xyzzy", code=2).err)

    def test_a_misspelt_option_names_the_nearest(self):
        for command, arguments in COMMANDS.items():
            run = self.run_etalon(command, *arguments, "--jsno", code=2)
            self.assertIn("--jsno", run.err)
            self.assertIn("did you mean --json?", run.err)
        self.assertIn("did you mean --size?", self.run_etalon("render", "builtin:cornell", "--sizee=3x3", code=2).err)

    def test_an_option_without_its_value_is_bad_usage(self):
        self.assertIn("--size", self.run_etalon("render", "builtin:cornell", "-o", "x.png", "--size", code=2).err)

    def test_an_option_given_twice_is_bad_usage(self):
        self.assertIn("given 2 times", self.run_etalon("render", "builtin:cornell", "--spp", "1", "--spp", "2", code=2).err)

    def test_a_wrong_choice_names_the_choices_and_the_nearest(self):
        run = self.run_etalon("render", "builtin:cornell", "-o", "x.png", "--renderer", "rester", code=2)
        self.assertIn("raster, path, reference", run.err)
        self.assertIn("did you mean --renderer raster?", run.err)

    def test_missing_and_surplus_arguments_are_bad_usage(self):
        for command, arguments in COMMANDS.items():
            if command == "render":
                continue  # takes any number of scenes
            run = self.run_etalon(command, *arguments, "one", "two", "three", code=2)
            self.assertIn("no place for", run.err)
        for command in ("render", "compare", "diff", "explain", "view", "completion"):
            self.assertIn("needs", self.run_etalon(command, code=2).err)

    def test_render_needs_to_know_where_to_write(self):
        self.assertIn("-o FILE.png", self.run_etalon("render", "builtin:cornell", code=2).err)

    def test_values_out_of_their_range_are_bad_usage(self):
        for option, value in (("--size", "0x0"), ("--size", "100000x100000"), ("--size", "12"), ("--size", "axb"), ("--size", "-3x4"),
                              ("--spp", "0"), ("--spp", "many"), ("--max-depth", "0"), ("--msaa", "3"), ("--exposure", "nan"),
                              ("--orbit", "1"), ("--orbit", "0,95"), ("--orbit", "0,0,-1"), ("--background", "#12"), ("--scene", "-1"),
                              ("--seed", "1.5"), ("--environment-intensity", "-1")):
            with self.subTest(option=option, value=value):
                run = self.run_etalon("render", "builtin:cornell", "-o", self.path("x.png"), option, value, code=2)
                self.assertIn(option.strip("-"), run.err)
                self.assert_only()

    def test_a_failure_is_json_too(self):
        for command, arguments in COMMANDS.items():
            document = self.run_etalon(command, *arguments, "--jsn", "--json", code=2).json
            self.assertEqual(document["schema"], "etalon-error/1")
            self.assertEqual(document["error"]["exit_code"], 2)
            self.assertIn("--jsn", document["error"]["what"])

    def test_numbers_and_paths_do_not_depend_on_the_locale(self):
        changes = {"LANG": "de_DE.UTF-8", "LC_ALL": "de_DE.UTF-8", "LC_NUMERIC": "de_DE.UTF-8", "HOME": None}
        arguments = ["explain", "builtin:cornell", "--orbit", "10.5,20.25,3.5", "--json"]
        self.assertEqual(Run(arguments, env=environment(**changes)).out, Run(arguments).out)


class Shells(Case):
    def check(self, shell, *command):
        if shutil.which(command[0]) is None:
            self.skipTest(f"no {command[0]} here")
        script = self.write(f"completion.{shell}", self.run_etalon("completion", shell).out)
        done = subprocess.run([*command, script], capture_output=True, text=True, timeout=60)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_the_shells_can_read_their_completions(self):
        self.check("bash", "bash", "-n")

    def test_zsh_can_read_its_completion(self):
        self.check("zsh", "zsh", "-n")

    def test_fish_can_read_its_completion(self):
        self.check("fish", "fish", "--no-execute")

    def complete(self, *words):
        script = self.write("completion.bash", self.run_etalon("completion", "bash").out)
        text = "source '{}'; COMP_WORDS=({}); COMP_CWORD={}; _etalon; printf '%s\\n' \"${{COMPREPLY[@]}}\"".format(
            script, " ".join(f"'{w}'" for w in words), len(words) - 1)
        return subprocess.run(["bash", "-c", text], capture_output=True, text=True, timeout=60, cwd=self.folder).stdout.split()

    def test_bash_completes_commands_options_choices_and_scenes(self):
        self.assertEqual(self.complete("etalon", "ren"), ["render"])
        self.assertIn("--size", self.complete("etalon", "render", "--si"))
        self.assertEqual(self.complete("etalon", "render", "--renderer", "ra"), ["raster"])
        self.assertIn("builtin:cornell", self.complete("etalon", "explain", "builtin:c"))

    def test_an_unknown_shell_is_bad_usage(self):
        self.assertIn("bash, zsh, fish", self.run_etalon("completion", "tcsh", code=2).err)

    def test_the_manual_is_clean_roff_and_holds_every_option_of_the_help(self):
        page = self.run_etalon("man").out
        for command in COMMANDS:
            for option in re.findall(r"--[a-z-]+", self.run_etalon(command, "--help").out.decode()):
                self.assertIn(option.replace("-", "\\-").encode(), page)
        if shutil.which("groff"):
            done = subprocess.run(["groff", "-man", "-Tutf8", "-ww", "-z"], input=page, capture_output=True, timeout=60)
            self.assertEqual((done.returncode, done.stderr), (0, b""))


if __name__ == "__main__":
    unittest.main()
