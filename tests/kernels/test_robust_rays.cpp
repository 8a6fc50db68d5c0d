/// What has to hold for every ray at its full size under CLRENDER_STRESS=full (scripts/stress):
/// watertight meshes, rays that leave a shape, needles.

#include "bvh_oracle.h"
#include "selftest/check.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <fmt/core.h>

using namespace clrender;
using namespace clrender::test;

namespace {

std::vector<Triangle> cube_mesh(const glm::vec3 &center, float half) {
    const auto corner = [&](int i) {
        return center + half * glm::vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    };
    std::vector<Triangle> triangles;
    for (const auto &face :
         {std::array{0, 1, 3, 2}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4},
          std::array{2, 3, 7, 6}, std::array{0, 2, 6, 4}, std::array{1, 3, 7, 5}}) {
        triangles.push_back({corner(face[0]), corner(face[1]), corner(face[2])});
        triangles.push_back({corner(face[0]), corner(face[2]), corner(face[3])});
    }
    return triangles;
}

/// From inside a closed mesh: random directions, and straight at every corner and middle of an
/// edge.
Rays inside_rays(const std::vector<Triangle> &mesh, const glm::vec3 &center, float radius,
                 Random &random, int count) {
    Rays rays;
    for (int i = 0; i < count; ++i) {
        const glm::vec3 o = center + 0.5f * radius * random_point(random);
        rays.push_back(probe_ray(o, random_direction(random)));
    }
    const std::size_t step = small_tests() ? 200 : 1;
    for (std::size_t i = 0; i < mesh.size(); i += step) {
        for (int k = 0; k < 3; ++k) {
            const glm::vec3 a = mesh[i][k], b = mesh[i][(k + 1) % 3];
            const glm::vec3 o = k == 0 ? center : center + 0.5f * radius * random_point(random);
            rays.push_back(probe_ray(o, glm::normalize(a - o)));
            rays.push_back(probe_ray(o, glm::normalize(0.5f * (a + b) - o)));
        }
    }
    return rays;
}

} // namespace

TEST_CASE("no ray leaves a closed mesh", "[stress]") {
    const glm::vec3 center = GENERATE(glm::vec3(0.0f), glm::vec3(148376.0f, 1234.0f, -223423.0f));
    const float radius = GENERATE(1.0f, 100.0f);
    // The smaller one far away is so coarse on the float grid that its triangles degenerate.
    const int rings = center.x > 0.0f && radius < 10.0f ? 12 : full_stress() ? 500 : 100;
    Random random(4);
    for (const auto &mesh : {sphere_mesh(rings, center, radius), cube_mesh(center, radius)}) {
        const Bvh bvh = build_bvh(mesh);
        const Rays rays = inside_rays(mesh, center, radius, random, rays_of(200000, 10000000));
        const std::size_t missed = misses(probe_closest(bvh, rays));
        const auto blocked = probe_any(bvh, rays);
        const auto passed = std::count(blocked.begin(), blocked.end(), false);
        fmt::print("{}\n",
                   selftest::describe({"bvh_closest",
                                       fmt::format("misses of {} rays, mesh of {} triangles",
                                                   rays.size(), mesh.size()),
                                       double(missed), 0}));
        CHECK(missed == 0);
        CHECK(passed == 0);
    }
}

TEST_CASE("rays that leave a shape never meet it again", "[stress]") {
    // pbrt's test: shapes of all sizes, coordinates from 10^-8 to 10^8, each alone in its scene.
    // Those that share one differ by what they can be told apart by: their distance.
    Random random(14);
    const int shapes = full_stress() ? 1000 : small_tests() ? 4 : 40;
    const int rays_each = full_stress() ? 1000 : 200;
    std::size_t traced = 0, again = 0;
    for (int shape = 0; shape < shapes; ++shape) {
        const float scale = std::pow(10.0f, 8.0f * random_point(random).x);
        const glm::vec3 place = scale * random_point(random);
        BvhScene scene;
        if (shape % 2 == 0)
            scene.triangles.push_back({place + scale * random_point(random),
                                       place + scale * random_point(random),
                                       place + scale * random_point(random)});
        else
            scene.add_sphere(place, scale * (0.01f + std::abs(random_point(random).x)));
        const Bvh bvh = build_bvh(scene.triangles, scene.spheres);
        if (bvh.primitives == 0)
            continue; // without area in float32
        Rays first;
        for (int i = 0; i < rays_each; ++i) {
            const glm::vec3 o = place + 4.0f * scale * random_point(random);
            const glm::vec3 aim =
                shape % 2 == 0
                    ? (scene.triangles[0][0] + scene.triangles[0][1] + scene.triangles[0][2]) / 3.0f
                    : place;
            first.push_back(probe_ray(o, glm::normalize(aim - o)));
        }
        const auto hits = probe_closest(bvh, first);
        Rays second;
        for (std::size_t i = 0; i < first.size(); ++i) {
            if (hits[i].prim == BVH_NO_PRIM)
                continue;
            const BvhProbeRay &r = first[i];
            const glm::vec3 p =
                glm::vec3(r.o[0], r.o[1], r.o[2]) + hits[i].t * glm::vec3(r.d[0], r.d[1], r.d[2]);
            glm::vec3 d = random_direction(random);
            if (shape % 2 == 1 && glm::dot(d, p - place) < 0.0f)
                d = -d;
            second.push_back(probe_ray(p, d, INFINITY, 0));
        }
        const auto met = probe_closest(bvh, second);
        const auto blocked = probe_any(bvh, second);
        traced += second.size();
        again += second.size() - misses(met);
        again += std::size_t(std::count(blocked.begin(), blocked.end(), true));
    }
    fmt::print("{}\n", selftest::describe({"bvh_closest",
                                           fmt::format("re-intersections of {} rays", traced),
                                           double(again), 0}));
    CHECK(again == 0);
    CHECK(traced > std::size_t(shapes * rays_each / 4));
}

TEST_CASE("triangles are hit to 16 ulp inside, needles too", "[stress]") {
    Random random(15);
    const int triangles = 200;
    const int rays_each = rays_of(100, 5000);
    selftest::Worst broad, needle;
    std::size_t missed = 0, interior = 0;
    for (int k = 0; k < (small_tests() ? 5 : triangles); ++k) {
        // Every second one a needle, up to a million times as long as wide.
        const float width =
            k % 2 == 0 ? 1.0f : std::pow(10.0f, -6.0f * std::abs(random_point(random).x));
        const glm::vec3 long_side = random_direction(random);
        const glm::vec3 across = glm::normalize(glm::cross(long_side, random_direction(random)));
        const glm::vec3 corner = 0.3f * random_point(random);
        BvhScene scene;
        scene.triangles.push_back(
            {corner, corner + long_side, corner + 0.4f * long_side + width * across});
        const Bvh bvh = build_bvh(scene.triangles);
        Rays rays;
        for (int i = 0; i < rays_each; ++i) {
            const auto &t = scene.triangles[0];
            const glm::vec3 o = 3.0f * random_point(random);
            const double u = 0.05 + 0.4 * std::abs(random_point(random).x);
            const double v = 0.05 + 0.4 * std::abs(random_point(random).x);
            const Vector aim = Vector(t[0]) + u * (Vector(t[1]) - Vector(t[0])) +
                               v * (Vector(t[2]) - Vector(t[0]));
            rays.push_back(probe_ray(o, glm::vec3(glm::normalize(aim - Vector(o)))));
        }
        const auto hits = probe_closest(bvh, rays);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const auto oracle = oracle_hits(scene, 0, rays[i]);
            if (oracle.empty())
                continue;
            const auto &t = scene.triangles[0];
            const Vector n = glm::normalize(
                glm::cross(Vector(t[1]) - Vector(t[0]), Vector(t[2]) - Vector(t[0])));
            const double cosine =
                std::abs(glm::dot(n, Vector(rays[i].d[0], rays[i].d[1], rays[i].d[2])));
            // Farther inside, as seen, than the rays' own rounding: needles may be narrower.
            if (oracle[0].margin * double(width) * cosine < 2e-6)
                continue;
            ++interior;
            if (hits[i].prim == BVH_NO_PRIM) {
                ++missed;
                continue;
            }
            // The plane of a needle turns about it with the rounding of its corners.
            const double error =
                std::abs(hits[i].t - oracle[0].t) * cosine / selftest::ulp(oracle[0].t);
            (k % 2 == 0 ? broad : needle).see(k % 2 == 0 ? error : error * double(width));
        }
    }
    for (const selftest::Check &row :
         {selftest::Check{"bvh_closest", "largest error of t times the cosine, ulp", broad.value(),
                          16},
          selftest::Check{"bvh_closest", "the same times the width, needles to 10^6, ulp",
                          needle.value(), 16},
          selftest::Check{"bvh_closest",
                          fmt::format("misses of {} rays inside triangles", interior),
                          double(missed), 0}}) {
        fmt::print("{}\n", selftest::describe(row));
        CHECK(row.passed());
    }
    CHECK(interior > 50);
}
