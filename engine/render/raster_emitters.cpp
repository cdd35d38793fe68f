#include "engine/render/raster_emitters.h"

#include <algorithm>

#include "engine/render/raster_frame.h"

namespace etalon {
namespace {

constexpr std::size_t kMostEmitters = 16;

bool lights_others(const Material& material)
{
    return material.model != BsdfModel::unlit && material.emission != dvec3(0) && !material.emissive_texture.present();
}

RasterEmitter emitter_of(const PosedScene& posed, const Draw& draw)
{
    const Primitive& primitive = posed.primitive(draw);
    RasterEmitter emitter;
    dvec3 moment(0);
    const auto corner = [&](std::size_t i) {
        return dvec3(draw.world_from_object * dvec4(dvec3(primitive.positions[primitive.indices[i]]), 1));
    };
    const double side = is_mirrored(draw.world_from_object) ? -1 : 1;
    for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
        const dvec3 p0 = corner(i), p1 = corner(i + 1), p2 = corner(i + 2);
        const dvec3 area_vector = side * 0.5 * cross(p1 - p0, p2 - p0);
        const double area = length(area_vector);
        emitter.area += area;
        emitter.area_vector += area_vector;
        moment += area * (p0 + p1 + p2) / 3.0;
    }
    if (emitter.area > 0) emitter.center = moment / emitter.area;
    return emitter;
}

}  // namespace

std::vector<RasterEmitter> find_emitters(const PosedScene& posed)
{
    std::vector<RasterEmitter> emitters;
    const auto add = [&](RasterEmitter emitter, const Material& material, std::size_t object) {
        emitter.radiance = material.emission;
        emitter.two_sided = material.double_sided && !material.emits_front_only;
        emitter.object_id = static_cast<std::uint32_t>(object + 1);
        if (emitter.area > 0) emitters.push_back(emitter);
    };
    for (std::size_t i = 0; i < posed.draws.size(); ++i) {
        const Draw& draw = posed.draws[i];
        if (posed.primitive(draw).topology == Topology::triangles && lights_others(posed.material(draw)))
            add(emitter_of(posed, draw), posed.material(draw), i);
    }
    for (std::size_t i = 0; i < posed.spheres.size(); ++i) {
        const PosedSphere& sphere = posed.spheres[i];
        const Material& material = posed.materials()[sphere.material];
        RasterEmitter emitter;
        emitter.area = 4 * kPi * sphere.radius * sphere.radius;
        emitter.center = sphere.center;
        if (lights_others(material)) add(emitter, material, posed.draws.size() + i);
    }
    std::stable_sort(emitters.begin(), emitters.end(),
                     [](const RasterEmitter& a, const RasterEmitter& b) { return a.power() > b.power(); });
    if (emitters.size() > kMostEmitters) emitters.resize(kMostEmitters);
    return emitters;
}

shared::EmitterRecord pack(const RasterEmitter& emitter, const dvec3& eye)
{
    shared::uint flags = 0;
    if (length(emitter.area_vector) > emitter.area / 2) flags |= shared::kEmitterFlat;
    if (emitter.two_sided) flags |= shared::kEmitterTwoSided;
    return {.radiance = vec3(emitter.radiance),
            .area = static_cast<float>(emitter.area),
            .center = vec3(emitter.center - eye),
            .object_id = emitter.object_id,
            .area_vector = vec3(emitter.area_vector),
            .flags = flags};
}

}  // namespace etalon
