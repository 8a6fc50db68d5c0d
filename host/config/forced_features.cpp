#include "forced_features.h"

#include "kernel_config.h"
#include "shared/bsdf_parameters.h"

#include <algorithm>
#include <map>
#include <utility>

namespace clrender {

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
        CLR_SETTING(OPAQUE_COUNT, 0),
        CLR_SETTING(LARGE_COUNT, 0),
        CLR_SETTING(SHADOW_FREE_COUNT, 0),
        CLR_SETTING(SHADOWLESS_PLANAR_COUNT, 0),
        CLR_SETTING(PLANAR_AXES, 0),
        CLR_SETTING(HAS_DISKS, 1),
        CLR_SETTING(HAS_TRIANGLES, 1),
        CLR_SETTING(HAS_BVH_SPHERES, 1),
        CLR_SETTING(HAS_QUADRICS, 1),
        CLR_SETTING(HAS_INSTANCES, 1),
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
        CLR_SETTING(MATERIAL_SHADES, CLR_SHADES_TINTS | CLR_SHADES_INDICES),
        CLR_SETTING(HAS_BITMAPS_U8, 1),
        CLR_SETTING(HAS_BITMAPS_F32, 1),
        CLR_SETTING(HAS_CHECKERBOARDS, 1),
        CLR_SETTING(HAS_ATTRIBUTES, 1),
        CLR_SETTING(HAS_AREA_EMITTERS, 1),
        CLR_SETTING(LIGHT_COUNT, CLR_MANY_LIGHTS),
        CLR_SETTING(HAS_ORIENTED_LIGHTS, 1),
        CLR_SETTING(SOLE_EMITTER, 0),
        CLR_SETTING(SOLE_LIGHT_SPHERE, -1),
        CLR_SETTING(HAS_POINT_LIGHTS, 1),
        CLR_SETTING(HAS_SPOT_LIGHTS, 1),
        CLR_SETTING(HAS_PROJECTORS, 1),
        CLR_SETTING(HAS_DIRECTIONAL_LIGHTS, 1),
        CLR_SETTING(HAS_SPHERE_LIGHTS, 1),
        CLR_SETTING(HAS_QUADRIC_LIGHTS, 1),
        CLR_SETTING(HAS_PLANAR_LIGHTS, 1),
        CLR_SETTING(HAS_TRIANGLE_LIGHTS, 1),
        CLR_SETTING(HAS_LENS, 1),
        CLR_SETTING(HAS_CLIP, 1),
        CLR_SETTING(HAS_ALPHA, 1),
    };
#undef CLR_SETTING
    return table;
}

/// By feature: those that need it.
const std::multimap<std::string, std::string> &dependents() {
    static const std::multimap<std::string, std::string> table = {
        {"HAS_UVS", "HAS_TANGENTS"},
        {"HAS_TRIANGLES", "HAS_INSTANCES"},
        {"HAS_QUADRICS", "HAS_QUADRIC_LIGHTS"},
        {"HAS_TRIANGLES", "HAS_ATTRIBUTES"},
        {"HAS_TANGENTS", "HAS_BUMPMAP"},
        {"HAS_TANGENTS", "HAS_NORMALMAP"},
        {"HAS_GGX", "HAS_ROUGHCONDUCTOR"},
        {"HAS_GGX", "HAS_ROUGHDIELECTRIC"},
        {"HAS_GGX", "HAS_ROUGHPLASTIC"},
        {"HAS_GGX", "HAS_PRINCIPLED"},
        {"HAS_GGX", "HAS_PRINCIPLEDTHIN"},
        {"BSDF_PARAMETERS", "HAS_GGX"},
        {"BSDF_PARAMETERS", "HAS_BECKMANN"},
        {"BSDF_PARAMETERS", "HAS_PLASTIC"},
        {"BSDF_PARAMETERS", "HAS_THINDIELECTRIC"},
        {"BSDF_PARAMETERS", "HAS_BLEND"},
        {"BSDF_PARAMETERS", "HAS_TANGENTS"},
        {"BSDF_PARAMETERS", "HAS_SMOOTH_TRANSMISSION"},
    };
    return table;
}

} // namespace

const ForcedFeatures &all_features() {
    static const ForcedFeatures all = [] {
        // Two are counts, which flatten() raises to one; of the third it makes a map; of the fourth
        // the scene may have another kind.
        ForcedFeatures names = {"SPHERE_COUNT", "PLANAR_COUNT", "ENVIRONMENT", "ROULETTE"};
        for (const auto &[name, setting] : settings())
            names.insert(name);
        return names;
    }();
    return all;
}

bool is_forced(const ForcedFeatures &features, const std::string &name) {
    if (features.count(name) != 0)
        return true;
    const auto [first, last] = dependents().equal_range(name);
    return std::any_of(first, last,
                       [&](const auto &pair) { return is_forced(features, pair.second); });
}

void force_features(const ForcedFeatures &features, KernelConfig &config) {
    for (const auto &[name, setting] : settings())
        if (is_forced(features, name))
            config.*setting.field = setting.value;
}

} // namespace clrender
