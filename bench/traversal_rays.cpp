#include "traversal_rays.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

namespace clrender::bench {

namespace {

BvhProbeRay make_ray(const glm::vec3 &o, const glm::vec3 &d, float t_max, uint self) {
    return {{o.x, o.y, o.z}, t_max, {d.x, d.y, d.z}, self};
}

glm::vec3 vec(const float *v) {
    return {v[0], v[1], v[2]};
}

/// A camera that looks at the model from the front.
Rays camera_rays(int image_size) {
    Rays rays;
    const int tiles = image_size / 8;
    for (int tile = 0; tile < tiles * tiles; ++tile) {
        for (int i = 0; i < 64; ++i) {
            const int x = tile % tiles * 8 + i % 8;
            const int y = tile / tiles * 8 + i / 8;
            const float px = (float(x) + 0.5f) / float(image_size) - 0.5f;
            const float py = (float(y) + 0.5f) / float(image_size) - 0.5f;
            rays.push_back(make_ray({0.3f, 0.4f, 3.2f},
                                    glm::normalize(glm::vec3(px - 0.08f, py - 0.12f, -1.2f)),
                                    INFINITY, BVH_NO_PRIM));
        }
    }
    return rays;
}

/// Where a ray met a triangle, and the normal on its side.
struct Place {
    glm::vec3 p, n;
};

Place place_of(const Triangles &triangles, const BvhProbeRay &ray, const BvhProbeHit &hit) {
    const auto &t = triangles[hit.prim];
    const glm::vec3 n = glm::normalize(glm::cross(t[1] - t[0], t[2] - t[0]));
    const glm::vec3 d = vec(ray.d);
    return {vec(ray.o) + hit.t * d, glm::dot(n, d) > 0.0f ? -n : n};
}

/// From each hit a direction in proportion to the cosine.
void add_bounces(const Triangles &triangles, const Rays &rays, const Hits &hits,
                 std::mt19937 &random, Rays &bounces) {
    std::normal_distribution<float> normal;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (hits[i].prim != BVH_NO_PRIM) {
            const Place at = place_of(triangles, rays[i], hits[i]);
            const float a = normal(random);
            const float b = normal(random);
            const float c = normal(random);
            const glm::vec3 d = at.n + 0.999f * glm::normalize(glm::vec3(a, b, c));
            bounces.push_back(make_ray(at.p, glm::normalize(d), INFINITY, hits[i].prim));
        }
    }
}

Rays shadow_rays(const Triangles &triangles, const Rays &rays, const Hits &hits) {
    // Each tile of the image to one of four lights.
    const std::array<glm::vec3, 4> lights{glm::vec3(2, 3, 2), glm::vec3(-3, 1, 2),
                                          glm::vec3(0, 4, -1), glm::vec3(3, -1, -2)};
    Rays shadows;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (hits[i].prim != BVH_NO_PRIM) {
            const glm::vec3 p = place_of(triangles, rays[i], hits[i]).p;
            const glm::vec3 &light = lights[i / 64 % lights.size()];
            const float distance = glm::length(light - p);
            shadows.push_back(make_ray(p, (light - p) / distance, distance, hits[i].prim));
        }
    }
    return shadows;
}

} // namespace

std::vector<RaySet> make_rays(const Triangles &triangles, int image_size,
                              const std::function<Hits(const Rays &)> &closest) {
    std::mt19937 random(7);
    const Rays camera = camera_rays(image_size);
    const Hits seen = closest(camera);
    Rays first;
    add_bounces(triangles, camera, seen, random, first);

    // Few paths live so long outside of a room: more of them are started, within bounds.
    Rays third;
    for (int i = 0; i < 64 && third.size() < first.size(); ++i) {
        Rays start, second;
        add_bounces(triangles, camera, seen, random, start);
        add_bounces(triangles, start, closest(start), random, second);
        add_bounces(triangles, second, closest(second), random, third);
    }
    Rays shadows = shadow_rays(triangles, camera, seen);
    return {{"camera", camera, false, true},
            {"first bounce", std::move(first), false},
            {"third bounce", std::move(third), false},
            {"shadow", std::move(shadows), true}};
}

} // namespace clrender::bench
