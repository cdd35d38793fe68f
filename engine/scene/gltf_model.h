#pragma once
// The one includer of tinygltf. It is given checked text without buffers and images (engine/scene/preflight.h), so none
// of its file, base64 or image code ever runs.
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_INCLUDE_JSON
#define TINYGLTF_NO_FS
#include <tiny_gltf.h>

#include <string>

namespace etalon::gltf {

using Model = tinygltf::Model;
using Value = tinygltf::Value;

/// tinygltf's view of checked glTF text. Error(input) with its message when it refuses.
Model parse_model(const std::string& json);

}  // namespace etalon::gltf
