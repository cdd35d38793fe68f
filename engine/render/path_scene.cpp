#include "engine/render/path_scene.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "engine/render/albedo.h"
#include "engine/render/material.h"
#include "engine/render/path_layers.h"
#include "engine/render/path_sky.h"
#include "engine/render/path_textures.h"

namespace etalon {
namespace {

ProgressUpdate stage(std::string_view name)
{
    ProgressUpdate update;
    update.stage = name;
    return update;
}

template <class T>
PathBuffer upload_list(gpu::Device& device, const std::vector<T>& values, const char* name,
                       VkFormat format = VK_FORMAT_R32G32B32A32_UINT)
{
    PathBuffer out;
    out.buffer = gpu::make_buffer(device, values, name);
    out.view = gpu::TexelView(device, out.buffer, format);
    return out;
}

shared::uint background_code(Background background)
{
    switch (background) {
        case Background::environment:
            return shared::kBackgroundEnvironment;
        case Background::transparent:
            return shared::kBackgroundTransparent;
        case Background::colour:
            return shared::kBackgroundColour;
    }
    return shared::kBackgroundEnvironment;
}

void set_sky(gpu::Device& device, const Environment& environment, PathScene& scene)
{
    PathSky sky;
    if (scene.features.sky_map && environment.map) sky = make_path_sky(*environment.map);
    scene.sky_cells = upload_list(device, sky.cells, "environment table");
    scene.sky_map = upload_list(device, sky.texels, "environment map");
    shared::PathFrame& frame = scene.frame;
    if (scene.features.sky)
        frame.sky = vec3(environment.map ? dvec3(environment.scale) : environment.radiance * environment.scale);
    frame.sky_cos = static_cast<float>(std::cos(environment.rotation));
    frame.sky_sin = static_cast<float>(std::sin(environment.rotation));
    frame.sky_width = static_cast<shared::uint>(sky.width);
    frame.sky_height = static_cast<shared::uint>(sky.height);
    frame.cells_x = static_cast<shared::uint>(sky.cells_x);
    frame.cells_y = static_cast<shared::uint>(sky.cells_y);
}

}  // namespace

PathScene make_path_scene(gpu::Device& device, const PosedScene& posed, const Requirements& required,
                          const RenderSettings& settings, const Progress& progress)
{
    PathScene out;
    out.features = path_features(posed, required, settings);
    out.origin = eye_of(posed.view);

    progress.report(stage("building the BVH"));
    PathGeometry geometry = make_path_geometry(posed, out.features, out.origin, settings.threads);
    const EmitterTable emitters = emitter_table(geometry, settings.light_selection);
    out.light_tree = emitters.tree;
    out.stack_need = geometry.bvh.stack_need;
    out.primitives = geometry.count;
    out.nodes = geometry.bvh.nodes.size();
    out.frame.grid_base = geometry.bvh.grid.base;
    out.frame.grid_scale = geometry.bvh.grid.scale;
    out.frame.bounds_min = geometry.bvh.bounds.min;
    out.frame.bounds_max = geometry.bvh.bounds.max;

    progress.report(stage("uploading the scene"));
    out.node_list = upload_list(device, geometry.bvh.nodes, "BVH nodes");
    out.primitive_list = upload_list(device, geometry.primitives, "primitives");
    out.attributes = upload_list(device, geometry.attributes, "attributes");
    out.materials = upload_list(device, path_materials(posed.materials()), "materials");
    std::vector<vec4> albedo;
    if (out.features.albedo()) albedo = make_albedo_cells(out.features.sheen, settings.threads);
    out.albedo = upload_list(device, albedo, "directional albedo");
    PathTextures textures;
    if (out.features.textures()) textures = make_path_textures(*posed.scene, required);
    out.textures = upload_list(device, textures.table, "textures");
    out.texels_8 = upload_list(device, textures.texels_8, "texels", VK_FORMAT_R32_UINT);
    out.texels_wide = upload_list(device, textures.texels_wide, "wide texels");

    std::vector<shared::LightRecord> lights;
    if (out.features.punctual)
        for (const PosedLight& light : posed.lights)
            if (light.light.color * light.light.intensity != dvec3(0)) lights.push_back(pack(light, out.origin));
    out.lights = upload_list(device, padded<4>(lights), "lights");
    out.emitters = upload_list(device, emitters.texels, "emitters");
    set_sky(device, posed.environment, out);

    out.frame.emitter_count = emitters.count;
    out.frame.light_count = static_cast<shared::uint>(lights.size());
    out.frame.strategy_count =
        shared::uint(emitters.count > 0) + shared::uint(!lights.empty()) + shared::uint(out.frame.cells_x > 0);
    out.frame.seed = path_seed(settings.seed);
    out.frame.max_depth = static_cast<shared::uint>(std::max(settings.max_depth, 1));
    out.frame.roulette = settings.russian_roulette ? 1u : 0u;
    out.frame.background = vec3(settings.background_color);
    out.frame.background_mode = background_code(settings.background);
    return out;
}

void set_view(shared::PathFrame& frame, const View& view, const dvec3& origin)
{
    const dmat4& m = view.world_from_camera;
    const Camera& camera = view.camera;
    frame.eye = vec3(dvec3(m[3]) - origin);
    frame.right = vec3(dvec3(m[0]));
    frame.up = vec3(dvec3(m[1]));
    frame.forward = vec3(-dvec3(m[2]));
    frame.width = static_cast<shared::uint>(view.width);
    frame.height = static_cast<shared::uint>(view.height);
    const double half = std::tan(camera.yfov / 2);
    frame.film_x = static_cast<float>(camera.orthographic ? camera.xmag : half * view.width / view.height);
    frame.film_y = static_cast<float>(camera.orthographic ? camera.ymag : half);
    frame.lens_radius = static_cast<float>(camera.lens ? camera.lens->aperture_radius : 0);
    frame.lens_blades = static_cast<shared::uint>(camera.lens ? std::max(camera.lens->blades, 0) : 0);
    frame.focus_distance = static_cast<float>(camera.lens ? camera.lens->focus_distance : 1);
}

}  // namespace etalon
