"""What goes where: data on standard output, talk on standard error, and what signals and terminals do to both."""

import json
import os
import pty
import signal
import subprocess
import time
import unittest

from program import BINARY, LIMIT_S, Case, environment, glb

SMALL = ["--size", "16x12"]
PNG = b"\x89PNG\r\n\x1a\n"
FOREVER = ["--renderer", "reference", "--spp", "1000000000", "--size", "16x16"]  # years


class Streams(Case):
    def test_a_picture_file_leaves_standard_output_empty(self):
        run = self.run_etalon("render", "builtin:triangle", *SMALL, "-o", self.path("x.png"))
        self.assertEqual(run.out, b"")
        self.assertIn("x.png: 16x12", run.err)

    def test_a_picture_on_standard_output_is_nothing_but_a_png(self):
        run = self.run_etalon("render", "builtin:triangle", *SMALL, "-o", "-", "-o", self.path("same.png"))
        with open(self.path("same.png"), "rb") as file:
            self.assertEqual(run.out, file.read())
        self.assertTrue(run.out.startswith(PNG) and run.out.endswith(b"IEND\xaeB`\x82"))

    def test_a_scene_comes_from_standard_input(self):
        file = self.write("x.glb", glb())
        piped = self.run_etalon("render", "-", *SMALL, "-o", "-", stdin=glb()).out
        read = self.run_etalon("render", file, *SMALL, "-o", "-").out
        pixels = [data[data.index(b"IDAT") :] for data in (piped, read)]  # the names in the metadata differ
        self.assertEqual(*pixels)

    def test_json_is_one_document_and_progress_json_one_a_line(self):
        run = self.run_etalon("render", "builtin:cornell", "--renderer", "reference", "--spp", "8", *SMALL, "--json", "--progress", "json",
                              "-o", self.path("x.exr"))
        picture = run.json["pictures"][0]
        self.assertEqual((picture["width"], picture["height"], picture["samples"]), (16, 12, 8))
        self.assertLessEqual(picture["error"]["low"], picture["error"]["relative"])
        self.assertLessEqual(picture["error"]["relative"], picture["error"]["high"])
        events = [json.loads(line) for line in run.err.splitlines() if line.startswith("{")]
        self.assertTrue(events)
        for event in events:
            self.assertEqual(event["event"], "progress")
            self.assertTrue(0 <= event["fraction"] <= 1)

    def test_progress_none_says_nothing_but_the_result(self):
        run = self.run_etalon("render", "builtin:triangle", *SMALL, "--progress", "none", "-o", self.path("x.png"))
        self.assertEqual(len([line for line in run.err.splitlines() if "x.png" not in line and "builtin:triangle:" not in line]), 0, run.err)

    def test_a_closed_pipe_is_no_failure(self):
        for command in (["man"], ["render", "builtin:triangle", *SMALL, "-o", "-"], ["explain", "builtin:cornell", "--json"]):
            with self.subTest(command[0]):
                reader, writer = os.pipe()
                os.close(reader)
                with os.fdopen(writer, "wb") as pipe:
                    done = subprocess.run([BINARY, *command], stdout=pipe, stderr=subprocess.PIPE, timeout=LIMIT_S)
                self.assertEqual(done.returncode, 0, done.stderr)

    def test_a_full_disk_under_standard_output_ends_with_3(self):
        for command in (["man"], ["man", "--jsno", "--json"]):
            with open("/dev/full", "wb") as full:
                done = subprocess.run([BINARY, *command], stdout=full, stderr=subprocess.PIPE, timeout=LIMIT_S)
            self.assertEqual(done.returncode, 3 if len(command) == 1 else 2)
            self.assertNotEqual(done.stderr, b"")

    def test_paths_may_hold_spaces_and_any_letter(self):
        scene = self.write("a chair für 日本.glb", glb())
        run = self.run_etalon("render", scene, *SMALL, "-o", self.path("out {name}.png"), "--json")
        self.assert_only("a chair für 日本.glb", "out a chair für 日本.png")
        self.assertEqual(run.json["pictures"][0]["outputs"], [self.path("out a chair für 日本.png")])

    def test_home_may_be_unset_and_the_locale_any(self):
        for changes in ({"HOME": None}, {"LC_ALL": "de_DE.UTF-8"}, {"LC_ALL": "nonsense"}):
            env = environment(**changes)
            first = self.run_etalon("render", "builtin:triangle", *SMALL, "-o", "-", env=env).out
            self.assertEqual(first, self.run_etalon("render", "builtin:triangle", *SMALL, "-o", "-").out)


class Terminal(Case):
    def on_terminal(self, arguments, **changes):
        """Runs with standard error on a terminal; returns what it showed."""
        master, slave = pty.openpty()
        process = subprocess.Popen([BINARY, *arguments], stdout=subprocess.DEVNULL, stderr=slave, env=environment(TERM="xterm", **changes))
        os.close(slave)
        shown = b""
        while True:
            try:
                block = os.read(master, 65536)
            except OSError:  # the program closed its end
                break
            if not block:
                break
            shown += block
        os.close(master)
        process.wait(LIMIT_S)
        return shown.decode()

    def test_errors_are_coloured_on_a_terminal_unless_no_color(self):
        self.assertIn("\033[31m", self.on_terminal(["explain", "absent.glb"], NO_COLOR=None))
        self.assertIn("\033[31m", self.on_terminal(["explain", "absent.glb"], NO_COLOR=""))
        self.assertNotIn("\033", self.on_terminal(["explain", "absent.glb"], NO_COLOR="1"))
        self.assertNotIn("\033", self.run_etalon("explain", "absent.glb", code=2).err)

    def test_a_bar_with_the_error_so_far_is_shown_and_wiped(self):
        shown = self.on_terminal(["render", "builtin:cornell", "--renderer", "reference", "--spp", "256", "--size", "48x48", "-o", self.path("x.exr")])
        self.assertRegex(shown, r"\[=* *\] +\d+% cornell: path tracing")
        self.assertRegex(shown, r"error \d+\.\d+%")
        self.assertRegex(shown, r"\r\033\[K[^\[]*x\.exr: 48x48")


class Interrupted(Case):
    def start(self, *arguments):
        """A render that would take years, once it has samples to show for it."""
        process = subprocess.Popen([BINARY, "render", "builtin:cornell", *arguments, "--progress", "json", "-o", self.path("x.exr")],
                                   stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        for line in process.stderr:
            if line.startswith("{") and (json.loads(line)["samples"] or 0) >= 2:
                return process
        self.fail("it ended by itself")

    def check_interrupted(self, *arguments):
        process = self.start(*arguments)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=LIMIT_S)
        self.assertEqual(process.returncode, 130, err)
        self.assertRegex(err, r"x\.exr: .* spp, .*error [\d.]+% \(95% interval")
        self.assert_only("x.exr")
        self.run_etalon("diff", self.path("x.exr"), self.path("x.exr"))
        return out

    def test_the_reference_writes_what_there_is_and_ends_with_130(self):
        out = self.check_interrupted(*FOREVER, "--json")
        self.assertTrue(json.loads(out)["pictures"][0]["interrupted"])

    def test_the_path_tracer_writes_what_there_is_and_ends_with_130(self):
        self.check_interrupted("--renderer", "path", "--spp", "100000000", "--size", "16x16")

    def test_the_path_tracer_answers_within_its_first_pass(self):
        # Eight million pixels take seconds; the mark of progress below comes after a step of 50 ms.
        process = subprocess.Popen([BINARY, "render", "builtin:cornell", "--renderer", "path", "--spp", "2", "--size", "3840x2160", "--json",
                                    "--progress", "json", "-o", self.path("x.exr")], stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        for line in process.stderr:
            if line.startswith("{") and json.loads(line)["samples"] == 0:
                break
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=LIMIT_S)
        self.assertEqual(process.returncode, 130, err)
        self.assertRegex(err, r"interrupted in the first pass: \d+ of 8294400 pixels have no sample")
        picture = json.loads(out)["pictures"][0]
        self.assertEqual(picture["samples"], 1)
        self.assertGreater(picture["pixels_without_samples"], 0)
        self.assertLess(picture["pixels_without_samples"], 8294400)

    def test_a_second_signal_stops_at_once_and_leaves_nothing(self):
        process = self.start("--renderer", "reference", "--spp", "1000000000", "--size", "1024x1024")
        process.send_signal(signal.SIGINT)
        process.send_signal(signal.SIGTERM)
        started = time.monotonic()
        process.communicate(timeout=LIMIT_S)
        self.assertIn(process.returncode, (130, 143))  # of two that wait, the kernel chooses the first
        self.assertLess(time.monotonic() - started, LIMIT_S / 2)
        self.assertNotIn("x.exr", os.listdir(self.folder))


if __name__ == "__main__":
    unittest.main()
