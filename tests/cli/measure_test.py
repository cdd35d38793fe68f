"""Pictures that say their error, and pictures within a time."""

import json
import os
import time
import unittest

from program import Case
from render_test import png

SCENE = ["builtin:texture-plane", "--size", "48x32"]


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


class Explained(Case):
    def test_costs_are_said_and_specialising_changes_no_pixel(self):
        run = self.run_etalon("explain", *SCENE, "--renderer", "path", "--spp", "1", "--measure", "--json")
        costs = run.json["costs"]
        shade = [shader for shader in costs["shaders"] if shader["shader"] == "path/shade.comp"][0]
        self.assertLess(shade["instructions_specialised"], shade["instructions"] / 2)
        self.assertLessEqual(costs["attribute_bytes"], costs["attribute_bytes_uber"])
        self.assertTrue(costs["measured"]["identical"])


if __name__ == "__main__":
    unittest.main()
