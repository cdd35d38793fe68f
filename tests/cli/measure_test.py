"""Pictures that say their error, and pictures within a time."""

import base64
import json
import os
import struct
import time
import unittest
import zlib

from program import Case, environment, gltf
from render_test import png

SCENE = ["builtin:texture-plane", "--size", "48x32"]


def data_uri(kind, content):
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"


def png_of(width, height, texel):
    """A picture of one colour."""
    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    rows = (b"\0" + bytes(texel) * width) * height
    header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def white_scene():
    """A triangle with a white texture and a second set of coordinates that nothing reads."""
    corners = struct.pack("<9f", -1, -1, 0, 1, -1, 0, 0, 1, 0)
    coordinates = struct.pack("<6f", 0, 1, 1, 1, 0.5, 0)
    accessor = {"componentType": 5126, "count": 3}
    return gltf(
        meshes=[{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1, "TEXCOORD_1": 1}, "material": 0}]}],
        materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        textures=[{"source": 0}],
        images=[{"uri": data_uri("image/png", png_of(4, 4, (255, 255, 255, 255)))}],
        accessors=[{**accessor, "bufferView": 0, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]},
                   {**accessor, "bufferView": 1, "type": "VEC2"}],
        bufferViews=[{"buffer": 0, "byteOffset": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24}],
        buffers=[{"byteLength": 60, "uri": data_uri("application/octet-stream", corners + coordinates)}])


class MeasuredPictures(Case):
    def test_a_rasterized_picture_says_its_error_in_words_in_its_texts_and_beside_it(self):
        run = self.run_etalon("render", *SCENE, "--error", "--json", "-o", self.path("x.png"), "-o", self.path("x.exr"))
        self.assertRegex(run.err, r"error [\d.]+% \(95% interval [\d.]+% to [\d.]+%\), [\d.]+ of 255 display steps")
        _, texts, _ = png(self.path("x.png"))
        self.assert_only("x.png", "x.exr", "x.error.json")
        with open(self.path("x.error.json"), encoding="utf-8") as file:
            error = json.load(file)
        self.assertEqual(error["schema"], "etalon-picture-error/1")
        self.assertLess(error["relative"]["low"], error["relative"]["value"])
        self.assertLess(error["relative"]["value"], error["relative"]["high"])
        self.assertEqual(len(error["map"]["relative"]), error["map"]["columns"] * error["map"]["rows"])
        said = [texts[key] for key in texts if key.endswith("error.relative")]
        self.assertAlmostEqual(float(said[0].split()[0]), error["relative"]["value"], delta=1e-3)
        self.assertEqual(run.json["pictures"][0]["picture_error"]["text"], error["text"])

    def test_the_same_settings_say_the_same_error(self):
        for name in ("a", "b"):
            self.run_etalon("render", *SCENE, "--error", "-o", self.path(name + ".png"))
        with open(self.path("a.png"), "rb") as a, open(self.path("b.png"), "rb") as b:
            self.assertEqual(a.read(), b.read())

    def test_time_is_for_renderers_that_can_stop(self):
        run = self.run_etalon("render", *SCENE, "--max-time", "5", "-o", self.path("x.png"), code=2)
        self.assertIn("--renderer path", run.err)
        self.assert_only()

    def test_a_picture_comes_in_its_time_with_as_many_samples_as_fit(self):
        run = self.run_etalon("render", *SCENE, "--renderer", "reference", "--max-time", "2", "--json", "-o", self.path("x.png"))
        self.assertRegex(run.err, r"[\d.]+ s of 2 s asked")
        picture = run.json["pictures"][0]
        self.assertGreaterEqual(picture["samples"], 1)
        self.assertFalse(picture["interrupted"], "the time that was asked for is no interruption")

    def test_the_most_samples_end_it_before_the_time(self):
        begin = time.monotonic()
        run = self.run_etalon("render", *SCENE, "--renderer", "reference", "--max-time", "60", "--spp", "2", "--json", "-o", self.path("x.png"))
        self.assertEqual(run.json["pictures"][0]["samples"], 2)
        self.assertLess(time.monotonic() - begin, 50)


class ChosenByTheFrontier(Case):
    def test_the_rasterizer_takes_what_was_measured_of_this_scene_alone(self):
        env = environment(XDG_CACHE_HOME=self.folder)
        picture = ["-o", self.path("x.png")]
        unknown = self.run_etalon("render", *SCENE, "--max-error", "0.5", *picture, code=2, env=env)
        self.assertIn("etalon tradeoff", unknown.err)
        self.run_etalon("tradeoff", *SCENE, "--renderer", "raster", "--quick", "--budget", "2", "--spp", "4", "-o", self.path("report"), env=env)
        self.assertIn("chosen --renderer raster", self.run_etalon("render", *SCENE, "--max-error", "5", *picture, env=env).err)
        self.assertIn("--renderer path", self.run_etalon("render", *SCENE, "--max-error", "1e-6", *picture, env=env).err)
        timed = self.run_etalon("render", SCENE[0], "--size", "24x16", "--max-time", "60", *picture, env=env)
        self.assertRegex(timed.err, "expected to take .* s here")
        self.run_etalon("render", *SCENE, "--orbit", "30,20", "--max-error", "5", *picture, code=2, env=env)


class Explained(Case):
    def test_costs_are_said_and_specialising_changes_no_pixel(self):
        run = self.run_etalon("explain", *SCENE, "--renderer", "path", "--spp", "1", "--measure", "--budget", "4", "--json")
        costs = run.json["costs"]
        shade = [shader for shader in costs["shaders"] if shader["shader"].startswith("path/shade") or shader["shader"].startswith("path/fused")][0]
        self.assertLess(shade["instructions_specialised"], shade["instructions"] / 2)
        self.assertLessEqual(costs["data"]["vertex_bytes"], costs["data_uber"]["vertex_bytes"])
        measured = costs["measured"]
        self.assertTrue(measured["identical"])
        self.assertGreater(measured["uber"]["memory_bytes"], 0)
        self.assertGreater(len(measured["special"]["picture_seconds"]), 0)
        self.assertTrue(all(row["needed"] or "instructions" in row["costs"] for row in run.json["required"]))

    def test_what_no_picture_shows_is_left_out_and_told_to_the_author(self):
        path = self.write("white.gltf", json.dumps(white_scene()).encode())
        run = self.run_etalon("explain", path, "--json")
        self.assertEqual([row["pointer"] for row in run.json["left_out"]], ["/materials/0/pbrMetallicRoughness/baseColorTexture"])
        self.assertNotIn("base_color_texture", [row["name"] for row in run.json["required"]])
        said = {row["code"]: row["pointers"] for row in run.json["suggestions"]}
        self.assertEqual(said["MESH_PRIMITIVE_UNUSED_TEXCOORD"], ["/meshes/0/primitives/0/attributes/TEXCOORD_1"])
        self.assertIn("/materials/0/pbrMetallicRoughness/baseColorTexture", said[None])
        text = self.run_etalon("explain", path).out.decode()
        self.assertIn("for the author of the scene", text)
        self.assertRegex(text, r"models \d+ of \d+ features: \d+% of the instructions")


if __name__ == "__main__":
    unittest.main()
