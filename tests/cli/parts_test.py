"""Pictures made in parts: taken up again, and put together of shards."""

import os
import signal
import subprocess
import time
import unittest

from program import BINARY, Case

SCENE = ["render", "builtin:cornell", "--renderer", "path", "--size", "24x16", "--spp", "40"]


class Parts(Case):
    def bytes(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def test_merged_shards_are_the_file_of_one_run(self):
        self.run_etalon(*SCENE, "--aovs", "-o", self.path("one.exr"))
        files = []
        for part in ("2/3", "1/3", "3/3"):
            files.append(self.path(part[0] + ".exr"))
            self.run_etalon(*SCENE, "--aovs", "--shard", part, "-o", files[-1])
        run = self.run_etalon("merge", *files, "-o", self.path("merged.exr"), "-o", self.path("merged.png"), "--json")
        self.assertEqual(run.json["samples"], 40)
        self.assertEqual(self.bytes("one.exr"), self.bytes("merged.exr"))
        self.assertIn("missing: 1/3", self.run_etalon("merge", files[0], files[2], "-o", self.path("x.exr"), code=2).err)
        self.assertIn("both shard", self.run_etalon("merge", *files, files[0], "-o", self.path("x.exr"), code=2).err)
        self.assertIn("no shard", self.run_etalon("merge", self.path("one.exr"), "-o", self.path("x.exr"), code=2).err)
        self.assertFalse(os.path.exists(self.path("x.exr")))

    def test_samples_are_dealt_out_where_they_are_needed(self):
        run = self.run_etalon(*SCENE, "--adaptive", "error", "-o", self.path("a.exr"), "--json")
        self.assertLessEqual(run.json["pictures"][0]["samples"], 40)
        self.assertGreater(run.json["pictures"][0]["samples"], 30)
        self.run_etalon(*SCENE, "--adaptive", "error", "-o", self.path("b.exr"))
        self.assertEqual(self.bytes("a.exr"), self.bytes("b.exr"))
        self.assertIn(b"samples.count", self.bytes("a.exr")[:4096])
        for more in (["--shard", "1/2"], ["--resume", self.path("s")], ["--max-time", "9"]):
            self.assertIn("exclude each other", self.run_etalon(*SCENE, "--adaptive", "relmse", *more, "-o", self.path("x.exr"), code=2).err)
        raster = ["render", "builtin:cornell", "--adaptive", "error", "-o", self.path("x.exr")]
        self.assertIn("add --renderer path", self.run_etalon(*raster, code=2).err)

    def test_a_film_is_taken_up_again_and_is_the_file_of_one_run(self):
        self.run_etalon(*SCENE, "-o", self.path("one.exr"))
        state = ["--resume", self.path("state")]
        self.run_etalon(*SCENE[:-1], "7", *state, "-o", self.path("begun.exr"))
        run = self.run_etalon(*SCENE, *state, "--checkpoint", "0", "-o", self.path("resumed.exr"))
        self.assertIn("going on from 7 samples", run.err)
        self.assertEqual(self.bytes("one.exr"), self.bytes("resumed.exr"))
        for changes, what in ((["--seed", "3"], "seed is 0 there and 3 here"), (["--orbit", "1,2"], "fingerprint"),
                              (["--max-depth", "3"], "max-depth is 8 there")):
            self.assertIn(what, self.run_etalon(*SCENE, *state, *changes, "-o", self.path("x.exr"), code=2).err)
        self.assertIn("40 samples a pixel already", self.run_etalon(*SCENE[:-1], "5", *state, "-o", self.path("x.exr"), code=2).err)
        with open(self.path("state"), "r+b") as file:
            file.seek(200)
            byte = file.read(1)[0]
            file.seek(200)
            file.write(bytes([byte ^ 16]))
        self.assertIn("damaged", self.run_etalon(*SCENE, *state, "-o", self.path("x.exr"), code=2).err)
        self.assertFalse(os.path.exists(self.path("x.exr")))

    def test_what_was_killed_goes_on_from_its_last_checkpoint(self):
        command = [BINARY, *SCENE[:-1], "1000000", "--resume", self.path("state"), "--checkpoint", "0", "-o", self.path("x.png")]
        with subprocess.Popen(command, stderr=subprocess.DEVNULL) as run:
            for _ in range(600):
                time.sleep(0.05)
                if os.path.exists(self.path("state")):
                    break
            run.send_signal(signal.SIGKILL)
        again = self.run_etalon(*SCENE[:-1], "100000000", "--resume", self.path("state"), "-o", self.path("x.png"), "--max-depth", "2", code=2)
        self.assertIn("max-depth is 8 there and 2 here", again.err)  # it is whole: its settings can be read
        self.assertFalse(os.path.exists(self.path("x.png")))

    def test_options_that_do_not_go_together_are_refused(self):
        out = ["-o", self.path("x.exr")]
        for options, what in ((["--shard", "0/3"], "--shard"), (["--shard", "4/3"], "--shard"), (["--shard", "1"], "--shard"),
                              (["--checkpoint", "5"], "--resume"), (["--shard", "1/2", "--max-error", "0.1"], "exclude"),
                              (["--resume", self.path("s"), "--max-error", "0.1"], "exclude"),
                              (["--shard", "1/17"], "no rows")):
            self.assertIn(what, self.run_etalon(*SCENE, *options, *out, code=2).err)
        self.assertIn("--renderer path", self.run_etalon("render", "builtin:cornell", "--resume", self.path("s"), *out, code=2).err)
        run = self.run_etalon("render", "builtin:cornell", "builtin:spheres", "--renderer", "path", "--resume", self.path("s"),
                              "-o", self.path("{name}.exr"), code=2)
        self.assertIn("{name}", run.err)


if __name__ == "__main__":
    unittest.main()
