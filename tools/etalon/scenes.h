#pragma once
#include <string>

#include "engine/scene/scene.h"
#include "tools/etalon/arguments.h"

namespace etalon::cli {

/// The scene behind a command line argument: a file, builtin:NAME, or "-" for GLB or glTF text on standard input. With
/// --strict its warnings are errors; else they are said on standard error.
Scene open_scene(const std::string& argument, const Arguments& arguments);

/// A name for files made of it: "chair" of models/chair.glb, "cornell" of builtin:cornell, "stdin" of "-".
std::string short_name(const std::string& argument);

/// `pattern` with each {name} replaced by `name`.
std::string with_name(const std::string& pattern, const std::string& name);

}  // namespace etalon::cli
