"""Bad input: every command says where and what, ends with the right code and leaves nothing half done."""

import json
import os
import unittest

from program import Case, NO_VULKAN, environment, glb, gltf

NAN = float("nan")


def broken_scenes():
    """Name, content, and a word that the message must hold."""
    whole = glb()
    accessor = gltf()["accessors"][0]
    return {
        "empty.glb": (b"", "empty.glb"),
        "truncated.glb": (whole[: len(whole) - 20], "truncated.glb"),
        "header.glb": (whole[:7], "header.glb"),
        "magic.glb": (b"PK\x03\x04" + whole[4:], "magic.glb"),
        "garbage.gltf": (b'{"asset": {"version": "2.0"}, "nodes": [', "garbage.gltf"),
        "binary.gltf": (bytes(range(256)), "binary.gltf"),
        "number.gltf": (b"42", "number.gltf"),
        "version.gltf": (b'{"asset": {"version": "7.0"}}', "version"),
        "range.glb": (glb(gltf(accessors=[{**accessor, "count": 1000}])), "/accessors/0"),
        "nowhere.glb": (glb(gltf(nodes=[{"mesh": 9}])), "/nodes/0"),
        "nan.glb": (glb(floats=(0, 0, 0, NAN, 0, 0, 0, 1, 0)), "finite"),
        "cycle.glb": (glb(gltf(nodes=[{"children": [1], "mesh": 0}, {"children": [0]}])), "/nodes"),
        "extension.glb": (glb(gltf(extensionsRequired=["EXT_made_up"], extensionsUsed=["EXT_made_up"])), "EXT_made_up"),
        "escape.gltf": (json.dumps(gltf(buffers=[{"byteLength": 36, "uri": "../../../../etc/hostname"}])).encode(), "/buffers/0"),
    }


class Scenes(Case):
    def test_broken_scenes_are_refused_with_where_and_what(self):
        for name, (content, word) in broken_scenes().items():
            with self.subTest(name):
                path = self.write(name, content)
                run = self.run_etalon("render", path, "-o", self.path("picture.png"), "--size", "16x16", code=2)
                self.assertIn(name, run.err)
                self.assertIn(word, run.err)
                self.assertFalse(os.path.exists(self.path("picture.png")))

    def test_every_command_that_takes_a_scene_refuses_a_broken_one_alike(self):
        path = self.write("truncated.glb", glb()[:-20])
        for command in (["explain", path], ["info", path], ["compare", path, "-o", self.path("out")], ["view", path]):
            with self.subTest(command[0]):
                self.assertIn("truncated.glb", self.run_etalon(*command, code=2).err)
                self.assert_only("truncated.glb")

    def test_missing_files_and_folders_are_refused(self):
        for command in (["render", "{}", "-o", "x.png"], ["explain", "{}"], ["info", "{}"], ["compare", "{}"], ["view", "{}"]):
            for target in (self.path("absent.glb"), self.folder):
                with self.subTest(command=command[0], target=target):
                    run = self.run_etalon(*[word.format(target) for word in command], code=2, cwd=self.folder)
                    self.assertIn(os.path.basename(target), run.err)
        self.assert_only()

    def test_names_that_look_like_options_or_are_no_text_are_names(self):
        with open(self.path("-odd.glb"), "wb") as file:
            file.write(glb())
        self.run_etalon("explain", "--", "-odd.glb", cwd=self.folder)
        self.assertEqual(self.run_etalon("explain", b"\xff.glb", "--json", code=2, cwd=self.folder).json["error"]["exit_code"], 2)

    def test_an_unknown_builtin_scene_is_refused(self):
        self.assertIn("cornell", self.run_etalon("explain", "builtin:cornel", code=2).err)

    def test_an_absent_texture_is_refused_by_its_name(self):
        document = gltf(images=[{"uri": "absent.png"}], textures=[{"source": 0}],
                        materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
                        meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}])
        path = self.write("textured.glb", glb(document))
        self.assertIn("absent.png", self.run_etalon("render", path, "-o", self.path("x.png"), "--size", "16x16", code=2).err)
        self.assert_only("textured.glb")

    def test_strict_turns_warnings_into_errors(self):
        path = self.write("optional.glb", glb(gltf(extensionsUsed=["EXT_made_up"], nodes=[{"mesh": 0, "extensions": {"EXT_made_up": {}}}])))
        self.assertIn("EXT_made_up", self.run_etalon("explain", path).err)
        self.assertIn("EXT_made_up", self.run_etalon("explain", path, "--strict", code=2).err)

    def test_empty_standard_input_is_refused(self):
        self.assertIn("standard input", self.run_etalon("explain", "-", code=2).err)

    def test_cameras_and_scenes_that_are_not_there_are_refused(self):
        self.assertIn("99", self.run_etalon("explain", "builtin:cornell", "--scene", "99", code=2).err)
        self.assertIn("nobody", self.run_etalon("explain", "builtin:cornell", "--camera", "nobody", code=2).err)
        self.run_etalon("explain", "builtin:cornell", "--camera", "0", "--orbit", "0,0", code=2)

    def test_a_broken_environment_is_refused(self):
        bad = self.write("sky.exr", b"not an exr")
        for target in (bad, self.path("absent.hdr")):
            run = self.run_etalon("render", "builtin:spheres", "-o", self.path("x.png"), "--environment", target, code=2)
            self.assertIn(os.path.basename(target), run.err)
        self.assert_only("sky.exr")


class Outputs(Case):
    def test_outputs_that_cannot_be_written_are_refused_before_rendering(self):
        self.write("file", b"kept")
        os.mkdir(self.path("folder.png"))
        for output in ("/proc/absent/x.png", self.path("file/x.png"), self.path("folder.png"), self.path("x"), self.path("x.jpg")):
            with self.subTest(output):
                # So many samples that rendering first would run into the time limit.
                self.run_etalon("render", "builtin:cornell", "--renderer", "reference", "--spp", "1000000000", "-o", output, code=2)
        self.assert_only("file", "folder.png")

    def test_two_pictures_never_go_to_one_file(self):
        run = self.run_etalon("render", "builtin:cornell", "builtin:spheres", "-o", self.path("x.png"), code=2)
        self.assertIn("{name}", run.err)

    def test_a_picture_and_json_do_not_share_standard_output(self):
        self.assertIn("--json", self.run_etalon("render", "builtin:cornell", "-o", "-", "--json", code=2).err)

    def test_a_report_folder_that_is_a_file_is_refused(self):
        self.write("file", b"kept")
        self.run_etalon("compare", "builtin:triangle", "-o", self.path("file"), "--size", "8x8", "--spp", "2", "--renderers",
                        "reference,reference-raster", code=2)
        self.assert_only("file")


class Devices(Case):
    def test_without_a_vulkan_device_the_vulkan_renderers_end_with_3_and_reasons(self):
        env = environment(**NO_VULKAN)
        for renderer in ("raster", "path"):
            run = self.run_etalon("render", "builtin:triangle", "--renderer", renderer, "--backend", "vulkan", "-o", self.path("x.png"), "--json",
                                  code=3, env=env)
            self.assertIn("Vulkan", run.err)
            self.assertEqual(run.json["error"]["exit_code"], 3)
        self.run_etalon("compare", "builtin:triangle", "-o", self.path("out"), code=3, env=env)
        self.assert_only()

    def test_without_vulkan_the_rasterizer_draws_by_opengl_and_says_so(self):
        os.mkdir(self.path("libraries"))
        self.hide("libvulkan.so", "libvulkan.so.1")
        for env in (environment(**NO_VULKAN), environment(LD_LIBRARY_PATH=self.path("libraries"))):
            run = self.run_etalon("render", "builtin:triangle", "--size", "16x16", "--json", "-o", self.path("x.png"), env=env)
            self.assertIn("OpenGL", run.out.decode())
            document = self.run_etalon("info", "--json", env=env).json
            works = {backend["name"]: backend["works"] for backend in document["backends"]}
            self.assertEqual(works, {"vulkan": False, "opengl": True, "reference": True})

    def test_without_vulkan_and_opengl_both_are_said(self):
        os.mkdir(self.path("libraries"))
        self.hide("libvulkan.so", "libvulkan.so.1", "libEGL.so.1", "libOSMesa.so.8")
        env = environment(LD_LIBRARY_PATH=self.path("libraries"))
        run = self.run_etalon("render", "builtin:triangle", "-o", self.path("x.png"), code=3, env=env)
        for word in ("Vulkan loader", "libEGL.so.1", "libOSMesa.so.8"):
            self.assertIn(word, run.err)
        self.run_etalon("info", code=3, env=env)
        self.run_etalon("render", "builtin:triangle", "--renderer", "reference", "--spp", "2", "--size", "16x16", "-o", self.path("y.png"), env=env)
        self.assert_only("libraries", "y.png")

    def test_where_there_is_no_egl_osmesa_draws(self):
        os.mkdir(self.path("libraries"))
        self.hide("libEGL.so.1")
        run = self.run_etalon("render", "builtin:triangle", "--backend", "opengl", "--size", "16x16", "--json", "-o", self.path("x.png"),
                              env=environment(LD_LIBRARY_PATH=self.path("libraries")))
        self.assertIn("OSMesa", run.out.decode())

    def test_the_path_tracer_does_not_draw_by_opengl(self):
        run = self.run_etalon("render", "builtin:triangle", "--renderer", "path", "--backend", "opengl", "-o", self.path("x.png"), code=2)
        self.assertIn("Vulkan alone", run.err)
        self.assert_only()

    def hide(self, *libraries):
        """Files that the loader finds first and cannot open."""
        for name in libraries:
            self.write(os.path.join("libraries", name), b"")

    def test_without_a_vulkan_device_the_reference_still_works(self):
        self.run_etalon("render", "builtin:triangle", "--renderer", "reference", "--spp", "2", "--size", "16x16", "-o", self.path("x.png"),
                        env=environment(**NO_VULKAN))
        self.assert_only("x.png")

    def test_without_a_vulkan_loader_that_is_said(self):
        os.mkdir(self.path("libraries"))
        for name in ("libvulkan.so", "libvulkan.so.1"):
            self.write(os.path.join("libraries", name), b"")
        run = self.run_etalon("render", "builtin:triangle", "--backend", "vulkan", "-o", self.path("x.png"), code=3,
                              env=environment(LD_LIBRARY_PATH=self.path("libraries")))
        self.assertIn("loader", run.err)
        self.assert_only("libraries")

    def test_a_window_without_a_display_ends_with_3(self):
        run = self.run_etalon("view", "builtin:triangle", code=3, env=environment(DISPLAY=None, WAYLAND_DISPLAY=None))
        self.assertIn("display", run.err.lower())

    def test_a_device_that_is_not_there_ends_with_3_and_reasons(self):
        self.assertIn("nobody's card", self.run_etalon("render", "builtin:triangle", "--device", "nobody's card", "-o", self.path("x.png"), code=3).err)
        self.assert_only()

    def test_the_wrong_kind_of_device_ends_with_3_and_reasons(self):
        machine = self.run_etalon("info", "--json").json
        kinds = {device["kind"] for device in machine["devices"]}
        absent = {"cpu", "gpu"} - kinds
        if not absent:
            self.skipTest("this machine has both kinds")
        run = self.run_etalon("render", "builtin:triangle", "--require-device", absent.pop(), "-o", self.path("x.png"), code=3)
        for device in machine["devices"]:
            self.assertIn(device["name"], run.err)
        self.assert_only()


if __name__ == "__main__":
    unittest.main()
