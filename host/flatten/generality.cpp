#include "generality.h"

#include "flatten_parts.h"
#include "shared/bsdf_parameters.h"

#include <algorithm>
#include <map>

namespace clrender::inline CLR_PRECISION {

namespace {

/// A field of the configuration and the value that serves every scene.
struct Setting {
    int KernelConfig::*field;
    int value;
};

const std::map<std::string, Setting> &settings() {
#define CLR_SETTING(name, value)                                                                   \
    std::make_pair(std::string(#name), Setting{&KernelConfig::name, value})
    static const std::map<std::string, Setting> table = {
        CLR_SETTING(SOLID_COUNT, 0),
        CLR_SETTING(WIDE_COUNT, 0),
        CLR_SETTING(SHADOW_FREE_COUNT, 0),
        CLR_SETTING(SHADOWLESS_PLANAR_COUNT, 0),
        CLR_SETTING(PLANAR_AXES, 0),
        CLR_SETTING(HAS_DISKS, 1),
        CLR_SETTING(HAS_TRIANGLES, 1),
        CLR_SETTING(HAS_BVH_SPHERES, 1),
        CLR_SETTING(HAS_VERTEX_NORMALS, 1),
        CLR_SETTING(HAS_UVS, 1),
#define CLR_BSDF(KIND, kind, width, lobes, meaning) CLR_SETTING(HAS_##KIND, 1),
#define CLR_BSDF_NODE(KIND, meaning) CLR_SETTING(HAS_##KIND, 1),
#include "shared/bsdf_list.def"
        CLR_SETTING(HAS_GGX, 1),
        CLR_SETTING(HAS_BECKMANN, 1),
        CLR_SETTING(HAS_SMOOTH_TRANSMISSION, 1),
        CLR_SETTING(HAS_TANGENTS, 1),
        CLR_SETTING(BSDF_PARAMETERS, CLR_MOST_BSDF_PARAMETERS),
        CLR_SETTING(BSDF_TEXTURED, (1 << CLR_MOST_BSDF_PARAMETERS) - 1),
        CLR_SETTING(RECORD_TABLE, 0),
        CLR_SETTING(MATERIALS_IN_RECORDS, 0),
        CLR_SETTING(MATERIAL_SHADES, 3),
        CLR_SETTING(HAS_BITMAPS_U8, 1),
        CLR_SETTING(HAS_BITMAPS_F32, 1),
        CLR_SETTING(HAS_CHECKERBOARDS, 1),
        CLR_SETTING(HAS_AREA_EMITTERS, 1),
        CLR_SETTING(LIGHT_COUNT, -1),
        CLR_SETTING(HAS_ORIENTED_LIGHTS, 1),
        CLR_SETTING(SOLE_EMITTER, 0),
        CLR_SETTING(SOLE_LIGHT_SPHERE, -1),
        CLR_SETTING(HAS_POINT_LIGHTS, 1),
        CLR_SETTING(HAS_SPHERE_LIGHTS, 1),
        CLR_SETTING(HAS_PLANAR_LIGHTS, 1),
        CLR_SETTING(HAS_TRIANGLE_LIGHTS, 1),
        CLR_SETTING(ENVIRONMENT, 2),
        CLR_SETTING(HAS_LENS, 1),
        CLR_SETTING(HAS_CLIP, 1),
        CLR_SETTING(HAS_ROULETTE, 1),
        CLR_SETTING(HAS_ALPHA, 1),
    };
#undef CLR_SETTING
    return table;
}

/// Reads of lanes that are off go to the first element.
void fill_empty_arrays(FlatScene &flat) {
    const auto fill = [](auto &...arrays) {
        (arrays.resize(std::max<std::size_t>(arrays.size(), 1)), ...);
    };
    fill(flat.shape_of, flat.shapes, flat.materials, flat.emitters, flat.lights,
         flat.light_triangles, flat.light_nodes, flat.planars, flat.textures, flat.bsdf_parameters);
    flat.bsdf_tables.resize(std::max<std::size_t>(flat.bsdf_tables.size(), CLR_BOUNDARY_COSINES));
}

} // namespace

const Generality &full_generality() {
    static const Generality all = [] {
        // These two are counts, which the steps of flatten() raise to one.
        Generality names = {"SPHERE_COUNT", "PLANAR_COUNT"};
        for (const auto &[name, setting] : settings())
            names.insert(name);
        return names;
    }();
    return all;
}

void apply_generality(const Generality &wanted, FlatScene &flat) {
    for (const auto &[name, setting] : settings()) {
        if (wanted.count(name) == 0 || name == "ENVIRONMENT")
            continue;
        flat.config.*setting.field = setting.value;
    }
    if (wanted.count("ENVIRONMENT") != 0)
        make_environment_a_map(flat);
    // Without a lens all focus is as good: the one at distance 1 moves no ray.
    if (flat.frame.focus_distance == 0)
        flat.frame.focus_distance = 1;
    if (!wanted.empty())
        fill_empty_arrays(flat);
}

} // namespace clrender::inline CLR_PRECISION
