#pragma once
/// The lights of a scene while they are being collected, and those of them that have no surface
/// (delta_lights.cpp).

#include "flatten_parts.h"
#include "light_tree.h"

namespace clrender::inline CLR_PRECISION {

/// The lights found so far, and where each of them is and how strong.
struct LightList {
    std::vector<Light> lights;
    std::vector<LightExtent> extents;

    void add(const Light &light, const LightExtent &extent) {
        lights.push_back(light);
        extents.push_back(extent);
    }

    [[nodiscard]] uint size() const { return static_cast<uint>(lights.size()); }
};

/// Mean luminance of a texture; of a bitmap's texels, which may be off by what the light shows of
/// it.
double mean_luminance(const Texture &texture);

void add_point(const Flattening &work, const Emitter &emitter, LightList &list);
void add_spot(Flattening &work, const Emitter &emitter, LightList &list);
void add_projector(Flattening &work, const Emitter &emitter, LightList &list);
void add_directional(const Emitter &emitter, LightList &list);

} // namespace clrender::inline CLR_PRECISION
