#include <fstream>  // tinygltf uses it without including it under TINYGLTF_NO_FS
#include <nlohmann/json.hpp>

#define TINYGLTF_IMPLEMENTATION
#include "engine/scene/gltf_model.h"

#include "engine/base/error.h"

namespace etalon::gltf {

Model parse_model(const std::string& json)
{
    Model model;
    std::string error;
    std::string warning;
    tinygltf::TinyGLTF parser;
    if (!parser.LoadASCIIFromString(&model, &error, &warning, json.c_str(), static_cast<unsigned int>(json.size()), "",
                                    tinygltf::NO_REQUIRE)) {
        // The parser makes every exception a message.
        if (error.find("bad_alloc") != std::string::npos)
            throw Error(Blame::machine, "no memory for the glTF document", "a smaller scene takes less");
        throw Error(Blame::input,
                    "the glTF document is malformed: " +
                        (error.empty() ? "an object lacks what it must have" : error.substr(0, error.find('\n'))),
                    "export again");
    }
    return model;
}

}  // namespace etalon::gltf
