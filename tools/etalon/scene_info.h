#pragma once
#include "tools/etalon/arguments.h"

namespace etalon::cli {

/// `etalon info SCENE`: what the scene holds, and the memory it will take. Returns the exit code.
int scene_info(const Arguments& arguments);

}  // namespace etalon::cli
