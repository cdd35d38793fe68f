"""What is left on disk when writing fails, falls short or is killed: the old file or the whole new one, and nothing else."""

import errno
import os
import random
import resource
import shutil
import signal
import subprocess
import time
import unittest

from program import BINARY, LIMIT_S, Case, environment, glb

FAULTY_IO = os.environ["ETALON_FAULTY_IO"]
OLD = b"the old picture"
PICTURE = ["render", "builtin:triangle", "--renderer", "reference-raster", "--size", "16x16", "--progress", "none"]
REPORT = ["compare", "builtin:triangle", "--renderers", "reference-raster,reference", "--size", "8x8", "--spp", "2", "--progress", "none"]


def faulty(words):
    """An environment in which system calls go wrong as faulty_io.cpp says."""
    preload = " ".join(filter(None, (os.environ.get("LD_PRELOAD"), FAULTY_IO)))
    return environment(FAULTY_IO=words, LD_PRELOAD=preload, ASAN_OPTIONS="verify_asan_link_order=0")


class WriteCase(Case):
    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def whole_picture(self, name):
        """The bytes that an undisturbed run writes under this name."""
        os.mkdir(self.path("elsewhere"))
        self.run_etalon(*PICTURE, "-o", os.path.join(self.path("elsewhere"), name))
        content = self.read(os.path.join("elsewhere", name))
        shutil.rmtree(self.path("elsewhere"))
        return content


class Killed(WriteCase):
    """Every call and every instant in replace_file itself: tests/unit/base. Here, that everything goes through it."""

    def test_death_at_random_instants_leaves_the_old_picture_or_the_new_one_and_the_next_run_cleans_up(self):
        new = self.whole_picture("x.exr")
        started = time.monotonic()
        self.run_etalon(*PICTURE, "-o", self.path("x.exr"))
        lifetime = time.monotonic() - started
        self.write("x.exr", OLD)
        instants = random.Random(5)
        for _ in range(20):
            process = subprocess.Popen([BINARY, *PICTURE, "-o", self.path("x.exr")], stderr=subprocess.DEVNULL)
            time.sleep(instants.uniform(0, lifetime))
            process.kill()
            process.wait()
            self.assertIn(self.read("x.exr"), (OLD, new))
        self.run_etalon(*PICTURE, "-o", self.path("x.exr"))
        self.assertEqual(self.read("x.exr"), new)
        self.assert_only("x.exr")

    def test_death_before_the_new_picture_has_its_name_is_swept_by_the_next_run(self):
        for name in ("x.exr", "x.png"):
            self.write(name, OLD)
            self.run_etalon(*PICTURE, "-o", self.path(name), code=-signal.SIGKILL, env=faulty("rename=kill"))
            self.assertEqual(self.read(name), OLD)
            self.assertEqual(len(os.listdir(self.folder)), 2)
            self.run_etalon(*PICTURE, "-o", self.path(name))
            self.assert_only(name)
            os.remove(self.path(name))

    def test_a_report_that_is_killed_has_no_torn_files(self):
        self.run_etalon(*REPORT, "-o", self.path("whole"), code=0)
        self.run_etalon(*REPORT, "-o", self.path("out"), code=-signal.SIGKILL, env=faulty("linkat=killed"))
        names = os.listdir(self.path("out"))
        self.assertEqual(len(names), 1)
        self.assertNotIn("report.html", names)
        self.assertEqual(self.read(f"out/{names[0]}"), self.read(f"whole/{names[0]}"))


class Failing(WriteCase):
    def test_a_failing_disk_is_said_and_keeps_the_old_picture(self):
        for name in ("x.exr", "x.png"):
            self.write(name, OLD)
            run = self.run_etalon(*PICTURE, "-o", self.path(name), code=3, env=faulty(f"fsync={errno.EIO}"))
            self.assertIn(name, run.err)
            self.assertIn("Input/output error", run.err)
            self.assertEqual(self.read(name), OLD)
            self.assert_only(name)
            os.remove(self.path(name))

    def test_short_and_interrupted_calls_change_no_bit(self):
        scene = self.write("a.glb", glb())
        command = ["render", scene, *PICTURE[2:], "-o", self.path("x.exr"), "-o", self.path("x.png")]
        self.run_etalon(*command)
        whole = self.read("x.exr"), self.read("x.png")
        self.run_etalon(*command, env=faulty("read=short write=short"))
        self.assertEqual((self.read("x.exr"), self.read("x.png")), whole)

    def test_a_report_that_cannot_be_written_ends_with_3(self):
        run = self.run_etalon(*REPORT, "-o", self.path("out"), code=3, env=faulty(f"fsync={errno.ENOSPC}"))
        self.assertIn("No space left", run.err)
        self.assertEqual(os.listdir(self.path("out")), [])

    def test_the_limit_on_the_size_of_files_is_an_error_and_no_death(self):
        self.write("x.exr", OLD)
        done = subprocess.run([BINARY, *PICTURE, "-o", self.path("x.exr")], capture_output=True, text=True, timeout=LIMIT_S,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000)))
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("ulimit -f", done.stderr)
        self.assertEqual(self.read("x.exr"), OLD)
        self.assert_only("x.exr")


class Disks(WriteCase):
    """On disks of their own, which only root can mount, in a name space of mounts that ends with the test."""

    def on_disk(self, options, *steps):
        """Runs shell steps in a new disk of these mount options; $ETALON renders the picture."""
        disk = self.path("disk")
        os.makedirs(disk, exist_ok=True)
        picture = " ".join(f"'{word}'" for word in (BINARY, *PICTURE))
        script = "\n".join([f"mount -t tmpfs -o {options} tmpfs '{disk}' || exit 77", f"cd '{disk}'", *steps]).replace("ETALON", picture)
        done = subprocess.run(["unshare", "--mount", "sh", "-c", script], capture_output=True, text=True, timeout=LIMIT_S)
        if done.returncode == 77 or (done.returncode == 1 and "unshare" in done.stderr):
            self.skipTest(f"cannot mount a disk here: {done.stderr.strip()}")
        return done

    def test_a_full_disk_keeps_the_old_picture(self):
        done = self.on_disk("size=1m", "echo old > x.exr", "cat /dev/zero > filler 2> /dev/null", "ETALON -o x.exr", "echo code $?", "cat x.exr", "ls -A")
        self.assertEqual(done.stdout.split(), ["code", "3", "old", "filler", "x.exr"], done.stderr)
        self.assertIn("free some space", done.stderr)

    def test_a_disk_with_room_for_a_part_of_the_picture_likewise(self):
        # Files take whole pages of 4096 bytes: the noise of 64x64 pixels takes more than the one that is left.
        noise = f"'{BINARY}' render builtin:cornell --renderer reference --spp 2 --size 64x64 --progress none -o x.exr"
        done = self.on_disk("size=8k", "echo old > x.exr", noise, "echo code $?", "cat x.exr", "ls -A")
        self.assertEqual(done.stdout.split(), ["code", "3", "old", "x.exr"], done.stderr)

    def test_a_full_quota_likewise(self):
        user = "setpriv --reuid 65534 --clear-groups"
        done = self.on_disk("mode=1777,usrquota,usrquota_block_hardlimit=4k", f"{user} sh -c 'echo old > x.exr'", f"{user} ETALON -o x.exr",
                            "echo code $?", "cat x.exr", "ls -A")
        self.assertEqual(done.stdout.split(), ["code", "3", "old", "x.exr"], done.stderr)
        self.assertIn("uota", done.stderr)

    def test_a_disk_for_reading_is_refused_before_rendering(self):
        done = self.on_disk("size=1m", "echo old > x.exr", "mount -o remount,ro .", "ETALON --spp 1000000000 -o x.exr", "echo code $?", "cat x.exr")
        self.assertEqual(done.stdout.split(), ["code", "2", "old"], done.stderr)
        self.assertIn("Read-only", done.stderr)


class Refused(WriteCase):
    FOREVER = ["render", "builtin:cornell", "--renderer", "reference", "--spp", "1000000000"]

    def test_devices_pipes_and_what_is_behind_links_are_refused_before_rendering(self):
        os.mkfifo(self.path("pipe.png"))
        os.symlink("/dev/full", self.path("full.png"))
        os.symlink("loop.png", self.path("loop.png"))
        for name in ("pipe.png", "full.png", "loop.png"):
            self.assertIn(name, self.run_etalon(*self.FOREVER, "-o", self.path(name), code=2).err)
        self.assert_only("full.png", "loop.png", "pipe.png")

    def test_a_report_that_could_not_be_written_is_refused_before_rendering(self):
        self.write("file", b"kept")
        for folder in ("file", "file/below"):
            run = self.run_etalon("compare", "builtin:cornell", "--spp", "1000000000", "-o", os.path.join(self.folder, folder), code=2)
            self.assertIn(folder, run.err)
        self.assert_only("file")


class Stopped(WriteCase):
    def start(self, **options):
        command = ["render", "builtin:cornell", "--renderer", "reference", "--spp", "1000000000", "--size", "16x16", "--progress", "json"]
        process = subprocess.Popen([BINARY, *command, "-o", self.path("x.exr")], stderr=subprocess.PIPE, text=True, **options)
        self.addCleanup(process.kill)
        for line in process.stderr:
            if '"samples":' in line and '"samples":null' not in line:
                return process
        self.fail("it ended by itself")

    def test_sigterm_and_sighup_write_what_there_is_and_end_as_shells_count_them(self):
        for number, code in ((signal.SIGTERM, 143), (signal.SIGHUP, 129)):
            process = self.start()
            process.send_signal(number)
            process.communicate(timeout=LIMIT_S)
            self.assertEqual(process.returncode, code)
            self.assert_only("x.exr")
            self.run_etalon("diff", self.path("x.exr"), self.path("x.exr"))

    def test_a_signal_that_was_ignored_stays_ignored(self):
        process = self.start(preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))  # as nohup does
        process.send_signal(signal.SIGHUP)
        with self.assertRaises(subprocess.TimeoutExpired):
            process.wait(timeout=0.5)
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=LIMIT_S)
        self.assertEqual(process.returncode, 143)


if __name__ == "__main__":
    unittest.main()
