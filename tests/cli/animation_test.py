"""--time, --animation and --frames."""

import os

from program import TRIANGLE, Case, glb, gltf

SMALL = ["--size", "32x24", "--spp", "1"]


def moving():
    """A triangle that two animations take to the right, by one metre and by two."""
    document = gltf()
    times, near, far = (0, 1), (0, 0, 0, 1, 0, 0), (0, 0, 0, 2, 0, 0)
    floats = (*TRIANGLE, *times, *near, *far)
    for offset, size, kind, in ((36, 8, "SCALAR"), (44, 24, "VEC3"), (68, 24, "VEC3")):
        document["bufferViews"].append({"buffer": 0, "byteOffset": offset, "byteLength": size})
        document["accessors"].append({"bufferView": len(document["bufferViews"]) - 1, "componentType": 5126, "count": 2,
                                      "type": kind, **({"min": [0], "max": [1]} if kind == "SCALAR" else {})})
    document["buffers"][0]["byteLength"] = 4 * len(floats)
    document["animations"] = [
        {"name": name, "samplers": [{"input": 1, "output": output}],
         "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}
        for name, output in (("near", 2), ("far", 3))]
    return glb(document, floats)


class Animation(Case):
    def bytes_of(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def test_a_time_and_an_animation_choose_the_pose(self):
        scene = self.write("moving.glb", moving())
        # The camera looks straight at the middle of what it sees, and the picture says where it stands.
        view = [*SMALL, "--orbit", "0,0,6", "--renderer", "reference-raster"]
        for x, options in ((0, []), (0, ["--time", "0"]), (0.5, ["--time", "0.5"]), (1, ["--time", "1e6"]),
                           (2, ["--time", "1", "--animation", "far"]), (2, ["--time", "1", "--animation", "1"]),
                           (0, ["--animation", "far"]), (2, ["--time", "1", "--animation", "all"])):
            done = self.run_etalon("render", scene, *view, *options, "-o", self.path("f.png"), "--json")
            self.assertEqual(done.json["pictures"][0]["time_seconds"], float(options[1]) if options[:1] == ["--time"] else None)
            camera = self.bytes_of("f.png").split(b"world_from_camera\0")[1].split(b" ")[:16]
            self.assertAlmostEqual(float(camera[12]), x, msg=str(options))
        info = self.run_etalon("info", scene, "--json").json["animations"]
        self.assertEqual([(a["name"], a["duration_seconds"], a["channels"]) for a in info],
                         [("near", 1, 1), ("far", 1, 1)])

    def test_frames_are_numbered_and_keep_their_view(self):
        scene = self.write("moving.glb", moving())
        done = self.run_etalon("render", scene, *SMALL, "--renderer", "reference-raster", "--frames", "9:11", "--fps",
                               "10", "-o", self.path("f.###.png"), "--json")
        self.assert_only("f.009.png", "f.010.png", "f.011.png", "moving.glb")
        self.assertEqual([(p["frame"], p["time_seconds"]) for p in done.json["pictures"]], [(9, 0.9), (10, 1.0), (11, 1.1)])
        self.assertNotEqual(self.bytes_of("f.009.png"), self.bytes_of("f.010.png"), "it moves in a view that stands still")

    def test_what_is_wrong_is_said_before_any_work(self):
        scene = self.write("moving.glb", moving())
        for options, words in ((["--frames", "0:3", "-o", "f.png"], "no place for the frame's number"),
                               (["--frames", "3:0", "-o", "####.png"], "--frames takes A:B"),
                               (["--frames", "x", "-o", "####.png"], "--frames takes A:B"),
                               (["--frames", "0:2", "--time", "1", "-o", "####.png"], "exclude each other"),
                               (["--frames", "0:9000000", "-o", "####.png"], "at most"),
                               (["--time", "soon", "-o", "f.png"], "--time takes"),
                               (["--animation", "fra", "-o", "f.png"], 'no animation "fra"')):
            done = self.run_etalon("render", scene, *SMALL, *options, code=2, cwd=self.folder)
            self.assertIn(words, done.err)
        self.assert_only("moving.glb")
        self.assertFalse(os.path.exists(self.path("f.png")))
