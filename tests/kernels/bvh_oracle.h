#pragma once
/// What the traversal has to find, computed in double by trying every primitive, and the probe that
/// runs the traversal.

#include "cl_test_device.h"
#include "flatten/bvh_builder.h"
#include "shared/bvh_probe.h"

#include <glm/geometric.hpp>
#include <random>
#include <string>
#include <vector>

namespace clrender::test {

using Vector = glm::vec<3, double, glm::defaultp>;
using Triangle = std::array<glm::vec3, 3>;
using Random = std::mt19937;
using Rays = std::vector<BvhProbeRay>;

struct BvhScene {
    std::vector<Triangle> triangles;
    std::vector<BvhSphere> spheres; ///< prim ids follow the triangles'

    void add_sphere(const glm::vec3 &center, float radius) {
        spheres.push_back({center, radius, uint(triangles.size() + spheres.size())});
    }
    /// The largest |coordinate|, which rounding errors are measured by.
    [[nodiscard]] double extent() const;
};

BvhProbeRay probe_ray(const glm::vec3 &o, const glm::vec3 &d, float t_max = INFINITY,
                      uint self = BVH_NO_PRIM);

/// Uniform on the unit sphere, and uniform in [-1, 1]^3.
glm::vec3 random_direction(Random &random);
glm::vec3 random_point(Random &random);

/// The number of rays, fewer under CLRENDER_TEST_SMALL; `full` of them in the stress suite.
int rays_of(int count, int full = 0);

/// A closed sphere of `rings` x `rings` quads, cut in two; all corners shared exactly.
std::vector<Triangle> sphere_mesh(int rings, const glm::vec3 &center, float radius);

/// How many of the rays have met nothing.
std::size_t misses(const std::vector<BvhProbeHit> &hits);

/// The kernels over a tree, on the tests' device; `step` boxes or primitives are tested at once.
std::vector<BvhProbeHit> probe_closest(const Bvh &bvh, const std::vector<BvhProbeRay> &rays,
                                       int step = 8);
/// The same by packets of 8 or 16 lanes; rays that go another way than those beside them are not
/// traced (BVH_PROBE_NOT_TRACED).
std::vector<BvhProbeHit> probe_packets(const Bvh &bvh, const std::vector<BvhProbeRay> &rays,
                                       int lanes);
std::vector<bool> probe_any(const Bvh &bvh, const std::vector<BvhProbeRay> &rays, int step = 8);

/// Where the line of a ray meets a primitive, in double: at `t`, and `margin` inside (the least
/// barycentric weight of a triangle; for a sphere how deep the line dips in, relative to the
/// radius).
struct OracleHit {
    double t;
    double margin;
};
/// One intersection with a triangle, up to two with a sphere. The `self` rules apply.
std::vector<OracleHit> oracle_hits(const BvhScene &scene, uint prim, const BvhProbeRay &ray);

/// Empty if `hit` is right: the primitive is met there (give or take rounding: `tolerance` is
/// relative to the extent for t, absolute for the margin) and none is clearly met nearer.
std::string check_hit(const BvhScene &scene, const BvhProbeRay &ray, const BvhProbeHit &hit,
                      double tolerance = 2e-5);

} // namespace clrender::test
