#include "checks.h"

#include <cmath>
#include <fmt/core.h>
#include <limits>

namespace clrender::selftest {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

void store(float (&out)[3], const glm::dvec3 &v) {
    for (int c = 0; c < 3; ++c)
        out[c] = static_cast<float>(v[c]);
}

glm::dvec3 vector(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

/// A planar with these edges, as host/flatten makes it.
Planar make_planar(const glm::dvec3 &origin, const glm::dvec3 &du, const glm::dvec3 &dv,
                   bool disk) {
    Planar p{};
    const glm::dvec3 across = glm::cross(du, dv);
    const double area2 = glm::dot(across, across);
    store(p.origin, origin);
    store(p.normal, across / std::sqrt(area2));
    p.distance = static_cast<float>(glm::dot(across, origin) / std::sqrt(area2));
    store(p.du, du);
    store(p.dv, dv);
    store(p.ra, glm::cross(dv, across) / area2);
    store(p.rb, glm::cross(across, du) / area2);
    const glm::dvec3 half = glm::abs(du) + glm::abs(dv);
    p.half_x = static_cast<float>(half.x);
    p.half_y = static_cast<float>(half.y);
    p.half_z = static_cast<float>(half.z);
    p.is_disk = disk ? 1 : 0;
    return p;
}

enum class Kind { rectangle, disk, across };

/// A planar near the origin, from 2^`smallest` to 2 units to either side; `axis` is what a
/// rectangle stands across.
Planar random_planar(Random &random, Kind kind, int axis, double smallest) {
    const double a = std::exp2(random.between(smallest, 1));
    const double b = std::exp2(random.between(smallest, 1));
    const glm::dvec3 origin = random.point();
    if (kind == Kind::across) {
        glm::dvec3 du(0), dv(0);
        const bool turned = random.unit() < 0.5f;
        du[(axis + (turned ? 2 : 1)) % 3] = random.unit() < 0.5f ? a : -a;
        dv[(axis + (turned ? 1 : 2)) % 3] = random.unit() < 0.5f ? b : -b;
        return make_planar(origin, du, dv, false);
    }
    const glm::dvec3 n = random.direction();
    const glm::dvec3 side = glm::normalize(glm::cross(n, random.direction()));
    return make_planar(origin, a * side, b * glm::cross(n, side), kind == Kind::disk);
}

struct PlanarRays {
    std::vector<Planar> planars;
    std::vector<float> in;

    void add_ray(const glm::dvec3 &o, const glm::dvec3 &d) {
        for (const glm::dvec3 &v : {o, d})
            for (int c = 0; c < 3; ++c)
                in.push_back(static_cast<float>(v[c]));
    }
    [[nodiscard]] std::size_t count() const { return in.size() / 6; }
};

/// Where the line meets the plane, in double on the same floats, and how far inside the outline.
struct PlanarOracle {
    double t, a, b;
    double margin; ///< in the coordinates a and b; negative outside
    double cosine; ///< to the normal

    PlanarOracle(const PlanarRays &rays, std::size_t i, Kind kind) {
        const float *v = &rays.in[6 * i];
        const Planar &p = rays.planars[i / probe_group];
        const glm::dvec3 o(v[0], v[1], v[2]), d(v[3], v[4], v[5]);
        const glm::dvec3 n = glm::normalize(glm::cross(vector(p.du), vector(p.dv)));
        const glm::dvec3 from = o - vector(p.origin);
        cosine = glm::dot(n, d);
        t = -glm::dot(n, from) / cosine;
        const glm::dvec3 at = from + t * d;
        a = glm::dot(vector(p.ra), at);
        b = glm::dot(vector(p.rb), at);
        margin = kind == Kind::disk ? 1 - std::sqrt(a * a + b * b)
                                    : 1 - std::max(std::abs(a), std::abs(b));
    }
};

struct PlanarName {
    const char *function;
    const char *shape;
};

PlanarName name_of(Kind kind) {
    if (kind == Kind::across)
        return {"planar_intersect_across", "rectangles"};
    return {"planar_intersect", kind == Kind::disk ? "disks" : "rectangles"};
}

/// Rays at and past planars in a room, and along their planes.
void check_room(ProbeDevice &device, Kind kind, int axis, Checks &checks) {
    Random random(6 + static_cast<std::uint32_t>(axis));
    PlanarRays rays;
    const std::size_t count = device.count(kind == Kind::across ? 1e6 / 3 : 1e6);
    for (std::size_t i = 0; i < count; ++i) {
        if (i % probe_group == 0)
            rays.planars.push_back(random_planar(random, kind, axis, -3));
        const Planar &p = rays.planars.back();
        const glm::dvec3 o = 2.0 * random.point();
        const glm::dvec3 aim = vector(p.origin) + random.between(-1.2, 1.2) * vector(p.du) +
                               random.between(-1.2, 1.2) * vector(p.dv);
        glm::dvec3 d = i % 4 == 0 ? random.direction() : glm::normalize(aim - rounded(o));
        if (i % 16 == 1) { // along a coordinate axis, the others zeros of either sign
            d = glm::dvec3(i % 32 == 1 ? 0.0 : -0.0);
            d[static_cast<int>(i / 16 % 3)] = i % 64 < 32 ? 1 : -1;
        }
        rays.add_ray(o, d);
    }
    const cl::Buffer planars = device.upload(rays.planars);
    const std::vector<float> out =
        device.run("probe_planar", rays.in, 6, 1, planars,
                   static_cast<cl_uint>(kind == Kind::across ? axis : 3));
    WrongShare wrong;
    Worst error;
    for (std::size_t i = 0; i < count; ++i) {
        const PlanarOracle oracle(rays, i, kind);
        const double t = out[i];
        if (std::isnan(t))
            error.see(t);
        if (std::abs(oracle.cosine) < 1e-12) { // in the plane, or beside it
            wrong.see(t < infinity);
            continue;
        }
        // What rounding of the origin and of t can move the point by, in a and b.
        const Planar &p = rays.planars[i / probe_group];
        const double shortest = std::min(glm::length(vector(p.du)), glm::length(vector(p.dv)));
        const double moved = 2e-6 / (shortest * std::abs(oracle.cosine));
        if (std::abs(oracle.margin) < moved || std::abs(oracle.t) < moved * shortest)
            continue;
        const bool hit = oracle.margin > 0 && oracle.t > 0;
        wrong.see(hit != (t < infinity));
        if (hit && t < infinity)
            error.see(std::abs(t - oracle.t) * std::abs(oracle.cosine));
    }
    const PlanarName name = name_of(kind);
    const std::string shapes =
        kind == Kind::across ? fmt::format("{} across {}", name.shape, "xyz"[axis]) : name.shape;
    checks.push_back({name.function, "share of wrong hits, " + shapes, wrong.value(), 0});
    checks.push_back(
        {name.function, "error of t times the cosine, " + shapes, error.value(), 1e-6});
}

/// Planars of about unit size from afar.
void check_far(ProbeDevice &device, Kind kind, double distance, double allowed, Checks &checks) {
    Random random(9);
    PlanarRays rays;
    const std::size_t count = device.count(1e6);
    constexpr int axis = 1;
    for (std::size_t i = 0; i < count; ++i) {
        if (i % probe_group == 0)
            rays.planars.push_back(random_planar(random, kind, axis, 0));
        const Planar &p = rays.planars.back();
        const glm::dvec3 n = vector(p.normal);
        // Not at a grazing angle: then it looks smaller than it is.
        glm::dvec3 way = random.direction();
        while (std::abs(glm::dot(way, n)) < 0.3)
            way = random.direction();
        const glm::dvec3 o = rounded(vector(p.origin) + distance * way);
        const glm::dvec3 aim = vector(p.origin) + random.between(-1.2, 1.2) * vector(p.du) +
                               random.between(-1.2, 1.2) * vector(p.dv);
        rays.add_ray(o, glm::normalize(aim - o));
    }
    const cl::Buffer planars = device.upload(rays.planars);
    const std::vector<float> out =
        device.run("probe_planar", rays.in, 6, 1, planars,
                   static_cast<cl_uint>(kind == Kind::across ? axis : 3));
    WrongShare wrong;
    Worst error;
    for (std::size_t i = 0; i < count; ++i) {
        const PlanarOracle oracle(rays, i, kind);
        const double t = out[i];
        const bool hit = oracle.margin > 0 && oracle.t > 0;
        wrong.see(hit != (t < infinity));
        if (hit && t < infinity)
            error.see(std::abs(t - oracle.t) / ulp(distance));
    }
    const PlanarName name = name_of(kind);
    const std::string from = fmt::format(", {} from {:g} units", name.shape, distance);
    checks.push_back({name.function, "share of wrong hits" + from, wrong.value(), allowed});
    checks.push_back({name.function, "largest error of t in ulp" + from, error.value(), 8});
}

/// Rays that are none never meet a planar at a finite distance.
void check_no_rays(ProbeDevice &device, Kind kind, Checks &checks) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    PlanarRays rays;
    for (const double bad : {nan, infinity, -infinity})
        for (int axis = 0; axis < 6; ++axis) {
            glm::dvec3 o(0.1, 0.2, -3), d(0, 0.6, 0.8);
            (axis < 3 ? o : d)[axis % 3] = bad;
            // A component of the origin within the plane says nothing about the others.
            rays.add_ray(o, d);
        }
    for (const double length : {0.0, -0.0})
        rays.add_ray({0.1, 0.2, -3}, glm::dvec3(length));
    const std::size_t bad_rays = rays.count();
    while (rays.count() % probe_group != 0)
        rays.add_ray({0, 0, 5}, {0, 0, 1});
    for (std::size_t i = 0; i < rays.count() / probe_group; ++i)
        rays.planars.push_back(make_planar({0, 0, 0}, {3, 0, 0}, {0, 3, 0}, kind == Kind::disk));
    const cl::Buffer planars = device.upload(rays.planars);
    const std::vector<float> out = device.run("probe_planar", rays.in, 6, 1, planars,
                                              static_cast<cl_uint>(kind == Kind::across ? 2 : 3));
    WrongShare met;
    for (std::size_t i = 0; i < bad_rays; ++i)
        met.see(std::isfinite(out[i]));
    const PlanarName name = name_of(kind);
    checks.push_back({name.function,
                      std::string("share of hits of rays that are none, ") + name.shape,
                      met.value(), 0});
}

} // namespace

Checks check_planars(ProbeDevice &device) {
    Checks checks;
    check_room(device, Kind::rectangle, 0, checks);
    check_room(device, Kind::disk, 0, checks);
    for (int axis = 0; axis < 3; ++axis)
        check_room(device, Kind::across, axis, checks);
    for (const Kind kind : {Kind::rectangle, Kind::disk, Kind::across}) {
        check_far(device, kind, 1e3, 1e-4, checks);
        check_far(device, kind, 1e4, 5e-4, checks);
        check_far(device, kind, 1e5, 5e-3, checks);
        check_no_rays(device, kind, checks);
    }
    return checks;
}

} // namespace clrender::selftest
