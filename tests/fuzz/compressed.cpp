// Any payload behind the check of its header decodes to as many bytes as its accessor wants, or is an Error.
// The first byte chooses the codec, the next three are what the document says of the payload.
#include <array>
#include <cstdint>

#include "engine/base/error.h"
#include "engine/scene/compressed.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using namespace etalon;

constexpr std::uint32_t kMost = 1 << 16;  // vertices and faces, at the speed of a fuzzer

void draco(std::span<const std::byte> payload, int type, std::size_t components)
{
    const DracoClaim claim = read_draco_header(payload);
    if (claim.faces > kMost || claim.vertices > kMost) return;  // preflight holds them against the accessors
    const std::array wishes = {
        DracoWish{.id = 0, .component_type = type, .components = components, .count = claim.vertices}};
    const DracoMesh mesh = decode_draco(payload, wishes);
    for (const std::uint32_t corner : mesh.corners) assume(corner < claim.vertices);
    constexpr std::size_t kBytes[] = {1, 1, 2, 2, 0, 4, 4};  // of a component of type 5120 …
    assume(mesh.attributes.at(0).size() == claim.vertices * components * kBytes[type - 5120]);
}

// Modes, counts, filters and strides that preflight lets through.
void meshopt(std::span<const std::byte> payload, std::uint8_t choice, std::uint8_t many, std::uint8_t width)
{
    const auto mode = static_cast<MeshoptMode>(choice % 3);
    const std::size_t count = mode == MeshoptMode::triangles ? 3 * (1 + many % 64u) : 1 + many;
    const bool has_attributes = mode == MeshoptMode::attributes;
    const auto filter = has_attributes ? static_cast<MeshoptFilter>(choice / 3 % 4) : MeshoptFilter::none;
    const std::size_t stride = !has_attributes                       ? 2 + 2 * (width % 2u)
                               : filter == MeshoptFilter::octahedral ? 4 + 4 * (width % 2u)
                               : filter == MeshoptFilter::quaternion ? 8
                                                                     : 4 * (1 + width % 64u);
    check_meshopt_payload(payload, mode, count, stride);
    assume(decode_meshopt(payload, mode, filter, count, stride).size() == count * stride);
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    if (size < 4) return 0;
    const std::span<const std::byte> payload = std::as_bytes(std::span(data + 4, size - 4));
    try {
        if (data[0] % 2 == 0)
            draco(payload, 5120 + data[1] % 7, 1 + data[2] % 4);
        else
            meshopt(payload, data[1], data[2], data[3]);
    } catch (const Error& error) {
        assume(error.blame() == Blame::input && error.what()[0] != '\0');
    }
    return 0;
}
