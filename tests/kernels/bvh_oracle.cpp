#include "bvh_oracle.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>

namespace clrender::test {

namespace {

Vector vector(const float *v) {
    return {v[0], v[1], v[2]};
}

/// The kernels with so many rays a work-item, and so many boxes or primitives tested at once.
struct Probe {
    Probe(int lanes, int step)
        : program(device.build("probes/bvh_probes.cl",
                               fmt::format("-DLANES={} -DBVH_STEP={}", lanes, step))) {}
    ClTestDevice device;
    cl::Program program;
    cl::Kernel closest{program, "probe_bvh_closest"};
    cl::Kernel packet{program, "probe_bvh_packet"};
    cl::Kernel any{program, "probe_bvh_any"};
};

Probe &the_probe(int lanes, int step) {
    // Never destroyed: a runtime may have shut down before the statics of this program.
    static auto *const probes = new std::map<std::pair<int, int>, Probe>;
    return probes->try_emplace({lanes, step}, lanes, step).first->second;
}

std::vector<BvhProbeHit> run(cl::Kernel Probe::*which, const Bvh &bvh,
                             const std::vector<BvhProbeRay> &rays, int lanes = 8, int step = 8) {
    Probe &probe = the_probe(lanes, step);
    const ClTestDevice &device = probe.device;
    cl::Kernel &kernel = probe.*which;
    const cl::Buffer nodes = device.upload(std::span<const BvhNode>(bvh.nodes));
    const cl::Buffer triangles = device.upload(std::span<const TriangleBlock>(bvh.triangle_blocks));
    const cl::Buffer spheres = device.upload(std::span<const SphereBlock>(bvh.sphere_blocks));
    const cl::Buffer ray_buffer = device.upload(std::span<const BvhProbeRay>(rays));
    const cl::Buffer hits = device.allocate(rays.size() * sizeof(BvhProbeHit));
    kernel.setArg(0, nodes);
    kernel.setArg(1, triangles);
    kernel.setArg(2, spheres);
    kernel.setArg(3, ray_buffer);
    kernel.setArg(4, hits);
    kernel.setArg(5, cl_uint(rays.size()));
    const auto width = static_cast<std::size_t>(lanes);
    device.run(kernel, (rays.size() + width - 1) / width);
    return device.download<BvhProbeHit>(hits, rays.size());
}

/// Möller and Trumbore's test; in double the inputs' rounding is all that is left of its errors.
std::vector<OracleHit> triangle_hits(const Triangle &triangle, const BvhProbeRay &ray) {
    const Vector o = vector(ray.o), d = vector(ray.d);
    const Vector v0(triangle[0]);
    const Vector e1 = Vector(triangle[1]) - v0;
    const Vector e2 = Vector(triangle[2]) - v0;
    const Vector p = glm::cross(d, e2);
    const double det = glm::dot(e1, p);
    if (det == 0.0) {
        return {};
    }
    const Vector q = glm::cross(o - v0, e1);
    const double u = glm::dot(o - v0, p) / det;
    const double v = glm::dot(d, q) / det;
    return {{glm::dot(e2, q) / det, std::min({u, v, 1.0 - u - v})}};
}

std::vector<OracleHit> sphere_hits(const BvhSphere &sphere, const BvhProbeRay &ray) {
    const Vector d = glm::normalize(vector(ray.d));
    const Vector f = vector(ray.o) - Vector(sphere.center);
    const double b = -glm::dot(f, d);
    const Vector l = f + b * d;
    const double r = sphere.radius;
    const double quarter = r * r - glm::dot(l, l);
    const double margin = quarter / (r * r);
    const double root = std::sqrt(std::max(quarter, 0.0));
    if (ray.self == sphere.prim) {
        return b > 0.0 ? std::vector<OracleHit>{{b + root, margin}} : std::vector<OracleHit>{};
    }
    return {{b - root, margin}, {b + root, margin}};
}

} // namespace

double BvhScene::extent() const {
    double largest = 0.0;
    for (const Triangle &triangle : triangles) {
        for (const glm::vec3 &v : triangle) {
            largest = std::max(
                {largest, double(std::abs(v.x)), double(std::abs(v.y)), double(std::abs(v.z))});
        }
    }
    for (const BvhSphere &s : spheres) {
        largest = std::max(largest, double(glm::length(s.center) + s.radius));
    }
    return largest;
}

BvhProbeRay probe_ray(const glm::vec3 &o, const glm::vec3 &d, float t_max, uint self) {
    return {{o.x, o.y, o.z}, t_max, {d.x, d.y, d.z}, self};
}

glm::vec3 random_point(Random &random) {
    std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
    const float x = uniform(random);
    const float y = uniform(random);
    const float z = uniform(random);
    return {x, y, z};
}

glm::vec3 random_direction(Random &random) {
    for (;;) {
        const glm::vec3 p = random_point(random);
        const float length = glm::length(p);
        if (length > 0.01f && length <= 1.0f) {
            return p / length;
        }
    }
}

int rays_of(int count, int full) {
    if (full_stress())
        return std::max(count, full);
    return small_tests() ? std::max(count / 100, 20) : count;
}

std::vector<Triangle> sphere_mesh(int rings, const glm::vec3 &center, float radius) {
    const auto corner = [&](int i, int k) {
        // The poles and the seam are single points, computed from the same angles.
        const double theta = M_PI * i / rings;
        const double phi = 2.0 * M_PI * (k % rings) / rings;
        const double s = i == 0 || i == rings ? 0.0 : std::sin(theta);
        const Vector p(s * std::cos(phi), s * std::sin(phi), std::cos(theta));
        return glm::vec3(Vector(center) + double(radius) * p);
    };
    std::vector<Triangle> triangles;
    for (int i = 0; i < rings; ++i) {
        for (int k = 0; k < rings; ++k) {
            triangles.push_back({corner(i, k), corner(i + 1, k), corner(i + 1, k + 1)});
            triangles.push_back({corner(i, k), corner(i + 1, k + 1), corner(i, k + 1)});
        }
    }
    return triangles;
}

std::size_t misses(const std::vector<BvhProbeHit> &hits) {
    return std::size_t(std::count_if(
        hits.begin(), hits.end(), [](const BvhProbeHit &hit) { return hit.prim == BVH_NO_PRIM; }));
}

std::vector<BvhProbeHit> probe_closest(const Bvh &bvh, const std::vector<BvhProbeRay> &rays,
                                       int step) {
    return run(&Probe::closest, bvh, rays, 8, step);
}

std::vector<BvhProbeHit> probe_packets(const Bvh &bvh, const std::vector<BvhProbeRay> &rays,
                                       int lanes) {
    return run(&Probe::packet, bvh, rays, lanes);
}

std::vector<bool> probe_any(const Bvh &bvh, const std::vector<BvhProbeRay> &rays, int step) {
    std::vector<bool> blocked;
    for (const BvhProbeHit &hit : run(&Probe::any, bvh, rays, 8, step)) {
        blocked.push_back(hit.prim != 0);
    }
    return blocked;
}

std::vector<OracleHit> oracle_hits(const BvhScene &scene, uint prim, const BvhProbeRay &ray) {
    if (prim >= scene.triangles.size()) {
        return sphere_hits(scene.spheres.at(prim - scene.triangles.size()), ray);
    }
    return ray.self == prim ? std::vector<OracleHit>{} : triangle_hits(scene.triangles[prim], ray);
}

std::string check_hit(const BvhScene &scene, const BvhProbeRay &ray, const BvhProbeHit &hit,
                      double tolerance) {
    const Vector o = vector(ray.o);
    const double slack =
        tolerance * (scene.extent() + std::max({std::abs(o.x), std::abs(o.y), std::abs(o.z)}));
    const bool found = hit.prim != BVH_NO_PRIM;
    const double limit = found ? double(hit.t) : double(ray.t_max);

    bool confirmed = !found;
    for (uint prim = 0; prim < scene.triangles.size() + scene.spheres.size(); ++prim) {
        for (const OracleHit &oracle : oracle_hits(scene, prim, ray)) {
            if (prim == hit.prim && oracle.margin > -tolerance &&
                std::abs(oracle.t - hit.t) <= slack) {
                confirmed = true;
            }
            if (oracle.margin > tolerance && oracle.t > slack && oracle.t < limit - slack) {
                return fmt::format("found {} at {}, but {} is at {}", int(hit.prim), hit.t, prim,
                                   oracle.t);
            }
        }
    }
    return confirmed ? "" : fmt::format("found {} at {}, where it is not", hit.prim, hit.t);
}

} // namespace clrender::test
