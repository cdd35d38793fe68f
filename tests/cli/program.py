"""Runs the etalon program, and makes the small files that it is fed with."""

import json
import os
import struct
import subprocess
import tempfile
import unittest

BINARY = os.environ["ETALON_BINARY"]
LIMIT_S = 120  # a hang is a failure; everything here takes a second or so


def environment(**changes):
    """The environment of the tests with some variables changed; None removes one."""
    env = dict(os.environ)
    for name, value in changes.items():
        env.pop(name, None)
        if value is not None:
            env[name] = value
    return env


NO_VULKAN = {"VK_DRIVER_FILES": "/nonexistent.json", "VK_ICD_FILENAMES": "/nonexistent.json"}


class Run:
    """What one run of the program left behind."""

    def __init__(self, arguments, stdin=b"", env=None, cwd=None):
        done = subprocess.run([BINARY, *arguments], input=stdin, capture_output=True, env=env, cwd=cwd, timeout=LIMIT_S)
        self.code, self.out, self.err = done.returncode, done.stdout, done.stderr.decode("utf-8", "replace")

    @property
    def json(self):
        return json.loads(self.out)


class Case(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self):
        holder = tempfile.TemporaryDirectory(prefix="etalon cli ")
        self.addCleanup(holder.cleanup)
        self.folder = holder.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, content):
        with open(self.path(name), "wb") as file:
            file.write(content)
        return self.path(name)

    def run_etalon(self, *arguments, code=0, **options):
        run = Run(arguments, **options)
        self.assertEqual(run.code, code, f"etalon {arguments}\n{run.err}")
        return run

    def assert_only(self, *names):
        """Nothing else was left in the folder: no half-written file, no temporary."""
        self.assertEqual(sorted(os.listdir(self.folder)), sorted(names))


def gltf(**changes):
    """One triangle in front of a default view, as a glTF value with its buffer apart."""
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36}],
    }
    document.update(changes)
    return document


TRIANGLE = (-1, -1, 0, 1, -1, 0, 0, 1, 0)


def glb(document=None, floats=TRIANGLE):
    """A GLB of a glTF value and the floats of its buffer."""
    text = json.dumps(document or gltf()).encode()
    text += b" " * (-len(text) % 4)
    data = struct.pack(f"<{len(floats)}f", *floats)
    body = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
    return b"glTF" + struct.pack("<II", 2, 12 + len(body)) + body
