"""Post passes from the command line: --post, etalon post, and what is said of the error of what they leave."""

from program import Case


class Post(Case):
    def film(self, *more):
        path = self.path("film.exr")
        self.run_etalon("render", "builtin:cornell", "--renderer", "path", "--size", "32x24", "--spp", "8", "-o", path, *more)
        return path

    def test_render_and_post_of_its_film_give_the_same_picture(self):
        chain = "atrous:levels=2,bloom,outline,fxaa"
        film = self.film("--aovs")
        run = self.run_etalon("post", film, "--post", chain, "-o", self.path("after.exr"))
        self.assertIn("error not measured after post passes", run.err)
        at_once = self.run_etalon("render", "builtin:cornell", "--renderer", "path", "--size", "32x24", "--spp", "8", "--post",
                                  chain, "-o", self.path("at once.exr"))
        self.assertIn("error not measured after post passes", at_once.err)
        self.run_etalon("diff", self.path("after.exr"), self.path("at once.exr"), "--max-difference", "0")
        with open(self.path("after.exr"), "rb") as file:
            self.assertIn(b"atrous:levels=2,", file.read())

    def test_scaling_keeps_the_error_and_the_reference_agrees_with_the_device(self):
        film = self.film()
        before = self.run_etalon("post", film, "--post", "exposure:ev=0", "-o", self.path("a.exr")).err
        after = self.run_etalon("post", film, "--post", "exposure:ev=3", "-o", self.path("b.exr")).err
        self.assertIn("95% interval", after)
        self.assertEqual(before.split("error")[1], after.split("error")[1])
        for where in ([], ["--reference"]):
            self.run_etalon("post", film, "--post", "bilateral:sigma_s=1", "-o", self.path(f"c{len(where)}.exr"), *where)
        self.run_etalon("diff", self.path("c0.exr"), self.path("c1.exr"), "--max-difference", "1e-4")

    def test_what_is_misspelt_is_refused_before_anything_is_loaded(self):
        run = self.run_etalon("render", "nothing.glb", "--post", "bilaterall", "-o", self.path("a.png"), code=2)
        self.assertIn("did you mean bilateral?", run.err)
        run = self.run_etalon("render", "nothing.glb", "--post", "gaussian:sigma=-1", "-o", self.path("a.png"), code=2)
        self.assertIn("0 to 1000 pixels", run.err)
        run = self.run_etalon("post", self.film(), "--post", "outline", "-o", self.path("a.png"), code=2)
        self.assertIn("--aovs", run.err)
        run = self.run_etalon("post", self.path("film.exr"), "-o", self.path("a.png"), code=2)
        self.assertIn("--post", run.err)

    def test_help_teaches_every_pass(self):
        for command in ("render", "post"):
            text = self.run_etalon(command, "--help").out.decode()
            for word in ("bilateral", "sigma_r=0.1", "curve=neutral", "ev=auto", "0 to 1000 pixels"):
                self.assertIn(word, text)
        self.assertIn("sigma_r=0.1", self.run_etalon("man").out.decode())

    def test_profile_names_the_passes(self):
        run = self.run_etalon("render", "builtin:cornell", "--size", "16x16", "--post", "sobel,median", "--profile", "--json", "-o",
                              self.path("a.png"))
        for stage in ("post sobel", "post median", "load", "write"):
            self.assertIn(stage, run.err)
        self.assertIn("post sobel", run.json["pictures"][0]["render_stages"])
        traced = self.run_etalon("render", "builtin:cornell", "--renderer", "path", "--spp", "2", "--size", "16x16", "--profile", "-o",
                                 self.path("b.png"))
        self.assertRegex(traced.err, "kernel (paths|trace)")


class Batch(Case):
    def test_a_scene_that_fails_is_named_and_the_others_go_on(self):
        broken = self.write("broken.glb", b"glTF, but not really")
        run = self.run_etalon("render", "builtin:cornell", broken, self.path("missing.glb"), "builtin:spheres", "--size", "16x16",
                              "--json", "-o", self.path("{name}.png"), code=2)
        self.assertIn("2 of 4 scenes failed", run.err)
        self.assertIn("broken.glb", run.err)
        report = run.json
        self.assertEqual([p["scene"] for p in report["pictures"]], ["builtin:cornell", "builtin:spheres"])
        self.assertEqual([f["error"]["exit_code"] for f in report["failures"]], [2, 2])
        self.assert_only("broken.glb", "cornell.png", "spheres.png")

    def test_the_exit_code_is_the_worst(self):
        run = self.run_etalon("render", self.path("missing.glb"), "builtin:cornell", "--size", "16x16", "--memory", "1M", "-o",
                              self.path("{name}.png"), code=3)
        self.assertIn("2 of 2 scenes failed", run.err)
