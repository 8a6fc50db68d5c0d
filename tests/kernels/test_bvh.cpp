/// The traversal against an oracle in double, and what has to hold for every ray.

#include "bvh_oracle.h"
#include "selftest/check.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>

using namespace clrender;
using namespace clrender::test;

namespace {

/// Triangles of all sizes, boxes without thickness, and spheres, in [-1, 1]^3.
BvhScene random_scene(Random &random, int triangles, int spheres) {
    BvhScene scene;
    for (int i = 0; i < triangles; ++i) {
        const glm::vec3 place = random_point(random);
        const float size = std::exp2(-6.0f * std::abs(random_point(random).x));
        Triangle t{place + 0.3f * size * random_point(random),
                   place + 0.3f * size * random_point(random),
                   place + 0.3f * size * random_point(random)};
        if (i % 4 == 0) { // flat along one axis
            t[1][i / 4 % 3] = t[2][i / 4 % 3] = t[0][i / 4 % 3];
        }
        scene.triangles.push_back(t);
    }
    for (int i = 0; i < spheres; ++i) {
        const glm::vec3 center = random_point(random);
        scene.add_sphere(center, 0.01f + 0.1f * std::abs(random_point(random).x));
    }
    return scene;
}

/// Random rays; rays along an axis with zeros of either sign, or nearly so; origins in the plane of
/// a box or at a corner of a triangle.
Rays awkward_rays(const BvhScene &scene, Random &random, int count) {
    Rays rays;
    for (int i = 0; i < count; ++i) {
        glm::vec3 o = 1.5f * random_point(random);
        glm::vec3 d = random_direction(random);
        const int axis = i / 8 % 3;
        const auto &corner = scene.triangles[std::size_t(i) % scene.triangles.size()][i % 3];
        if (i % 8 == 1 || i % 8 == 2) {
            const float zero = i % 8 == 1 ? 0.0f : -0.0f;
            d = glm::vec3(zero);
            d[axis] = i / 24 % 2 == 0 ? 1.0f : -1.0f;
        } else if (i % 8 == 3) {
            d[axis] = i / 24 % 2 == 0 ? -0.0f : 1e-30f;
            d = glm::normalize(d);
        } else if (i % 8 == 4) {
            o[axis] = corner[axis];
        } else if (i % 8 == 5) { // in the plane of a box, along it
            o[axis] = corner[axis];
            d[axis] = 0.0f;
            d = glm::normalize(d);
        } else if (i % 8 == 6) {
            o = corner;
        }
        const float t_max = i % 5 == 0 ? std::abs(random_point(random).x) : INFINITY;
        rays.push_back(probe_ray(o, d, t_max));
    }
    return rays;
}

bool same_bits(const BvhProbeHit &a, const BvhProbeHit &b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

} // namespace

TEST_CASE("the traversal finds what trying every primitive finds") {
    Random random(1);
    const BvhScene scene = random_scene(random, 600, 40);
    const Bvh bvh = build_bvh(scene.triangles, scene.spheres);
    const Rays rays = awkward_rays(scene, random, rays_of(40000));
    const auto hits = probe_closest(bvh, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const std::string problem = check_hit(scene, rays[i], hits[i]);
        INFO("ray " << i << ": " << problem);
        REQUIRE(problem.empty());
    }
    const std::size_t found = rays.size() - misses(hits);
    CHECK(found > rays.size() / 10);
    CHECK(found < rays.size());
}

TEST_CASE("the hit does not depend on the tree, to the bit") {
    Random random(2);
    BvhScene scene = random_scene(random, 3000, 100);
    for (int i = 0; i < 50; ++i) { // twins: the lower prim id wins
        scene.triangles[std::size_t(i + 100)] = scene.triangles[std::size_t(i)];
    }
    BvhOptions balanced;
    balanced.max_levels = 4;
    const Bvh a = build_bvh(scene.triangles, scene.spheres);
    const Bvh b = build_bvh(scene.triangles, scene.spheres, balanced);
    const Rays rays = awkward_rays(scene, random, rays_of(100000));
    const auto hits_a = probe_closest(a, rays);
    const auto hits_b = probe_closest(b, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        INFO("ray " << i << ": " << hits_a[i].prim << " at " << hits_a[i].t << ", "
                    << hits_b[i].prim << " at " << hits_b[i].t);
        REQUIRE(same_bits(hits_a[i], hits_b[i]));
        const bool higher_twin = hits_a[i].prim >= 100 && hits_a[i].prim < 150;
        REQUIRE_FALSE(higher_twin);
    }
}

TEST_CASE("a packet finds what its rays find one by one, to the bit", "[oclgrind]") {
    Random random(12);
    BvhScene scene = random_scene(random, 3000, 300);
    for (int i = 0; i < 50; ++i) { // twins: the lower prim id wins
        scene.triangles[std::size_t(i + 100)] = scene.triangles[std::size_t(i)];
    }
    const Bvh bvh = build_bvh(scene.triangles, scene.spheres);
    Rays rays = awkward_rays(scene, random, rays_of(100000));
    // Side by side those that may share a packet; each tenth goes another way, or nowhere.
    const auto way = [](const BvhProbeRay &ray) {
        int longest = 0;
        for (int axis = 1; axis < 3; ++axis) {
            longest = std::abs(ray.d[axis]) > std::abs(ray.d[longest]) ? axis : longest;
        }
        return std::array{std::signbit(ray.d[0]), std::signbit(ray.d[1]), std::signbit(ray.d[2]),
                          longest == 1, longest == 2};
    };
    std::sort(rays.begin(), rays.end(),
              [&](const BvhProbeRay &a, const BvhProbeRay &b) { return way(a) < way(b); });
    for (std::size_t i = 0; i < rays.size(); i += 10) {
        rays[i] = i % 20 == 0 ? probe_ray(random_point(random), random_direction(random))
                              : probe_ray(random_point(random), glm::vec3(0.0f));
    }
    const auto apart = probe_closest(bvh, rays);
    const int lanes = GENERATE(8, 16);
    INFO(lanes << " lanes");
    const auto packed = probe_packets(bvh, rays, lanes);
    std::size_t traced = 0, found = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (packed[i].prim != BVH_PROBE_NOT_TRACED) {
            INFO("ray " << i << ": " << apart[i].prim << " at " << apart[i].t << ", "
                        << packed[i].prim << " at " << packed[i].t);
            REQUIRE(same_bits(apart[i], packed[i]));
            ++traced;
            found += apart[i].prim != BVH_NO_PRIM ? 1 : 0;
        }
    }
    CHECK(traced > rays.size() / 3);
    CHECK(found > rays.size() / 10);
}

TEST_CASE("four boxes or primitives at once are tested as eight are, to the bit", "[oclgrind]") {
    // Blocks of all fillings: the padding behind the last primitive must not count.
    Random random(9);
    std::size_t found = 0;
    for (const auto &[triangles, spheres] : {std::pair(300, 100), std::pair(5, 3)}) {
        const BvhScene scene = random_scene(random, triangles, spheres);
        const Bvh bvh = build_bvh(scene.triangles, scene.spheres);
        const Rays rays = awkward_rays(scene, random, rays_of(20000));
        const auto eight = probe_closest(bvh, rays);
        const auto four = probe_closest(bvh, rays, 4);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            INFO("ray " << i << ": " << eight[i].prim << " at " << eight[i].t << ", "
                        << four[i].prim << " at " << four[i].t);
            REQUIRE(same_bits(eight[i], four[i]));
        }
        // The few rays under Oclgrind may all miss the few primitives.
        found += rays.size() - misses(eight);
        CHECK(probe_any(bvh, rays, 4) == probe_any(bvh, rays));
    }
    CHECK(found > 0);
}

TEST_CASE("the weights of a hit give the point of the hit") {
    Random random(3);
    const BvhScene scene = random_scene(random, 200, 0);
    const Bvh bvh = build_bvh(scene.triangles);
    const Rays rays = awkward_rays(scene, random, rays_of(20000));
    const auto hits = probe_closest(bvh, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (hits[i].prim != BVH_NO_PRIM) {
            const Triangle &t = scene.triangles[hits[i].prim];
            const glm::vec3 by_weights =
                t[0] + hits[i].u * (t[1] - t[0]) + hits[i].v * (t[2] - t[0]);
            const BvhProbeRay &r = rays[i];
            const glm::vec3 by_ray =
                glm::vec3(r.o[0], r.o[1], r.o[2]) + hits[i].t * glm::vec3(r.d[0], r.d[1], r.d[2]);
            REQUIRE(glm::length(by_weights - by_ray) < 1e-5f);
        }
    }
}

TEST_CASE("a ray that is none hits nothing and ends", "[oclgrind]") {
    Random random(5);
    BvhScene scene = random_scene(random, 300, 10);
    scene.add_sphere(glm::vec3(0.0f), 10.0f);
    const Bvh bvh = build_bvh(scene.triangles, scene.spheres);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float denormal = 1e-40f;
    Rays rays;
    for (const float bad : {nan, INFINITY, -INFINITY}) {
        for (int axis = 0; axis < 3; ++axis) {
            glm::vec3 o(0.1f), d(0.6f, 0.0f, 0.8f);
            o[axis] = bad;
            rays.push_back(probe_ray(o, d));
            o = glm::vec3(0.1f);
            d[axis] = bad;
            rays.push_back(probe_ray(o, d));
        }
    }
    rays.push_back(probe_ray(glm::vec3(0.1f), glm::vec3(0.0f)));
    rays.push_back(probe_ray(glm::vec3(0.1f), glm::vec3(-0.0f)));
    rays.push_back(probe_ray(glm::vec3(0.1f), glm::vec3(denormal)));
    rays.push_back(probe_ray(glm::vec3(0.1f), glm::vec3(nan)));
    rays.push_back(probe_ray(glm::vec3(nan), glm::vec3(nan)));
    for (const float t_max : {nan, 0.0f, -0.0f, -1.0f, -INFINITY}) {
        rays.push_back(probe_ray(glm::vec3(0.1f), glm::vec3(0.6f, 0.0f, 0.8f), t_max));
    }
    CHECK(misses(probe_closest(bvh, rays)) == rays.size());
    const auto blocked = probe_any(bvh, rays);
    CHECK(std::count(blocked.begin(), blocked.end(), true) == 0);

    // One denormal component is no fault.
    const Rays fine = {probe_ray(glm::vec3(0.1f), glm::vec3(denormal, 0.6f, 0.8f))};
    CHECK(misses(probe_closest(bvh, fine)) == 0);
}

TEST_CASE("the nearest hit is before t_max, and any hit is there when a nearest is") {
    Random random(6);
    const BvhScene scene = random_scene(random, 2000, 100);
    const Bvh bvh = build_bvh(scene.triangles, scene.spheres);
    Rays rays = awkward_rays(scene, random, rays_of(100000));
    const auto hits = probe_closest(bvh, rays);
    const auto blocked = probe_any(bvh, rays);
    Rays up_to_hit, up_to_behind;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        REQUIRE(blocked[i] == (hits[i].prim != BVH_NO_PRIM));
        if (blocked[i]) {
            REQUIRE(hits[i].t > 0.0f);
            REQUIRE(hits[i].t < rays[i].t_max);
            BvhProbeRay ray = rays[i];
            ray.t_max = hits[i].t;
            up_to_hit.push_back(ray);
            ray.t_max = std::nextafter(hits[i].t, INFINITY);
            up_to_behind.push_back(ray);
        }
    }
    // t_max itself is out of reach, one step more is not.
    CHECK(misses(probe_closest(bvh, up_to_hit)) == up_to_hit.size());
    CHECK(misses(probe_closest(bvh, up_to_behind)) == 0);
}

TEST_CASE("a surface is not hit again by the ray that starts on it") {
    Random random(7);
    const BvhScene scene = random_scene(random, 1000, 200);
    const Bvh bvh = build_bvh(scene.triangles, scene.spheres);
    const Rays first = awkward_rays(scene, random, rays_of(100000));
    const auto hits = probe_closest(bvh, first);
    Rays second;
    std::vector<bool> outwards;
    for (std::size_t i = 0; i < first.size(); ++i) {
        if (hits[i].prim != BVH_NO_PRIM) {
            const BvhProbeRay &r = first[i];
            const glm::vec3 p =
                glm::vec3(r.o[0], r.o[1], r.o[2]) + hits[i].t * glm::vec3(r.d[0], r.d[1], r.d[2]);
            const glm::vec3 d = random_direction(random);
            second.push_back(probe_ray(p, d, INFINITY, hits[i].prim));
            const bool sphere = hits[i].prim >= scene.triangles.size();
            outwards.push_back(
                !sphere || glm::dot(p - scene.spheres[hits[i].prim - scene.triangles.size()].center,
                                    d) > 0.0f);
        }
    }
    const auto again = probe_closest(bvh, second);
    for (std::size_t i = 0; i < second.size(); ++i) {
        if (outwards[i]) {
            REQUIRE(again[i].prim != second[i].self);
        } else {
            const std::string problem = check_hit(scene, second[i], again[i]);
            INFO(problem);
            REQUIRE(problem.empty());
        }
    }
}

TEST_CASE("a ray leaves all spheres that coincide with the one it starts on") {
    Random random(13);
    BvhScene scene;
    const int copies = 3;
    for (int i = 0; i < 100; ++i) {
        const glm::vec3 center = 10.0f * random_point(random);
        const float radius = std::exp2(4.0f * random_point(random).x);
        for (int copy = 0; copy < copies; ++copy) // the last one is larger by a few units
            scene.add_sphere(center, copy < 2 ? radius : radius * (1.0f + 2e-7f));
    }
    const Bvh bvh = build_bvh(scene.triangles, scene.spheres);
    Rays rays;
    std::vector<double> cosines;
    for (int i = 0; i < rays_of(100000); ++i) {
        const uint prim = uint(i) % uint(scene.spheres.size());
        const BvhSphere &sphere = scene.spheres[prim];
        const glm::vec3 n = random_direction(random), d = random_direction(random);
        const float reach = sphere.radius * 1.99f * std::abs(glm::dot(n, d));
        rays.push_back(probe_ray(sphere.center + sphere.radius * n, d, reach, prim));
        cosines.push_back(double{glm::dot(n, d)});
    }
    const auto hits = probe_closest(bvh, rays);
    const auto blocked = probe_any(bvh, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        // Grazing rays are left out: there the larger one is a longer way through.
        const bool is_twin = hits[i].prim / copies == rays[i].self / copies;
        INFO("cosine " << cosines[i] << ", " << hits[i].prim << " at " << hits[i].t << " from "
                       << rays[i].self);
        if (std::abs(cosines[i]) > 0.02) {
            REQUIRE((hits[i].prim == BVH_NO_PRIM || !is_twin));
            REQUIRE(blocked[i] == (hits[i].prim != BVH_NO_PRIM));
        }
    }
}

TEST_CASE("spheres far away and huge ones nearby are hit where they are") {
    Random random(8);
    SECTION("from afar") {
        const float distance = GENERATE(1e3f, 1e4f, 1e5f);
        const double allowed = distance < 5e3f ? 1e-4 : distance < 5e4f ? 5e-4 : 5e-3;
        BvhScene scene;
        scene.add_sphere(glm::vec3(0.0f), 1.0f);
        const Bvh bvh = build_bvh(scene.triangles, scene.spheres);
        Rays rays;
        for (int i = 0; i < rays_of(200000); ++i) {
            const glm::vec3 o = distance * random_direction(random);
            const glm::vec3 aim = 1.2f * random_point(random);
            rays.push_back(probe_ray(o, glm::vec3(glm::normalize(Vector(aim) - Vector(o)))));
        }
        const auto hits = probe_closest(bvh, rays);
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const auto oracle = oracle_hits(scene, 0, rays[i]);
            wrong += (oracle[0].margin > 0.0) != (hits[i].prim == 0);
            if (hits[i].prim == 0 && oracle[0].margin > 0.02) { // within .99 of the radius
                REQUIRE(std::abs(hits[i].t - oracle[0].t) <=
                        8.0 * (std::nextafter(distance, INFINITY) - distance));
            }
        }
        INFO(wrong << " of " << rays.size() << " wrong");
        CHECK(double(wrong) <= allowed * double(rays.size()));
    }
    SECTION("from close by") {
        const float radius = GENERATE(1.0f, 1e3f, 1e5f, 1e7f);
        selftest::Worst worst;
        BvhScene scene;
        scene.add_sphere(glm::vec3(0.0f, -radius, 0.0f), radius);
        const Bvh bvh = build_bvh(scene.triangles, scene.spheres);
        Rays rays;
        for (int i = 0; i < rays_of(100000); ++i) {
            const float gap = radius * std::exp2(-20.0f * std::abs(random_point(random).x));
            glm::vec3 d = random_direction(random);
            d.y = -std::abs(d.y) * std::exp2(-10.0f * std::abs(random_point(random).x));
            d = glm::normalize(d);
            rays.push_back(probe_ray({0.0f, gap, 0.0f}, d));
        }
        const auto hits = probe_closest(bvh, rays);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const auto oracle = oracle_hits(scene, 0, rays[i]);
            // b^2 and c cancel where the ray grazes; below a hundredth of b^2 even the rounding of
            // the direction's length shows.
            const double quarter = oracle[0].margin * radius * radius;
            const double b = 0.5 * (oracle[0].t + oracle[1].t);
            if (quarter > 0.01 * b * b) {
                REQUIRE(hits[i].prim == 0);
                worst.see(std::abs(hits[i].t - oracle[0].t) / oracle[0].t);
            }
        }
        INFO("relative error of t " << worst.value());
        CHECK(worst.value() <= 2e-5);
        CHECK(worst.value() > 0.0);
    }
}

TEST_CASE("degenerate triangles are left out and nothing else", "[oclgrind]") {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const Triangle good{glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)};
    BvhScene scene;
    scene.triangles = {good,
                       {good[0], good[0], good[1]},
                       {good[0], good[1], 2.0f * good[1]},
                       {good[0], good[1], glm::vec3(nan, 0, 0)},
                       {good[0], good[1], glm::vec3(0, 1e30f, 0)},
                       {glm::vec3(INFINITY), good[1], good[2]},
                       good};
    scene.spheres = {{glm::vec3(0, 0, 5), 1.0f, 7},
                     {glm::vec3(0, 0, 5), 0.0f, 8},
                     {glm::vec3(0, 0, 5), -1.0f, 9},
                     {glm::vec3(0, 0, nan), 1.0f, 10},
                     {glm::vec3(0, 0, 5), nan, 11}};
    const Bvh bvh = build_bvh(scene.triangles, scene.spheres);
    CHECK(bvh.primitives == 3);
    CHECK(bvh.degenerate == 9);
    const auto hits = probe_closest(bvh, {probe_ray({0.2f, 0.2f, -1.0f}, {0, 0, 1}),
                                          probe_ray({0.2f, 0.2f, 0.5f}, {0, 0, 1}),
                                          probe_ray({0.2f, 0.2f, -1.0f}, {0, 0, -1})});
    CHECK(hits[0].prim == 0);
    CHECK(hits[0].t == Approx(1.0f));
    CHECK(hits[0].u == Approx(0.2f));
    CHECK(hits[0].v == Approx(0.2f));
    CHECK(hits[1].prim == 7);
    CHECK(hits[2].prim == BVH_NO_PRIM);
}

TEST_CASE("a tree is sound, and the same on one thread and on all") {
    // More triangles than the builder bins on one thread.
    const auto mesh = sphere_mesh(small_tests() ? 30 : 300, glm::vec3(0.0f), 1.0f);
    const Bvh bvh = build_bvh(mesh);
    BvhOptions alone;
    alone.parallel = false;
    const Bvh serial = build_bvh(mesh, {}, alone);
    REQUIRE(bvh.nodes.size() == serial.nodes.size());
    REQUIRE(bvh.triangle_blocks.size() == serial.triangle_blocks.size());
    CHECK(std::memcmp(bvh.nodes.data(), serial.nodes.data(), bvh.nodes.size() * sizeof(BvhNode)) ==
          0);
    CHECK(std::memcmp(bvh.triangle_blocks.data(), serial.triangle_blocks.data(),
                      bvh.triangle_blocks.size() * sizeof(TriangleBlock)) == 0);

    const std::size_t bytes =
        bvh.nodes.size() * sizeof(BvhNode) + bvh.triangle_blocks.size() * sizeof(TriangleBlock);
    CHECK(bytes <= 100 * mesh.size());

    std::vector<int> seen(mesh.size(), 0);
    for (std::size_t i = 0; i < bvh.nodes.size(); ++i) {
        for (int slot = 0; slot < BVH_WIDTH; ++slot) {
            const uint child = bvh.nodes[i].child[slot];
            if (child == BVH_NO_CHILD)
                continue;
            if (bvh_child_kind(child) == BVH_CHILD_INNER) {
                REQUIRE(bvh.nodes.at(bvh_child_index(child)).parent == i);
            } else if (bvh_child_kind(child) == BVH_CHILD_TRIANGLES) {
                const TriangleBlock &block = bvh.triangle_blocks.at(bvh_child_index(child));
                for (int lane = 0; lane < BVH_WIDTH; ++lane) {
                    seen.at(block.prim[lane]) += lane == 0 || block.prim[lane] != block.prim[0];
                    for (int k = 0; k < 9; ++k) {
                        const float x = block.vertex[k / 3][k % 3][lane];
                        REQUIRE(x >= bvh.nodes[i].planes[BVH_PLANE_LOWER + k % 3][slot]);
                        REQUIRE(x <= bvh.nodes[i].planes[BVH_PLANE_UPPER + k % 3][slot]);
                    }
                }
            }
        }
    }
    // The triangles at the poles have no area.
    CHECK(std::count(seen.begin(), seen.end(), 1) == std::ptrdiff_t(bvh.primitives));
    CHECK(std::count(seen.begin(), seen.end(), 0) == std::ptrdiff_t(bvh.degenerate));
}

TEST_CASE("a tree of nothing is hit by nothing", "[oclgrind]") {
    const Bvh bvh = build_bvh({});
    CHECK(bvh.nodes.size() == 1);
    Random random(9);
    Rays rays;
    for (int i = 0; i < 100; ++i) {
        rays.push_back(probe_ray(random_point(random), random_direction(random)));
    }
    rays.push_back(probe_ray(glm::vec3(0.0f), glm::vec3(0, 0, 1)));
    CHECK(misses(probe_closest(bvh, rays)) == rays.size());
}

TEST_CASE("a deep tree stays within the trail") {
    // Triangles that grow exponentially, each around all before it: the surface area heuristic
    // peels off one after another.
    BvhScene scene;
    for (int i = 0; i < 1500; ++i) {
        const float size = std::exp2(-20.0f + 0.025f * float(i));
        const float angle = 0.7f * float(i);
        const glm::vec3 direction(std::cos(angle), std::sin(angle), std::cos(0.3f * angle));
        scene.triangles.push_back({size * direction, 1.1f * size * direction,
                                   1.05f * size * (direction + glm::vec3(0.1f, -0.1f, 0.1f))});
    }
    BvhOptions shallow;
    shallow.max_levels = 5;
    Random random(10);
    for (const BvhOptions &options : {BvhOptions{}, shallow}) {
        const Bvh bvh = build_bvh(scene.triangles, {}, options);
        CHECK(bvh.primitives == scene.triangles.size());
        CHECK(bvh.levels <= options.max_levels);
        Rays rays;
        for (int i = 0; i < rays_of(5000); ++i) {
            const Triangle &t = scene.triangles[std::size_t(i) % scene.triangles.size()];
            const glm::vec3 aim = (t[0] + t[1] + t[2]) / 3.0f;
            const glm::vec3 o = aim + 3.0f * glm::length(aim) * random_direction(random);
            rays.push_back(probe_ray(o, glm::normalize(aim - o)));
        }
        const auto hits = probe_closest(bvh, rays);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            // What is hit has to be there or before; the extent says nothing about small ones.
            const uint aimed = uint(i % scene.triangles.size());
            const auto oracle = oracle_hits(scene, aimed, rays[i]);
            if (!oracle.empty() && oracle[0].margin > 0.05) {
                INFO("triangle " << aimed << " at " << oracle[0].t);
                REQUIRE(hits[i].prim != BVH_NO_PRIM);
                REQUIRE(hits[i].t <= oracle[0].t * 1.0001);
            }
        }
    }
}
