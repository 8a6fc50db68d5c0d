#pragma once
/// The rays that bench_traversal traces: what a path tracer sends through one mesh.

#include "shared/bvh.h"
#include "shared/bvh_probe.h"
#include "traversal_meshes.h"

#include <functional>

namespace clrender::bench {

using Rays = std::vector<BvhProbeRay>;
using Hits = std::vector<BvhProbeHit>;

/// One kind of ray: whether any hit will do, and whether neighbours go the same way.
struct RaySet {
    std::string label;
    Rays rays;
    bool any = false;
    bool coherent = false;
};

/// Camera rays of an image of `image_size` squared (a multiple of 8), in tiles of 8x8 pixels; from
/// what they hit one diffuse bounce and one shadow ray each; and third bounces, of as many paths
/// as it takes. `closest` finds the nearest hits of rays.
std::vector<RaySet> make_rays(const Triangles &triangles, int image_size,
                              const std::function<Hits(const Rays &)> &closest);

} // namespace clrender::bench
