"""The same pixels whatever the locale, the environment, the folder, the standard streams and the driver's cache are like."""

import os
import shutil
import subprocess
import unittest

from program import BINARY, LIMIT_S, Case, environment, glb

PICTURE = ["--size", "24x16", "--progress", "none"]
DEVICE = ["render", "builtin:cornell", "--renderer", "raster", *PICTURE]
REFERENCE = ["render", "builtin:cornell", "--renderer", "reference-raster", *PICTURE]


class Surroundings(Case):
    plain = {}  # by renderer: drawn once

    def run_in(self, command, prefix="exec", cwd=None, **changes):
        """The PNG that a command writes on x.png; `prefix` is what a shell does before."""
        target = os.path.join(self.folder, "x.png")
        if os.path.exists(target):
            os.remove(target)
        script = prefix.replace("exec", 'exec "$@"', 1)
        done = subprocess.run(["sh", "-c", script, "sh", BINARY, *command, "-o", target], capture_output=True, env=environment(**changes), cwd=cwd, timeout=LIMIT_S)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(target, "rb") as file:
            return file.read()

    def check(self, *places, **changes):
        for command in (DEVICE, REFERENCE):
            with self.subTest(renderer=command[3]):
                self.assertEqual(self.run_in(command, *places, **changes), self.plain_picture(command))

    def plain_picture(self, command):
        if command[3] not in self.plain:
            self.plain[command[3]] = self.run_in(command)
        return self.plain[command[3]]

    def test_without_home_and_cache_folder(self):
        self.check(HOME=None, XDG_CACHE_HOME=None, XDG_RUNTIME_DIR=None, USER=None, PATH="/nowhere:/bin:/usr/bin")
        self.check(HOME="/nonexistent", XDG_CACHE_HOME="/nonexistent", MESA_SHADER_CACHE_DIR="/nonexistent")

    def test_under_a_mask_that_shuts_others_out(self):
        self.run_in(REFERENCE, "umask 077; exec")
        self.assertEqual(os.stat(self.path("x.png")).st_mode & 0o777, 0o600)
        self.check("umask 077; exec")

    def test_with_standard_streams_closed(self):
        for closed in ("<&-", ">&-", "2>&-", "<&- >&- 2>&-"):
            self.check(f"exec {closed}")

    def test_a_closed_standard_output_is_an_error_for_what_goes_there(self):
        script = 'exec "$@" >&-'
        for arguments in (["man"], [*REFERENCE, "-o", "-"]):
            done = subprocess.run(["sh", "-c", script, "sh", BINARY, *arguments], capture_output=True, timeout=LIMIT_S)
            self.assertEqual(done.returncode, 3, done.stderr)
        done = subprocess.run(["sh", "-c", 'exec "$@" <&-', "sh", BINARY, "info", "-"], capture_output=True, timeout=LIMIT_S)
        self.assertEqual(done.returncode, 2, done.stderr)

    def test_in_a_folder_that_is_gone(self):
        for command in (DEVICE, REFERENCE):
            os.makedirs(self.path("gone"), exist_ok=True)
            self.assertEqual(self.run_in(command, 'rmdir "$PWD"; exec', cwd=self.path("gone")), self.plain_picture(command))


class Locales(Case):
    def test_with_decimal_commas(self):
        """A locale of decimal commas, made here where the system has none."""
        if "de_DE.utf8" not in subprocess.run(["locale", "-a"], capture_output=True, text=True).stdout.split():
            made = subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", self.path("de_DE.UTF-8")], capture_output=True) if shutil.which("localedef") else None
            if made is None or made.returncode > 1:
                self.skipTest("no locale with decimal commas here, and none can be made (package locales)")
        env = environment(LC_ALL="de_DE.UTF-8", LANG="de_DE.UTF-8", LOCPATH=self.path(""))
        scene = self.write("a.glb", glb())
        for command in (["render", scene, *PICTURE, "--exposure", "0.5", "-o", "-"], ["info", scene, "--json"], ["explain", scene, "--orbit", "10.5,20.25,3.5", "--json"]):
            self.assertEqual(self.run_etalon(*command, env=env).out, self.run_etalon(*command).out)


class Names(Case):
    def test_paths_that_are_no_text_are_read_and_written(self):
        folder = os.path.join(os.fsencode(self.folder), b"\xff\xfe \n")
        os.mkdir(folder)
        with open(os.path.join(folder, b"\x80.glb"), "wb") as file:
            file.write(glb())
        scene, picture = os.path.join(folder, b"\x80.glb"), os.path.join(folder, b"\xc0.png")
        run = self.run_etalon("render", scene, *PICTURE, "-o", picture, "--json")
        self.assertEqual(run.json["pictures"][0]["width"], 24)
        self.assertEqual(sorted(os.listdir(folder)), [b"\x80.glb", b"\xc0.png"])
        with open(picture, "rb") as file:
            pixels = file.read()
        plain = self.run_etalon("render", self.write("a.glb", glb()), *PICTURE, "-o", "-").out
        self.assertEqual(pixels[pixels.index(b"IDAT") :], plain[plain.index(b"IDAT") :])


class DriverCache(Case):
    """The program keeps no cache of its own; the driver's is the driver's, and must not come into the picture."""

    def setUp(self):
        super().setUp()
        self.cache = self.path("cache")
        self.env = environment(MESA_SHADER_CACHE_DIR=self.cache, XDG_CACHE_HOME=self.cache, MESA_SHADER_CACHE_DISABLE="false")

    def files(self):
        return [os.path.join(folder, name) for folder, _, names in os.walk(self.cache) for name in names]

    def picture(self, **options):
        return self.run_etalon(*DEVICE, "-o", "-", **options).out

    def test_eight_processes_at_once_on_one_cache_draw_the_same(self):
        plain = self.picture()
        running = [subprocess.Popen([BINARY, *DEVICE, "-o", "-"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=self.env) for _ in range(8)]
        for process in running:
            out, err = process.communicate(timeout=LIMIT_S)
            self.assertEqual((process.returncode, out == plain), (0, True), err)

    def test_a_cache_that_is_cut_or_foreign_is_not_believed(self):
        plain = self.picture(env=self.env)
        if not self.files():
            self.skipTest("the driver here keeps no cache")
        for spoil in (lambda data: data[: len(data) // 2], lambda data: b"", lambda data: bytes(b ^ 0x5A for b in data)):
            for path in self.files():
                with open(path, "rb") as file:
                    data = file.read()
                with open(path, "wb") as file:
                    file.write(spoil(data))
            self.assertEqual(self.picture(env=self.env), plain)


if __name__ == "__main__":
    unittest.main()
