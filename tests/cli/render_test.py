"""What the commands make of good input."""

import json
import os
import re
import struct
import unittest
import zlib

from program import Case, glb, gltf

SMALL = ["--size", "24x16"]


def png(path):
    """Size, colour type, texts and pixel bytes (unfiltered rows not undone) of a PNG."""
    with open(path, "rb") as file:
        data = file.read()
    at, texts, pixels, header = 8, {}, b"", None
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at : at + 8])
        body = data[at + 8 : at + 8 + size]
        assert zlib.crc32(kind + body) == struct.unpack(">I", data[at + 8 + size : at + 12 + size])[0]
        at += 12 + size
        if kind == b"IHDR":
            header = struct.unpack(">IIBB", body[:10])
        elif kind == b"IDAT":
            pixels += body
        elif kind == b"tEXt":
            key, _, value = body.partition(b"\0")
            texts[key.decode()] = value.decode("latin-1")
        elif kind == b"iTXt":
            key, rest = body.split(b"\0", 1)
            texts[key.decode()] = rest[2:].split(b"\0", 2)[2].decode()
    return header, texts, zlib.decompress(pixels)


class Render(Case):
    def test_every_renderer_writes_its_picture_and_says_its_error(self):
        for renderer, error in (("raster", "error not measured"), ("reference-raster", "error not measured"),
                                ("path", r"error [\d.e-]+% \(95% interval"), ("reference", r"error [\d.e-]+% \(95% interval")):
            with self.subTest(renderer):
                run = self.run_etalon("render", "builtin:cornell", "--renderer", renderer, "--spp", "4", *SMALL, "-o", self.path("x.png"))
                self.assertRegex(run.err, error)
                header, _, _ = png(self.path("x.png"))
                self.assertEqual(header, (24, 16, 8, 6))  # 8 bits, RGBA

    def test_one_sample_says_why_it_has_no_error(self):
        run = self.run_etalon("render", "builtin:cornell", "--renderer", "reference", "--spp", "1", *SMALL, "-o", self.path("x.png"))
        self.assertIn("error not known from one sample per pixel", run.err)

    def test_pictures_carry_what_made_them(self):
        self.run_etalon("render", "builtin:cornell", "--renderer", "reference", "--spp", "3", "--seed", "7", *SMALL, "-o", self.path("x.png"))
        texts = png(self.path("x.png"))[1]
        found = {key.split(":")[-1]: value for key, value in texts.items()}
        self.assertEqual(found["seed"], "7")
        self.assertEqual(found["renderer"], "reference")
        self.assertIn("cornell", found["scene"])
        self.assertIn("spp=3", found["settings"])
        self.assertIn("CPU", found["device"])
        self.assertRegex(found["version"], r"^\d+\.\d+\.\d+")

    def test_several_scenes_share_one_start_and_get_their_names(self):
        scene = self.write("chair.glb", glb())
        run = self.run_etalon("render", scene, "builtin:triangle", *SMALL, "-o", self.path("{name}.png"), "-o", self.path("sub/{name}.exr"), "--json")
        self.assertEqual([p["scene"] for p in run.json["pictures"]], [scene, "builtin:triangle"])
        self.assert_only("chair.glb", "chair.png", "triangle.png", "sub")
        self.assertEqual(sorted(os.listdir(self.path("sub"))), ["chair.exr", "triangle.exr"])

    def test_the_same_seed_gives_the_same_bytes_and_another_does_not(self):
        for renderer in ("path", "reference"):
            films = []
            for name, seed in (("a", "1"), ("b", "1"), ("c", "2")):
                self.run_etalon("render", "builtin:cornell", "--renderer", renderer, "--spp", "4", "--seed", seed, *SMALL, "-o", self.path(name + ".exr"))
                with open(self.path(name + ".exr"), "rb") as file:
                    films.append(file.read())
            self.assertEqual(films[0], films[1])
            self.assertNotEqual(films[0], films[2])

    def test_the_number_of_threads_changes_no_bit(self):
        texts = []
        for threads in ("1", "2"):
            self.run_etalon("render", "builtin:spheres", "--renderer", "reference", "--spp", "4", "--threads", threads, *SMALL, "-o", self.path("x.exr"))
            with open(self.path("x.exr"), "rb") as file:
                texts.append(file.read())
        self.assertEqual(*texts)

    def test_a_transparent_background_is_transparent_and_a_coloured_one_is_not(self):
        alphas = {}
        for background in ("transparent", "#ff0000", "environment"):
            self.run_etalon("render", "builtin:triangle", "--background", background, "--msaa", "1", *SMALL, "-o", self.path("x.png"))
            alphas[background] = png(self.path("x.png"))[2]
        self.assertEqual(len(set(alphas.values())), 3)

    def test_a_picture_of_one_colour_is_said_loudly_and_fails_under_strict(self):
        behind = self.write("behind.glb", glb(gltf(
            cameras=[{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
            nodes=[{"mesh": 0}, {"camera": 0, "translation": [0, 0, -5]}], scenes=[{"nodes": [0, 1]}])))
        arguments = ["render", behind, *SMALL, "--environment", "none", "-o", self.path("x.png")]
        self.assertIn("one single colour", self.run_etalon(*arguments).err)
        self.assertIn("one single colour", self.run_etalon(*arguments, "--strict", code=1).err)
        ordinary = ["render", "builtin:spheres", *SMALL, "-o", self.path("y.png"), "--strict"]
        self.assertNotIn("one single colour", self.run_etalon(*ordinary).err)

    def test_both_vulkan_renderers_are_silent_under_validation(self):
        for renderer in ("raster", "path"):
            self.run_etalon("render", "builtin:cornell", "--renderer", renderer, "--spp", "2", "--validate", *SMALL, "-o", self.path("x.exr"))

    def test_every_builtin_scene_is_drawn(self):
        names = re.findall(r"builtin:[a-z-]+", self.run_etalon("completion", "fish").out.decode())
        scenes = sorted(set(names) - {"builtin:"})
        self.assertGreater(len(scenes), 5)
        run = self.run_etalon("render", *scenes, *SMALL, "-o", self.path("{name}.png"), "--json")
        self.assertEqual(len(run.json["pictures"]), len(scenes))

    def test_aovs_reach_the_file(self):
        self.run_etalon("render", "builtin:cornell", "--aovs", *SMALL, "-o", self.path("x.exr"))
        with open(self.path("x.exr"), "rb") as file:
            header = file.read(4000)
        for channel in (b"depth.Z", b"normal.X", b"albedo.R", b"object.id"):
            self.assertIn(channel, header)


class Explain(Case):
    def test_each_requirement_comes_with_its_cause(self):
        text = self.run_etalon("explain", "builtin:cornell").out.decode()
        self.assertRegex(text, r"(?m)^triangles .*mesh")
        document = self.run_etalon("explain", "builtin:cornell", "--json").json
        for row in document["required"]:
            self.assertIn(row["name"], text)
            self.assertIn(row["cause"], text)
        self.assertFalse({row["name"] for row in document["required"]} & set(document["not_required"]))

    def test_settings_change_what_is_required(self):
        def required(*options):
            return {row["name"] for row in self.run_etalon("explain", "builtin:cornell", "--json", *options).json["required"]}

        self.assertEqual(required() - required("--msaa", "1"), {"msaa"})


class Info(Case):
    def test_the_machine_is_described_and_proved(self):
        document = self.run_etalon("info", "--json").json
        self.assertEqual(sum(device["chosen"] for device in document["devices"]), 1)
        self.assertTrue(all(backend["works"] for backend in document["backends"]))
        self.assertIn("etalon", document["versions"][0])
        self.assertIn("works", self.run_etalon("info").out.decode())

    def test_a_scene_is_listed_with_the_memory_it_takes(self):
        document = self.run_etalon("info", self.write("x.glb", glb()), "--json").json
        self.assertEqual((document["counts"]["triangles"], document["counts"]["vertices"]), (1, 3))
        self.assertEqual(document["picture"], {"width": 1280, "height": 720})
        self.assertEqual(list(document["predicted_bytes"]), ["raster", "path", "reference", "reference-raster"])
        for need in document["predicted_bytes"].values():
            total = need.pop("total")
            self.assertEqual(sum(need.values()), total)
            self.assertGreater(need["picture"], 1280 * 720 * 16)
        text = self.run_etalon("info", self.path("x.glb")).out.decode()
        self.assertIn("triangles 1", text)
        self.assertRegex(text, r"\n  path about [\d.]+ MiB \(program")


class Diff(Case):
    def render(self, name, *options):
        self.run_etalon("render", "builtin:cornell", "--renderer", "reference", "--spp", "16", *SMALL, "-o", self.path(name), *options)
        return self.path(name)

    def test_equal_up_to_noise_is_0_and_different_is_1(self):
        a, b = self.render("a.exr", "--seed", "1"), self.render("b.exr", "--seed", "2")
        self.run_etalon("diff", a, a)
        self.run_etalon("diff", a, b)
        brighter = self.render("c.exr", "--environment", "none")
        self.run_etalon("diff", a, brighter, code=0)  # cornell has no environment: nothing changed
        other = self.path("d.exr")
        self.run_etalon("render", "builtin:spheres", "--renderer", "reference", "--spp", "16", *SMALL, "-o", other)
        run = self.run_etalon("diff", a, other, "-o", self.path("difference.png"), "--json", code=1)
        self.assertEqual(run.json["verdict"] if "verdict" in run.json else run.json["comparison"]["verdict"], "different")
        self.assertTrue(os.path.exists(self.path("difference.png")))

    def test_budgets_decide_where_they_are_given(self):
        a = self.render("a.png")
        b = self.render("b.png", "--exposure", "0.2")
        self.run_etalon("diff", a, b, code=1)
        self.run_etalon("diff", a, b, "--max-rmse", "10")
        self.run_etalon("diff", a, b, "--min-psnr", "90", code=1)

    def test_what_cannot_be_compared_is_bad_input(self):
        a = self.render("a.exr")
        small = self.path("small.exr")
        self.run_etalon("render", "builtin:cornell", "--renderer", "reference", "--spp", "2", "--size", "8x8", "-o", small)
        self.assertIn("size", self.run_etalon("diff", a, small, code=2).err)
        self.assertIn("absent.exr", self.run_etalon("diff", a, self.path("absent.exr"), code=2).err)
        self.assertIn("text.exr", self.run_etalon("diff", a, self.write("text.exr", b"text"), code=2).err)


class Compare(Case):
    def test_a_comparison_writes_its_report_and_prints_its_table(self):
        out = self.path("report")
        run = self.run_etalon("compare", "builtin:furnace-lambert", "--size", "32x32", "--spp", "16", "-o", out)
        files = os.listdir(out)
        for name in ("report.json", "report.html", "raster.png", "path.png", "reference.png", "path.exr", "reference.exr"):
            self.assertIn(name, files)
        self.assertIn("report.html", run.err)
        with open(os.path.join(out, "report.json"), encoding="utf-8") as file:
            report = json.load(file)
        self.assertEqual(report["scene"], "builtin:furnace-lambert")
        self.assertIn(b"path", run.out)

    def test_a_renderer_is_named_once_and_rightly(self):
        self.assertIn("did you mean path?", self.run_etalon("compare", "builtin:cornell", "--renderers", "pth,reference", code=2).err)
        self.run_etalon("compare", "builtin:cornell", "--renderers", "path,path", code=2)


if __name__ == "__main__":
    unittest.main()
