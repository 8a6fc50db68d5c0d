#include "config_of.h"

#include "flatten_parts.h"

#include <algorithm>
#include <climits>
#include <iterator>

namespace clrender::inline CLR_PRECISION {

namespace {

/// Tiles of one colour lie a tile apart, and no two of them may reach the same pixel.
constexpr int max_border = CLR_LEAST_TILE / 2;

template <class Array, class Condition> int any(const Array &array, Condition condition) {
    return std::any_of(std::begin(array), std::end(array), condition) ? 1 : 0;
}

/// True where every lane-wise primitive has one material, whichever side is met.
bool is_one_sided(const FlatScene &flat) {
    const auto end = flat.shapes.begin() + static_cast<std::ptrdiff_t>(flat.lane_wise_count());
    return std::all_of(flat.shapes.begin(), end, [](const ShapeInfo &shape) {
        const uint front = shape.materials & CLR_NO_MATERIAL;
        const uint back = shape.materials >> 16;
        return front == back || front == CLR_NO_MATERIAL || back == CLR_NO_MATERIAL;
    });
}

void set_geometry(const FlatScene &flat, const SamplingOptions &sampling, KernelConfig &config) {
    config.SPHERE_COUNT = flat.facts.sphere_count;
    config.OPAQUE_COUNT = flat.facts.opaque_count;
    config.LARGE_COUNT = flat.facts.large_count;
    config.HUGE_COUNT = flat.facts.huge_count;
    config.PLANAR_COUNT = static_cast<int>(flat.planars.size());
    config.CUBOID_COUNT = static_cast<int>(flat.cuboids.size());
    config.SHADOWLESS_PLANAR_COUNT = flat.facts.shadowless_count;
    config.PLANAR_AXES = flat.facts.planar_axes;
    config.HAS_DISKS = any(flat.planars, [](const Planar &p) { return p.is_disk != 0; });
    config.HAS_TRIANGLES = flat.triangle_count > 0 ? 1 : 0;
    config.HAS_BVH_SPHERES = flat.has_bvh_spheres() ? 1 : 0;
    config.HAS_QUADRICS = flat.quadrics.empty() ? 0 : 1;
    config.HAS_INSTANCES = flat.instances.empty() ? 0 : 1;
    config.BRUTE_FORCE =
        flat.has_hierarchy() && sampling.brute_force && flat.groups.empty() ? 1 : 0;
    config.HAS_VERTEX_NORMALS = flat.normals.empty() ? 0 : 1;
    config.HAS_UVS = flat.needs_uvs() ? 1 : 0;
    config.RECORD_TABLE = flat.lane_wise_count() <= CLR_TABLE_SIZE ? 1 : 0;
}

bool is_node(const Material &material) {
    switch (material.kind & CLR_BSDF_KIND_MASK) {
#define CLR_BSDF_NODE(KIND, meaning) case CLR_BSDF_##KIND:
#include "shared/bsdf_list.def"
        return true;
    default:
        return false;
    }
}

/// How many parameters each material has in the pool, and which of them have textures.
void set_parameters(const FlatScene &flat, KernelConfig &config) {
    if (flat.materials.empty())
        return;
    const std::size_t count = flat.bsdf_parameters.size() / flat.materials.size();
    config.BSDF_PARAMETERS = static_cast<int>(count);
    for (std::size_t i = 0; i < flat.bsdf_parameters.size(); ++i)
        if (flat.bsdf_parameters[i].texture != CLR_NONE && !is_node(flat.materials[i / count]))
            config.BSDF_TEXTURED |= 1 << i % count;
}

void set_materials(const FlatScene &flat, KernelConfig &config) {
    const auto has_kind = [&](uint kind) {
        return any(flat.materials,
                   [&](const Material &m) { return (m.kind & CLR_BSDF_KIND_MASK) == kind; });
    };
    const auto has_flag = [&](uint flag) {
        return any(flat.materials, [&](const Material &m) { return (m.kind & flag) != 0; });
    };
#define CLR_BSDF(KIND, kind, width, lobes, meaning) config.HAS_##KIND = has_kind(CLR_BSDF_##KIND);
#define CLR_BSDF_NODE(KIND, meaning) config.HAS_##KIND = has_kind(CLR_BSDF_##KIND);
#include "shared/bsdf_list.def"
    config.HAS_SMOOTH_TRANSMISSION = has_flag(CLR_BSDF_TRANSMITS);
    config.HAS_TANGENTS = has_flag(CLR_BSDF_TANGENTS);
    config.HAS_BECKMANN = has_flag(CLR_BSDF_BECKMANN);
    config.HAS_GGX = has_flag(CLR_BSDF_GGX);
    // What is found at the root of a tree is not yet the material.
    const bool has_trees = config.HAS_BLEND + config.HAS_NORMALMAP + config.HAS_BUMPMAP > 0;
    config.MATERIALS_IN_RECORDS = is_one_sided(flat) && flat.shape_of.empty() && !has_trees ? 1 : 0;
    config.MATERIAL_SHADES = dielectric_shades(flat.materials);
    set_parameters(flat, config);
    for (const TextureInfo &texture : flat.textures)
        switch (texture.kind) {
        case CLR_TEXTURE_BITMAP_U8:
            config.HAS_BITMAPS_U8 = 1;
            break;
        case CLR_TEXTURE_BITMAP_F32:
            config.HAS_BITMAPS_F32 = 1;
            break;
        case CLR_TEXTURE_CHECKERBOARD:
            config.HAS_CHECKERBOARDS = 1;
            break;
        case CLR_TEXTURE_ATTRIBUTE:
            config.HAS_ATTRIBUTES = 1;
            break;
        }
}

/// True where some surface shines that light sampling never chooses: only paths that meet it bring
/// its light.
bool has_unsampled_emitters(const FlatScene &flat) {
    return any(flat.shapes, [&](const ShapeInfo &shape) {
               return shape.emitter != CLR_NONE && !(flat.emitters[shape.emitter].density > 0);
           }) != 0;
}

void set_lights(const FlatScene &flat, KernelConfig &config) {
    config.HAS_AREA_EMITTERS =
        any(flat.shapes, [](const ShapeInfo &shape) { return shape.emitter != CLR_NONE; });
    config.SOLE_EMITTER = flat.emitters.size() == 1 ? 1 : 0;
    config.LIGHT_COUNT =
        flat.lights.size() > 1 ? CLR_MANY_LIGHTS : static_cast<int>(flat.lights.size());
    config.HAS_ORIENTED_LIGHTS = any(flat.light_nodes, [](const LightNode &node) {
        return any(node.bounds, [](const LightBounds &bounds) {
                   return (bounds.child & CLR_LIGHT_LEAF) != 0 && bounds.cosine > -1;
               }) != 0;
    });
    for (const Light &light : flat.lights)
        switch (light.kind) {
        case CLR_LIGHT_POINT:
            config.HAS_POINT_LIGHTS = 1;
            break;
        case CLR_LIGHT_SPOT:
            config.HAS_SPOT_LIGHTS = 1;
            break;
        case CLR_LIGHT_PROJECTOR:
            config.HAS_PROJECTORS = 1;
            break;
        case CLR_LIGHT_DIRECTIONAL:
            config.HAS_DIRECTIONAL_LIGHTS = 1;
            break;
        case CLR_LIGHT_SUN:
            config.HAS_SUN = 1;
            break;
        case CLR_LIGHT_SPHERE:
            config.HAS_SPHERE_LIGHTS = 1;
            break;
        case CLR_LIGHT_QUADRIC:
            config.HAS_QUADRIC_LIGHTS = 1;
            break;
        case CLR_LIGHT_PLANAR:
            config.HAS_PLANAR_LIGHTS = 1;
            break;
        case CLR_LIGHT_TRIANGLE:
            config.HAS_TRIANGLE_LIGHTS = 1;
            break;
        }
    config.SOLE_LIGHT_SPHERE = flat.sole_light_sphere();
    config.SHADOW_FREE_COUNT = flat.frame.shadow_free_distance > 0 ? flat.facts.large_count : 0;
    config.LIGHT_SAMPLES = flat.facts.light_samples;
    config.ENVIRONMENT = flat.facts.environment;
    config.HAS_SKY = flat.facts.has_sky ? 1 : 0;
}

/// Where lanes keep step, short paths have little to save. A depth has to come before their end.
int roulette_of(const FlatScene &flat, bool has_free_passages) {
    const FrameData &f = flat.frame;
    const int short_path = flat.has_hierarchy() ? 2 : 10;
    if (flat.facts.shows_depth)
        return CLR_ROULETTE_NONE;
    if (flat.facts.weight_window && f.max_depth > short_path)
        return CLR_ROULETTE_WINDOW;
    return f.rr_depth < f.max_depth || has_free_passages ? CLR_ROULETTE_DEPTH : CLR_ROULETTE_NONE;
}

void set_connectors(const FlatScene &flat, KernelConfig &config) {
    const auto has_kind = [&](uint kind) {
        return any(flat.specular_connectors,
                   [=](const SpecularConnector &c) { return c.kind == kind; });
    };
    config.SPECULAR_CONNECTORS = static_cast<int>(flat.specular_connectors.size());
    config.CONNECTS_GLASS = has_kind(CLR_CONNECT_REFRACTION);
    config.CONNECTS_SPHERES = config.CONNECTS_GLASS | has_kind(CLR_CONNECT_REFLECTION);
    config.CONNECTS_PLANES = has_kind(CLR_CONNECT_PLANE);
}

void set_integrator(const FlatScene &flat, const SamplingOptions &sampling, KernelConfig &config) {
    const FrameData &f = flat.frame;
    config.INTEGRATOR = flat.facts.shows_depth ? CLR_INTEGRATOR_DEPTH : CLR_INTEGRATOR_PATH;
    config.STRATEGY = static_cast<int>(flat.facts.strategy);
    config.SAMPLER = sampling.independent_sampler ? CLR_SAMPLER_INDEPENDENT : CLR_SAMPLER_SOBOL;
    config.HIDE_EMITTERS = flat.facts.hides_emitters ? 1 : 0;
    config.FREE_PASSAGES =
        flat.facts.free_passages && (config.HAS_NULL != 0 || config.HAS_THINDIELECTRIC != 0) ? 1
                                                                                             : 0;
    config.ROULETTE = roulette_of(flat, config.FREE_PASSAGES != 0);
    // The last ray of a path would only bring what multiple importance sampling expects of it:
    // light. After some bounces all of it may as well come from light sampling, where that cannot
    // miss: of several lights it might choose one that is hidden, and seldom the one that shines.
    constexpr int long_path = 5;
    config.FINAL_BY_LIGHTS = flat.facts.strategy == Strategy::mis && f.max_depth >= long_path &&
                                     f.max_depth < INT_MAX && config.FREE_PASSAGES == 0 &&
                                     flat.facts.environment == CLR_ENVIRONMENT_NONE &&
                                     flat.lights.size() == 1 && !has_unsampled_emitters(flat)
                                 ? 1
                                 : 0;
}

/// Splatting uses a sample for all pixels around it: three times fewer samples for the same noise
/// with the default filter. Very wide filters would reach too far for it, and on a GPU a work-item
/// would have to render a whole tile.
int filter_of(const FlatScene &flat, const SamplingOptions &sampling, bool splat) {
    if (sampling.pixel_centers)
        return CLR_FILTER_CENTERS;
    if (flat.filter.empty())
        return CLR_FILTER_BOX;
    return flat.facts.filter_border <= max_border && splat ? CLR_FILTER_SPLATTED
                                                           : CLR_FILTER_SAMPLED;
}

void set_camera(const FlatScene &flat, KernelConfig &config) {
    config.HAS_LENS = flat.frame.aperture_radius > 0 ? 1 : 0;
    config.FAR_CAMERA = flat.facts.far_camera ? 1 : 0;
    config.HAS_CLIP = flat.facts.has_clip ? 1 : 0;
    config.HAS_ALPHA = flat.facts.has_alpha ? 1 : 0;
}

} // namespace

KernelConfig config_of(const FlatScene &flat, const SamplingOptions &sampling,
                       const ConfigOptions &options) {
    KernelConfig config;
    config.DOUBLE_PRECISION = CLR_DOUBLE;
    config.LANES = options.lanes;
    config.BVH_STEP = options.bvh_step;
    config.PROFILE = options.profile ? 1 : 0;
    config.VARIANCE = options.variance ? 1 : 0;
    config.FILTER = filter_of(flat, sampling, options.splat_filters);
    config.TILE = options.tile;
    if (config.FILTER == CLR_FILTER_SPLATTED) {
        config.TILE = std::max(options.tile, CLR_LEAST_TILE);
        config.BORDER = flat.facts.filter_border;
    }
    set_geometry(flat, sampling, config);
    set_materials(flat, config);
    set_lights(flat, config);
    set_connectors(flat, config);
    set_integrator(flat, sampling, config);
    set_camera(flat, config);
    force_features(sampling.forced_features, config);
    config.HAS_UVS |= config.HAS_TANGENTS;
    if (sampling.forced_features.count("ROULETTE") != 0 && config.ROULETTE == CLR_ROULETTE_NONE)
        config.ROULETTE = CLR_ROULETTE_DEPTH;
    // The map is there, unless the scene's strategy forbids it.
    if (sampling.forced_features.count("ENVIRONMENT") != 0 && !flat.env_cdf.empty())
        config.ENVIRONMENT = CLR_ENVIRONMENT_MAP;
    return config;
}

} // namespace clrender::inline CLR_PRECISION
