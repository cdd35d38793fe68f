#pragma once
#include "engine/scene/scene.h"

// The built-in scenes, one function each; the table with their names is in builtin.cpp.
namespace etalon::builtin {

// builtin_light.cpp: light and its transport
Scene triangle();
Scene cornell();
Scene furnace();
Scene furnace_lambert();
Scene lights();
Scene glass();

// builtin_surface.cpp: surfaces, textures, geometry, cameras
Scene spheres();
Scene texture_plane();
Scene normals();
Scene maps();
Scene alpha();
Scene instances();
Scene blinn_phong();
Scene wires();
Scene orthographic();
Scene thin_lens();
Scene siemens_star();

// builtin_layers.cpp: the layers of glTF's material extensions
Scene specular();
Scene clearcoat();
Scene sheen();
Scene transmission();
Scene volume();
Scene iridescence();
Scene anisotropy();
Scene dispersion();
Scene diffuse_transmission();
Scene specular_glossiness();

}  // namespace etalon::builtin
