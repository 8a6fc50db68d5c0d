#include "checks.h"

#include <cmath>
#include <fmt/core.h>
#include <limits>
#include <utility>

namespace clrender::selftest {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr float far_away = std::numeric_limits<float>::infinity();

/// Rays against spheres, a sphere for each group.
struct SphereRays {
    std::vector<SphereTest> spheres;
    std::vector<float> in;

    void add_sphere(const glm::dvec3 &center, double radius) {
        const glm::vec3 c(center);
        const auto r = static_cast<float>(radius);
        spheres.push_back({{c.x, c.y, c.z}, r * r});
    }
    void add_ray(const glm::dvec3 &o, const glm::dvec3 &d, double t_max, bool self) {
        for (const glm::dvec3 &v : {o, d})
            for (int c = 0; c < 3; ++c)
                in.push_back(static_cast<float>(v[c]));
        in.push_back(static_cast<float>(t_max));
        in.push_back(self ? 1.0f : 0.0f);
    }
    [[nodiscard]] std::size_t count() const { return in.size() / 8; }
};

/// What double precision says of one of them, the direction being no longer than it is.
struct SphereOracle {
    double near = infinity, far = infinity; ///< where the line meets the sphere
    double depth = 0;                       ///< how deep the line dips in, in squared radii
    double radius = 0, along = 0;
    double t_max = 0;
    bool self = false;

    SphereOracle(const SphereRays &rays, std::size_t i) {
        const float *v = &rays.in[8 * i];
        const SphereTest &s = rays.spheres[i / probe_group];
        const glm::dvec3 o(v[0], v[1], v[2]), d(v[3], v[4], v[5]);
        const glm::dvec3 f = o - glm::dvec3(s.center[0], s.center[1], s.center[2]);
        const double d2 = glm::dot(d, d), radius2 = s.radius2;
        along = -glm::dot(f, d) / d2;
        const glm::dvec3 nearest = f + along * d;
        const double inside = radius2 - glm::dot(nearest, nearest);
        depth = inside / radius2;
        radius = std::sqrt(radius2);
        t_max = v[6];
        self = v[7] > 0.5f;
        if (inside > 0) {
            const double half = std::sqrt(inside / d2);
            near = along - half;
            far = along + half;
        }
    }

    /// Where a ray meets it first, the far side included.
    [[nodiscard]] double first() const {
        if (depth <= 0)
            return infinity;
        const double t = self ? (along > 0 ? far : infinity) : (near > 0 ? near : far);
        return t > 0 && t < t_max ? t : infinity;
    }
    /// Where it is met from outside.
    [[nodiscard]] double first_outside() const {
        return depth > 0 && near > 0 && near < t_max ? near : infinity;
    }
    /// Whether rounding may decide: the line grazes, or an end of the ray lies close to the
    /// surface.
    [[nodiscard]] bool is_close(double margin) const {
        if (std::abs(depth) < margin)
            return true;
        const double slack = margin * radius;
        for (const double t : {near, far})
            if (std::abs(t) < slack || std::abs(t - t_max) < slack)
                return true;
        return self && std::abs(along) < slack;
    }
};

struct SphereAnswer {
    double first, outside;
    bool blocks, blocks_opaque;
};

std::vector<SphereAnswer> ask(ProbeDevice &device, const SphereRays &rays, bool large) {
    const cl::Buffer spheres = device.upload(rays.spheres);
    const std::vector<float> out =
        device.run("probe_sphere", rays.in, 8, 4, spheres, cl_uint{large ? 1u : 0u});
    std::vector<SphereAnswer> answers;
    answers.reserve(rays.count());
    for (std::size_t i = 0; i < rays.count(); ++i)
        answers.push_back(
            {out[4 * i], out[4 * i + 1], out[4 * i + 2] > 0.5f, out[4 * i + 3] > 0.5f});
    return answers;
}

/// A sphere of radius 1 from afar: rays at it and past it.
void check_far(ProbeDevice &device, double distance, double allowed, Checks &checks) {
    Random random(1);
    SphereRays rays;
    const std::size_t count = device.count(1e6);
    for (std::size_t i = 0; i < count; ++i) {
        if (i % probe_group == 0)
            rays.add_sphere(random.point(), 1);
        const SphereTest &s = rays.spheres.back();
        const glm::dvec3 center(s.center[0], s.center[1], s.center[2]);
        const glm::dvec3 o = rounded(center + distance * random.direction());
        rays.add_ray(o, glm::normalize(center + 1.2 * random.point() - o), far_away, false);
    }
    const std::vector<SphereAnswer> answers = ask(device, rays, false);
    WrongShare wrong_first, wrong_outside, wrong_blocks, wrong_opaque;
    Worst error_first, error_outside;
    for (std::size_t i = 0; i < count; ++i) {
        const SphereOracle oracle(rays, i);
        const SphereAnswer &answer = answers[i];
        const bool hit = oracle.depth > 0;
        wrong_first.see(hit != (answer.first < infinity));
        wrong_outside.see(hit != (answer.outside < infinity));
        wrong_blocks.see(hit != answer.blocks);
        wrong_opaque.see(hit != answer.blocks_opaque);
        if (oracle.depth > 0.02) { // less than .99 of the radius off its centre
            error_first.see(std::abs(answer.first - oracle.near) / ulp(distance));
            error_outside.see(std::abs(answer.outside - oracle.near) / ulp(distance));
        }
    }
    const std::string from = fmt::format(", from {:g} radii", distance);
    const std::string share = "share of wrong hits" + from;
    const std::string error = "largest error of t in ulp" + from;
    checks.push_back({"sphere_intersect", share, wrong_first.value(), allowed});
    checks.push_back({"sphere_root_bits", share, wrong_outside.value(), allowed});
    checks.push_back({"sphere_blocks", share, wrong_blocks.value(), allowed});
    checks.push_back({"sphere_blocks_opaque", share, wrong_opaque.value(), allowed});
    checks.push_back({"sphere_intersect", error, error_first.value(), 8});
    checks.push_back({"sphere_root_bits", error, error_outside.value(), 8});
}

/// Spheres as rooms have them, rays from outside, inside and the surface, up to any distance. From
/// outside alone where `large`: then with the other formula, for spheres larger than the room.
void check_room(ProbeDevice &device, bool large, Checks &checks) {
    Random random(large ? 5 : 2);
    SphereRays rays;
    const std::size_t count = device.count(1e6);
    double radius = 1;
    glm::dvec3 center;
    for (std::size_t i = 0; i < count; ++i) {
        if (i % probe_group == 0) {
            radius = large ? std::exp2(random.between(0, 6)) : std::exp2(random.between(-7, 0));
            center = random.point() + (large ? random.direction() * radius : glm::dvec3(0));
            rays.add_sphere(center, radius);
        }
        glm::dvec3 o = 2.0 * random.point();
        const glm::dvec3 n = random.direction();
        const std::size_t kind = i % 4;
        const bool self = kind == 3 && !large;
        if (self)
            o = center + radius * n;
        else if (kind == 1 && !large)
            o = center + radius * double{random.unit()} * n;
        const glm::dvec3 aim = center + 1.3 * radius * random.point();
        const glm::dvec3 d =
            kind == 0 || large ? glm::normalize(aim - rounded(o)) : random.direction();
        rays.add_ray(o, d, i % 3 == 0 ? double{far_away} : random.between(0, 4), self);
    }
    const std::vector<SphereAnswer> answers = ask(device, rays, large);
    WrongShare first, outside, blocks, opaque;
    Worst error_first, error_outside;
    for (std::size_t i = 0; i < count; ++i) {
        const SphereOracle oracle(rays, i);
        const SphereAnswer &answer = answers[i];
        if (oracle.is_close(1e-4))
            continue;
        const double t = oracle.first();
        first.see((t < infinity) != (answer.first < infinity));
        blocks.see((t < infinity) != answer.blocks);
        // Errors grow as the line grazes.
        const double unit = (std::abs(oracle.along) + oracle.radius) / std::sqrt(oracle.depth);
        if (t < infinity && answer.first < infinity)
            error_first.see(std::abs(answer.first - t) / unit);
        if (oracle.self || !(oracle.near > 0 || oracle.far < 0 || oracle.depth < 0))
            continue; // no ray starts inside of, or on, a sphere that these are asked for
        const double t_outside = oracle.first_outside();
        outside.see((t_outside < infinity) != (answer.outside < infinity));
        opaque.see((t_outside < infinity) != answer.blocks_opaque);
        if (t_outside < infinity && answer.outside < infinity)
            error_outside.see(std::abs(answer.outside - t_outside) / unit);
    }
    const std::string where = large ? ", spheres larger than the room" : ", spheres in a room";
    const std::string share = "share of wrong hits" + where;
    const std::string error = "error of t over distance and radius" + where;
    if (!large) {
        checks.push_back({"sphere_intersect", share, first.value(), 0});
        checks.push_back({"sphere_blocks", share, blocks.value(), 0});
        checks.push_back({"sphere_intersect", error, error_first.value(), 5e-7});
    }
    checks.push_back({"sphere_root_bits", share, outside.value(), 0});
    checks.push_back({"sphere_blocks_opaque", share, opaque.value(), 0});
    checks.push_back({"sphere_root_bits", error, error_outside.value(), large ? 4e-6 : 5e-7});
}

/// Close above a huge sphere: how far from its surface the hit points lie.
void check_near_huge(ProbeDevice &device, Checks &checks) {
    Random random(4);
    SphereRays rays;
    const std::size_t count = device.count(1e6);
    double radius = 1;
    for (std::size_t i = 0; i < count; ++i) {
        if (i % probe_group == 0) {
            radius = std::exp2(random.between(0, 23.25)); // 1 to 10^7
            rays.add_sphere(glm::dvec3(0), radius);
        }
        const glm::dvec3 n = random.direction();
        const glm::dvec3 o = rounded(n * radius * (1 + std::exp2(random.between(-20, 0))));
        glm::dvec3 d = random.direction();
        d -= n * (glm::dot(d, n) + std::exp2(random.between(-10, 0)));
        rays.add_ray(o, glm::normalize(d), far_away, false);
    }
    const std::vector<SphereAnswer> answers = ask(device, rays, false);
    const std::vector<SphereAnswer> large = ask(device, rays, true);
    Worst first, outside, outside_large;
    for (std::size_t i = 0; i < count; ++i) {
        const SphereOracle oracle(rays, i);
        const double half = (oracle.far - oracle.near) / 2;
        if (!(oracle.depth > 0) || half * half < 0.01 * oracle.along * oracle.along ||
            oracle.near <= 0)
            continue;
        const double cosine = half / oracle.radius;
        const double unit = ulp(oracle.radius);
        const auto height = [&](double t) {
            // A ray that misses takes the sphere for lying below its origin.
            return std::abs((t < infinity ? t : 0) - oracle.near) * cosine / unit;
        };
        first.see(height(answers[i].first));
        outside.see(height(answers[i].outside));
        outside_large.see(height(large[i].outside));
    }
    const std::string what = "height of hits above a huge sphere, ulp of its radius";
    checks.push_back({"sphere_intersect", what, first.value(), 12});
    checks.push_back({"sphere_root_bits", what, outside.value(), 12});
    checks.push_back({"sphere_root_bits", what + ", large", outside_large.value(), 12});
}

/// Close above a sphere that is huge against what lies around the origin, by what its surface does
/// there. Its centre lies below the origin, by the radius and a little less or more.
void check_huge(ProbeDevice &device, Checks &checks) {
    Random random(10);
    std::vector<SphereTest> entries;
    SphereRays rays;
    const std::size_t count = device.count(1e6);
    for (std::size_t i = 0; i < count; ++i) {
        if (i % probe_group == 0) {
            const double radius = std::exp2(random.between(6, 23.25)); // 64 to 10^7
            // Every second one goes through the origin, its centre on a coordinate axis: there the
            // direction is as exact as its cosine.
            const bool exact = i % (2 * probe_group) == 0;
            glm::vec3 a(-random.direction());
            if (exact) {
                a = glm::vec3(0);
                a[static_cast<int>(random.bits() % 3)] = -1;
            }
            const double h = exact ? 0 : random.between(-1, 1);
            entries.push_back({{a.x, a.y, a.z}, static_cast<float>(h)});
            entries.push_back({{static_cast<float>(1 / radius), static_cast<float>(radius), 0}, 0});
        }
        const SphereTest &s = entries[entries.size() - 2];
        const glm::dvec3 up = -glm::dvec3(s.center[0], s.center[1], s.center[2]);
        const double radius = entries.back().center[1];
        // Above the point of the sphere that is nearest to the origin.
        const double gap = radius * std::exp2(random.between(-20, -6));
        const glm::dvec3 o = up * (gap - double{s.radius2});
        glm::dvec3 d = random.direction();
        d -= up * (glm::dot(d, up) + std::exp2(random.between(-10, 0)));
        rays.add_ray(o, glm::normalize(d), far_away, false);
    }
    const cl::Buffer spheres = device.upload(entries);
    const std::vector<float> out = device.run("probe_sphere_huge", rays.in, 8, 1, spheres);
    Worst relative, height;
    for (std::size_t i = 0; i < count; ++i) {
        const float *v = &rays.in[8 * i];
        const SphereTest *s = &entries[2 * (i / probe_group)];
        const glm::dvec3 o(v[0], v[1], v[2]), d(v[3], v[4], v[5]);
        const glm::dvec3 a(s->center[0], s->center[1], s->center[2]);
        const double curvature = s[1].center[0];
        // g(o + t d) = 0, see sphere.clh.
        const double c = curvature / 2 * glm::dot(o, o) - glm::dot(a, o) + double{s->radius2};
        const double b = glm::dot(curvature * o - a, d);
        const double square = b * b - 2 * curvature * glm::dot(d, d) * c;
        if (square < 0.01 * b * b || c <= 0)
            continue;
        const double t = 2 * c / (-b + std::sqrt(square));
        const double error = std::abs(out[i] - t);
        height.see(error * std::sqrt(square) / ulp(glm::length(o) + std::abs(s->radius2) + t));
        if (s->radius2 == 0)
            relative.see(error / t);
    }
    const std::string function = "sphere_intersect_huge";
    checks.push_back(
        {function, "relative error of t, gaps from 2^-20 radii", relative.value(), 2e-5});
    checks.push_back({function, "height of hits, ulp of the distance", height.value(), 8});
}

/// Rays that are none never meet a sphere at a finite distance.
void check_no_rays(ProbeDevice &device, Checks &checks) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    SphereRays rays;
    for (const double bad : {nan, infinity, -infinity})
        for (int axis = 0; axis < 6; ++axis)
            for (const double t_max : {infinity, 10.0}) {
                glm::dvec3 o(0.1, 0.2, -3), d(0, 0.6, 0.8);
                (axis < 3 ? o : d)[axis % 3] = bad;
                rays.add_ray(o, d, t_max, false);
            }
    for (const double length : {0.0, -0.0, 1e-40})
        rays.add_ray({0.1, 0.2, -3}, glm::dvec3(length), infinity, false);
    const std::size_t bad_rays = rays.count();
    while (rays.count() % probe_group != 0)
        rays.add_ray({0, 0, 5}, {0, 0, 1}, infinity, false);
    for (std::size_t i = 0; i < rays.count() / probe_group; ++i)
        rays.add_sphere(glm::dvec3(0), 1);
    const std::vector<SphereAnswer> answers = ask(device, rays, false);
    WrongShare first, outside;
    for (std::size_t i = 0; i < bad_rays; ++i) {
        first.see(std::isfinite(answers[i].first));
        outside.see(std::isfinite(answers[i].outside));
    }
    const std::string what = "share of hits of rays that are none";
    checks.push_back({"sphere_intersect", what, first.value(), 0});
    checks.push_back({"sphere_root_bits", what, outside.value(), 0});
}

} // namespace

Checks check_spheres(ProbeDevice &device) {
    Checks checks;
    for (const auto &[distance, allowed] :
         {std::pair{1e3, 1e-4}, std::pair{1e4, 5e-4}, std::pair{1e5, 5e-3}})
        check_far(device, distance, allowed, checks);
    check_room(device, false, checks);
    check_room(device, true, checks);
    check_near_huge(device, checks);
    check_huge(device, checks);
    check_no_rays(device, checks);
    return checks;
}

} // namespace clrender::selftest
