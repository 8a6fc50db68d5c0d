#include "checks.h"

#include "flatten/light_tree.h"

#include <array>
#include <cmath>
#include <fmt/core.h>
#include <limits>
#include <numbers>

namespace clrender::selftest {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();

void store(float *out, const glm::dvec3 &v) {
    for (int c = 0; c < 3; ++c)
        out[c] = static_cast<float>(v[c]);
}

glm::dvec3 vector(const float *v) {
    return {v[0], v[1], v[2]};
}

enum class Kind { point, sphere, rectangle, disk, triangle, smooth_triangle };

constexpr std::array<Kind, 6> kinds{Kind::point, Kind::sphere,   Kind::rectangle,
                                    Kind::disk,  Kind::triangle, Kind::smooth_triangle};

const char *name_of(Kind kind) {
    constexpr std::array<const char *, 6> names{"point", "sphere",   "rectangle",
                                                "disk",  "triangle", "smooth triangle"};
    return names[static_cast<std::size_t>(kind)];
}

/// Lights in a scene's arrays, a tree over them, and an emitter for each. Light i is emitter i; the
/// number of a triangle as a primitive is 0.
struct Lights {
    FlatScene flat;
    std::vector<Kind> kind;
    std::vector<LightExtent> extents;

    Lights() { flat.shape_frames = {{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}}; }

    void add(Random &random, Kind k, const glm::dvec3 &at, double size) {
        Light light{};
        EmitterInfo info{};
        LightExtent extent;
        light.texture = info.texture = CLR_NONE;
        for (int c = 0; c < 3; ++c)
            light.radiance[c] = info.radiance[c] = static_cast<float>(random.between(0.5, 4));
        info.light = static_cast<uint>(flat.lights.size());
        store(light.position, at);
        extent.lower = at - size * 2;
        extent.upper = at + size * 2;
        extent.intensity = light.radiance[1] * size * size;
        switch (k) {
        case Kind::point:
            light.kind = info.kind = CLR_LIGHT_POINT;
            extent.lower = extent.upper = at;
            break;
        case Kind::sphere:
            light.kind = info.kind = CLR_LIGHT_SPHERE;
            light.radius = info.radius = static_cast<float>(size);
            std::copy_n(light.position, 3, info.center);
            info.density = 1;
            break;
        case Kind::rectangle:
        case Kind::disk:
            light.kind = info.kind = CLR_LIGHT_PLANAR;
            add_planar(random, k == Kind::disk, at, size, light);
            info.density = 1 / light.area;
            break;
        case Kind::triangle:
        case Kind::smooth_triangle:
            light.kind = info.kind = CLR_LIGHT_TRIANGLE;
            add_triangle(random, k == Kind::smooth_triangle, at, size, light);
            info.density = 1;
            break;
        }
        kind.push_back(k);
        flat.lights.push_back(light);
        flat.emitters.push_back(info);
        extents.push_back(extent);
    }

    void plant_tree() {
        const LightTree tree = build_light_tree(extents);
        flat.light_nodes = tree.nodes;
        for (std::size_t i = 0; i < flat.lights.size(); ++i)
            flat.lights[i].trail = tree.trail[i];
    }

private:
    void add_planar(Random &random, bool disk, const glm::dvec3 &at, double size, Light &light) {
        const glm::dvec3 n = random.direction();
        const glm::dvec3 side = glm::normalize(glm::cross(n, random.direction()));
        const glm::dvec3 du = size * side, dv = size * random.between(0.3, 1) * glm::cross(n, side);
        Planar p{};
        store(p.origin, at);
        store(p.du, du);
        store(p.dv, dv);
        store(p.normal, glm::normalize(glm::cross(du, dv)));
        p.is_disk = disk ? 1 : 0;
        light.prim = static_cast<uint>(flat.planars.size());
        const double shape = disk ? pi : 4;
        light.area = p.area =
            static_cast<float>(shape * glm::length(glm::cross(vector(p.du), vector(p.dv))));
        flat.planars.push_back(p);
    }

    void add_triangle(Random &random, bool smooth, const glm::dvec3 &at, double size,
                      Light &light) {
        LightTriangle t{};
        store(t.v0, at + size * random.point());
        store(t.e1, size * random.direction());
        store(t.e2, size * random.direction());
        const glm::dvec3 across = glm::cross(vector(t.e1), vector(t.e2));
        t.smooth = smooth ? 1 : 0;
        for (auto &normal : t.normals)
            store(normal, glm::normalize(glm::normalize(across) + 0.3 * random.direction()));
        light.prim = static_cast<uint>(flat.light_triangles.size());
        light.area = static_cast<float>(glm::length(across) / 2);
        flat.light_triangles.push_back(t);
    }
};

/// Where a ray meets a light, in double.
struct LightHit {
    double t = infinity;
    glm::dvec3 normal{0.0}; ///< geometric, of unit length
    bool front = false;     ///< it is met on the side that shines
    double density = 0;     ///< of sampling this light, per solid angle
    glm::dvec2 place{0.0};  ///< on the light, even in [0, 1)^2
    [[nodiscard]] bool met() const { return t < infinity; }
};

LightHit meet_sphere(const Light &light, const glm::dvec3 &o, const glm::dvec3 &d) {
    LightHit hit;
    const glm::dvec3 to_center = vector(light.position) - o;
    const double radius = light.radius, distance2 = glm::dot(to_center, to_center);
    const double sine2 = radius * radius / distance2;
    const double cap = sine2 / (1 + std::sqrt(1 - sine2));
    const double distance = std::sqrt(distance2);
    const glm::dvec3 axis = to_center / distance;
    // 1 - cos without cancellation.
    const glm::dvec3 off = d / glm::length(d) - axis;
    const double drop = glm::dot(off, off) / 2;
    hit.density = 1 / (2 * pi * cap);
    const glm::dvec3 s = glm::normalize(
        glm::cross(axis, std::abs(axis.x) > 0.5 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0)));
    const double turn = std::atan2(glm::dot(d, glm::cross(axis, s)), glm::dot(d, s)) / (2 * pi);
    hit.place = {turn - std::floor(turn), drop / cap};
    const double along = glm::dot(to_center, d);
    const glm::dvec3 nearest = along * d - to_center;
    const double inside = radius * radius - glm::dot(nearest, nearest);
    hit.t = along - std::sqrt(std::max(inside, 0.0));
    hit.normal = glm::normalize(hit.t * d - to_center);
    hit.front = true;
    return hit;
}

/// The shape of vectors du and dv from `origin` with these coordinates, even by area.
LightHit meet_plane(const glm::dvec3 &origin, const glm::dvec3 &du, const glm::dvec3 &dv,
                    double area, const glm::dvec3 &o, const glm::dvec3 &d) {
    LightHit hit;
    const glm::dvec3 across = glm::cross(du, dv);
    hit.normal = glm::normalize(across);
    const double cosine = glm::dot(hit.normal, d);
    hit.t = glm::dot(origin - o, hit.normal) / cosine;
    const glm::dvec3 at = o + hit.t * d - origin;
    hit.place = {glm::dot(glm::cross(dv, across), at) / glm::dot(across, across),
                 glm::dot(glm::cross(across, du), at) / glm::dot(across, across)};
    hit.front = cosine < 0;
    hit.density = hit.t * hit.t * glm::dot(d, d) / (area * std::abs(cosine));
    return hit;
}

/// Where the line meets light i, even if only with its plane, or its cone's continuation.
LightHit meet(const Lights &lights, std::size_t i, const glm::dvec3 &o, const glm::dvec3 &d) {
    const Light &light = lights.flat.lights[i];
    switch (lights.kind[i]) {
    case Kind::point:
        return {};
    case Kind::sphere:
        return meet_sphere(light, o, d);
    case Kind::rectangle:
    case Kind::disk: {
        const Planar &p = lights.flat.planars[light.prim];
        LightHit hit = meet_plane(vector(p.origin), vector(p.du), vector(p.dv), p.area, o, d);
        if (lights.kind[i] == Kind::rectangle) {
            hit.place = (hit.place + 1.0) / 2.0;
        } else {
            const double turn = std::atan2(hit.place.y, hit.place.x) / (2 * pi);
            hit.place = {glm::dot(hit.place, hit.place), turn - std::floor(turn)};
        }
        return hit;
    }
    case Kind::triangle:
    case Kind::smooth_triangle:
        break;
    }
    const LightTriangle &t = lights.flat.light_triangles[light.prim];
    LightHit hit = meet_plane(vector(t.v0), vector(t.e1), vector(t.e2), light.area, o, d);
    const double b1 = hit.place.x, b2 = hit.place.y;
    if (t.smooth != 0)
        hit.front = glm::dot((1 - b1 - b2) * vector(t.normals[0]) + b1 * vector(t.normals[1]) +
                                 b2 * vector(t.normals[2]),
                             d) < 0;
    // Even by area: (b1 + b2)^2, and the share of b2 in it.
    hit.place = {(b1 + b2) * (b1 + b2), b2 / (b1 + b2)};
    return hit;
}

/// Whether a place is on the light, give or take rounding; then it is brought into [0, 1)^2.
bool is_on_light(glm::dvec2 &place) {
    constexpr double slack = 2e-3, end = 1 - 1e-9;
    if (!(place.x > -slack && place.x < 1 + slack && place.y > -slack && place.y < 1 + slack))
        return false;
    place = glm::clamp(place, glm::dvec2(0), glm::dvec2(end));
    return true;
}

/// What is found of the samples of one kind of light.
struct SampleErrors {
    Worst off, density, radiance;
    WrongShare side;
    double deviation = 0;
};

/// Samples of a light from one point, in double beside the device's.
void check_samples(const Lights &lights, const std::vector<float> &in,
                   const std::vector<float> &out, std::size_t light, SampleErrors &errors) {
    const Light &source = lights.flat.lights[light];
    std::vector<glm::dvec2> places;
    for (std::size_t i = 0; i < in.size() / 6; ++i) {
        const float *s = &out[10 * i];
        const glm::dvec3 p = vector(&in[6 * i]), d = vector(s);
        const bool valid = s[8] > 0.5f;
        if (lights.kind[light] == Kind::point) {
            const glm::dvec3 way = vector(source.position) - p;
            errors.off.see(glm::length(d - glm::normalize(way)));
            errors.radiance.see(
                std::abs(double{s[4]} * glm::dot(way, way) / source.radiance[0] - 1));
            errors.side.see(!valid || s[9] < 0.5f);
            errors.density.see(std::abs(s[7] - 1));
            continue;
        }
        LightHit hit = meet(lights, light, p, d);
        errors.radiance.see(std::abs(double{s[4]} / source.radiance[0] - 1));
        // Rays end a little before planars and triangles, and at spheres.
        errors.off.see(std::abs(s[3] / hit.t - 1) / (1 + std::abs(1 / glm::dot(hit.normal, d))));
        errors.off.see(is_on_light(hit.place) ? 0 : 1);
        places.push_back(hit.place);
        const double cosine = std::abs(glm::dot(hit.normal, d));
        if (cosine > 1e-3) {
            errors.side.see(valid != hit.front);
            errors.density.see(std::abs(s[7] * hit.density - 1) *
                               (lights.kind[light] == Kind::sphere ? 1 : cosine));
        }
    }
    if (!places.empty())
        errors.deviation = std::max(errors.deviation, deviation_from_even(places, 12));
}

void check_local(ProbeDevice &device, Kind kind, Checks &checks) {
    Random random(41 + static_cast<std::uint32_t>(kind));
    SampleErrors errors;
    constexpr int sets = 24;
    for (int set = 0; set < sets; ++set) {
        Lights lights;
        const double size = std::exp2(random.between(-4, 1));
        lights.add(random, kind, rounded(random.point()), size);
        lights.flat.light_nodes.resize(1);
        // From a little outside to far away.
        const glm::dvec3 p = rounded(vector(lights.flat.lights.front().position) +
                                     size * std::exp2(random.between(0.3, 6)) * random.direction());
        std::vector<float> in;
        const std::size_t count = device.count(2e4);
        for (std::size_t i = 0; i < count; ++i) {
            for (int c = 0; c < 3; ++c)
                in.push_back(static_cast<float>(p[c]));
            in.insert(in.end(), {0.0f, random.unit(), random.unit()});
        }
        check_samples(lights, in, device.run_scene("probe_light_local", lights.flat, in, 6, 10), 0,
                      errors);
    }
    const std::string of = std::string(", ") + name_of(kind);
    const std::string function = "light_sample_local";
    checks.push_back({function, "relative error of the way" + of, errors.off.value(), 1.2e-5});
    checks.push_back(
        {function, "relative error of the density" + of, errors.density.value(), 1e-5});
    checks.push_back(
        {function, "relative error of the radiance" + of, errors.radiance.value(), 1e-6});
    checks.push_back({function, "share on the wrong side" + of, errors.side.value(), 0});
    if (kind != Kind::point)
        checks.push_back({function, fmt::format("chi-square, {} lights{}, deviations", sets, of),
                          errors.deviation, 4});
}

/// The density that a path finds which meets a light by chance, against that of the sample.
void check_chance(ProbeDevice &device, Checks &checks) {
    Worst density, radiance;
    WrongShare lost;
    for (int set = 0; set < 20; ++set) {
        Random random(60 + static_cast<std::uint32_t>(set));
        Lights lights;
        // Far apart, so that a direction tells the light.
        for (std::size_t i = 0; i < kinds.size(); ++i) {
            const double angle = 2 * pi * static_cast<double>(i) / kinds.size();
            lights.add(random, kinds[i],
                       rounded({3 * std::cos(angle), 3 * std::sin(angle), random.between(-1, 1)}),
                       0.3);
        }
        lights.plant_tree();
        std::vector<float> in;
        const std::size_t count = device.count(2e4);
        for (std::size_t i = 0; i < count; ++i) {
            const glm::dvec3 p = rounded(0.3 * random.point()), n = random.direction();
            for (const glm::dvec3 &v : {p, n})
                for (int c = 0; c < 3; ++c)
                    in.push_back(static_cast<float>(v[c]));
            in.insert(in.end(), {random.unit(), random.unit(), random.unit()});
        }
        const std::vector<float> out =
            device.run_scene("probe_light_sample", lights.flat, in, 9, 10);
        std::vector<float> met;
        std::vector<std::size_t> sample_of, light_of;
        for (std::size_t i = 0; i < count; ++i) {
            const float *s = &out[10 * i];
            if (s[8] < 0.5f || s[9] > 0.5f)
                continue;
            const glm::dvec3 p = vector(&in[9 * i]), d = vector(s);
            std::size_t light = kinds.size();
            LightHit hit;
            for (std::size_t k = 0; k < kinds.size(); ++k) {
                LightHit candidate = meet(lights, k, p, d);
                if (candidate.met() && candidate.t > 0 && is_on_light(candidate.place)) {
                    light = k;
                    hit = candidate;
                }
            }
            lost.see(light == kinds.size());
            if (light == kinds.size() || std::abs(glm::dot(hit.normal, d)) < 1e-2)
                continue;
            met.insert(met.end(), &in[9 * i], &in[9 * i] + 6);
            met.insert(met.end(), s, s + 3);
            met.push_back(static_cast<float>(light));
            met.push_back(0);
            for (int c = 0; c < 3; ++c)
                met.push_back(static_cast<float>(hit.normal[c]));
            met.push_back(static_cast<float>(hit.t));
            sample_of.push_back(i);
            light_of.push_back(light);
        }
        if (met.empty())
            continue;
        const std::vector<float> found =
            device.run_scene("probe_light_eval", lights.flat, met, 15, 4);
        for (std::size_t k = 0; k < sample_of.size(); ++k) {
            density.see(
                std::abs(double{found[4 * k + 3]} * double{out[10 * sample_of[k] + 7]} - 1));
            radiance.see(std::abs(
                double{found[4 * k]} / double{lights.flat.emitters[light_of[k]].radiance[0]} - 1));
        }
    }
    checks.push_back({"light_sample", "share of samples that meet no light", lost.value(), 0});
    checks.push_back({"light_of_surface", "density against that of the sample, relative",
                      density.value(), 1e-4});
    checks.push_back({"light_of_surface", "radiance, relative", radiance.value(), 1e-6});
}

} // namespace

Checks check_lights(ProbeDevice &device) {
    Checks checks;
    for (const Kind kind : kinds)
        check_local(device, kind, checks);
    check_chance(device, checks);
    return checks;
}

} // namespace clrender::selftest
