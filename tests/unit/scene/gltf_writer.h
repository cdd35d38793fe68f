#pragma once
// Small glTF files made in memory, valid ones and broken ones, for tests of the importer.
#include <fmt/format.h>

#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "engine/scene/load.h"

namespace etalon::test {

inline std::vector<std::byte> bytes_of(std::string_view text)
{
    const auto* data = reinterpret_cast<const std::byte*>(text.data());
    return {data, data + text.size()};
}

inline constexpr int kByte = 5120;
inline constexpr int kUnsignedByte = 5121;
inline constexpr int kShort = 5122;
inline constexpr int kUnsignedShort = 5123;
inline constexpr int kUnsignedInt = 5125;
inline constexpr int kFloat = 5126;

/// Collects binary data and JSON fragments; glb() puts them together. Every add_… returns the index of what it added.
class GltfWriter {
 public:
    /// A bufferView of these values; `stride` 0 leaves byteStride out.
    template <typename T>
    int add_view(const std::vector<T>& values, int stride = 0)
    {
        while (binary_.size() % 4 != 0) binary_.push_back(std::byte{0});
        const std::size_t offset = binary_.size();
        const auto* data = reinterpret_cast<const std::byte*>(values.data());
        binary_.insert(binary_.end(), data, data + values.size() * sizeof(T));
        return add("bufferViews",
                   fmt::format(R"({{"buffer":0,"byteOffset":{},"byteLength":{}{}}})", offset, values.size() * sizeof(T),
                               stride == 0 ? "" : fmt::format(R"(,"byteStride":{})", stride)));
    }
    int add_accessor(int view, int component_type, const std::string& type, std::size_t count,
                     const std::string& more = {})
    {
        return add("accessors", fmt::format(R"({{"bufferView":{},"componentType":{},"type":"{}","count":{}{}}})", view,
                                            component_type, type, count, more));
    }
    /// Tightly packed floats of `components` numbers each.
    int add_floats(const std::vector<float>& values, int components)
    {
        const char* types[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
        return add_accessor(add_view(values), kFloat, types[components - 1], values.size() / std::size_t(components));
    }
    /// Any other object: "meshes", "nodes", "materials" …
    int add(const std::string& section, const std::string& json)
    {
        sections_[section].push_back(json);
        return static_cast<int>(sections_[section].size() - 1);
    }
    /// A member of the document that is no array of objects: R"("scene":1)".
    void member(const std::string& json) { members_ += "," + json; }

    /// A mesh of one primitive, on a node of its own. `primitive`: R"("attributes":{"POSITION":0})".
    void show(const std::string& primitive)
    {
        const int mesh = add("meshes", fmt::format(R"({{"primitives":[{{{}}}]}})", primitive));
        add("nodes", fmt::format(R"({{"mesh":{}}})", mesh));
    }

    std::string json(const std::string& uri = {}) const
    {
        std::string out = R"({"asset":{"version":"2.0"})" + members_;
        for (const auto& [name, objects] : sections_) {
            out += fmt::format(R"(,"{}":[)", name);
            for (std::size_t i = 0; i < objects.size(); ++i) out += (i > 0 ? "," : "") + objects[i];
            out += "]";
        }
        if (!binary_.empty())
            out += fmt::format(R"(,"buffers":[{{"byteLength":{}{}}}])", binary_.size(),
                               uri.empty() ? "" : fmt::format(R"(,"uri":"{}")", uri));
        return out + "}";
    }
    const std::vector<std::byte>& binary() const { return binary_; }

    std::vector<std::byte> glb() const { return glb(json(), binary_); }

    static std::vector<std::byte> glb(std::string text, std::vector<std::byte> binary)
    {
        while (text.size() % 4 != 0) text += ' ';
        while (binary.size() % 4 != 0) binary.push_back(std::byte{0});
        std::vector<std::byte> out;
        const auto word = [&](std::size_t value) {
            for (int i = 0; i < 4; ++i) out.push_back(static_cast<std::byte>(value >> (8 * i) & 0xffu));
        };
        word(0x46546c67);
        word(2);
        word(12 + 8 + text.size() + (binary.empty() ? 0 : 8 + binary.size()));
        word(text.size());
        word(0x4e4f534a);
        for (const std::byte b : bytes_of(text)) out.push_back(b);
        if (binary.empty()) return out;
        word(binary.size());
        word(0x004e4942);
        out.insert(out.end(), binary.begin(), binary.end());
        return out;
    }

    Scene load(const LoadOptions& options = {}) const { return parse_gltf(glb(), "", "test.glb", options); }

 private:
    std::map<std::string, std::vector<std::string>> sections_;
    std::string members_;
    std::vector<std::byte> binary_;
};

/// The corners of a triangle in the plane z = 0.
inline const std::vector<float> kTriangle = {0, 0, 0, 1, 0, 0, 0, 1, 0};

/// A file with one triangle: accessor 0 holds its positions.
inline GltfWriter triangle_file()
{
    GltfWriter file;
    file.add_floats(kTriangle, 3);
    file.show(R"("attributes":{"POSITION":0})");
    return file;
}

}  // namespace etalon::test
