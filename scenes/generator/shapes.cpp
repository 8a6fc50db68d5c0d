#include "shapes.h"
#include "noise.h"
#include "profile.h"
#include <algorithm>
#include <map>
#include <memory>
#include <stdexcept>

namespace {

struct Detail {
    int octaves; ///< of noise whose first wavelength is 1
    uint32_t seed;
};

/// A point of a tube around `centre`: `ring` turned by `angle` in the plane of n and t x n.
Vec3 tube_point(Vec3 centre, Vec3 tangent, Vec3 side, double radius, double angle) {
    const Vec3 t = normalize(tangent);
    const Vec3 n = normalize(side - t * dot(side, t));
    const Vec3 b = cross(t, n);
    return centre + (n * std::cos(angle) + b * std::sin(angle)) * radius;
}

/// White marble with grey and golden veins along the zeros of a warped noise.
Vec3 marble(Vec3 p, uint32_t seed) {
    const double warp = fractal_noise(p * 1.3, 4, seed);
    const double vein = std::fabs(fractal_noise(p * 1.1 + Vec3{warp, -warp, warp}, 3, seed + 9));
    const double gold = std::fabs(fractal_noise(p * 0.8 + Vec3{3, warp, 1}, 3, seed + 21));
    Vec3 c = mix({0.93, 0.92, 0.9}, {0.83, 0.83, 0.84}, smoothstep(-0.4, 0.6, warp));
    c = mix({0.32, 0.34, 0.38}, c, smoothstep(0, 0.09, vein));
    return mix({0.72, 0.52, 0.22}, c, smoothstep(0.005, 0.025, gold));
}

/// A trefoil knot of twisted rope with three strands.
Surface knot(Detail detail) {
    Surface s;
    s.topology = Topology::torus;
    s.aspect = 8;
    s.point = [](double u, double v) {
        const double t = 2 * pi * u, a = 2 * pi * v;
        const double ring = 2 + std::cos(3 * t);
        const Vec3 centre = {ring * std::cos(2 * t), ring * std::sin(2 * t),
                             1.15 * std::sin(3 * t)};
        const double dring = -3 * std::sin(3 * t);
        const Vec3 tangent = {dring * std::cos(2 * t) - 2 * ring * std::sin(2 * t),
                              dring * std::sin(2 * t) + 2 * ring * std::cos(2 * t),
                              3.45 * std::cos(3 * t)};
        const Vec3 side = {std::cos(3 * t) * std::cos(2 * t), std::cos(3 * t) * std::sin(2 * t),
                           std::sin(3 * t)};
        const double radius = 0.56 * (1 + 0.15 * std::cos(3 * a));
        const Vec3 p = tube_point(centre, tangent, side, radius, a + 6 * t);
        return p * 0.32 + Vec3{0, 1.02, 0};
    };
    s.colour = [detail](Vec3 p, double, double) { return marble(p * 1.6, detail.seed); };
    return s;
}

/// An endless ribbon: a ring of soft rectangular section that turns once on its way around.
Surface ribbon(Detail detail) {
    Surface s;
    s.topology = Topology::torus;
    s.aspect = 3.2;
    s.point = [](double u, double v) {
        const double t = 2 * pi * u, a = 2 * pi * v;
        const Vec3 side = {std::cos(t), std::sin(t), 0};
        const Vec3 tangent = {-std::sin(t), std::cos(t), 0};
        const double width = 0.40, thickness = 0.14;
        const double c = std::cos(a), q = std::sin(a);
        const double radius = std::pow(std::pow(c / width, 4) + std::pow(q / thickness, 4), -0.25);
        const Vec3 p = tube_point(side * 0.72, tangent, side, radius, a + t);
        return p + Vec3{0, 1.04, 0};
    };
    s.colour = [detail](Vec3 p, double u, double) {
        const double band = std::sin(2 * pi * 24 * u + 1.5 * gradient_noise(p * 3, detail.seed));
        return mix({0.16, 0.2, 0.28}, {0.9, 0.84, 0.7}, smoothstep(-0.25, 0.25, band));
    };
    return s;
}

/// How far the colour is from the flute's crest, in the vase's turning coordinate.
double vase_flute(double angle, double height) {
    return 14 * (angle + 0.9 * height);
}

/// A thin-walled vase with turning flutes: cobalt glaze that runs off the crests.
Surface vase(Detail detail) {
    const auto profile = std::make_shared<Profile>(vase_profile());
    Surface s;
    s.topology = Topology::revolved;
    s.aspect = 0.55;
    s.point = [profile](double u, double v) {
        const Profile::Point p = profile->at(v);
        const double angle = 2 * pi * u;
        const double depth = smoothstep(0.04, 0.35, p.y) * (1 - 0.75 * smoothstep(1.3, 1.9, p.y));
        const double r = p.r * (1 + 0.065 * depth * std::cos(vase_flute(angle, p.y)));
        return Vec3{r * std::cos(angle), p.y, r * std::sin(angle)};
    };
    s.colour = [detail](Vec3 p, double u, double) {
        const double crest = std::cos(vase_flute(2 * pi * u, p.y));
        const double run = 0.5 * fractal_noise(p * 2.5, 4, detail.seed);
        const double edge = crest + run + 1.5 * (p.y - 1.35);
        const Vec3 cobalt = mix({0.03, 0.1, 0.32}, {0.1, 0.32, 0.6}, 0.5 + 0.5 * run);
        const Vec3 cream = mix({0.93, 0.89, 0.8}, {0.85, 0.78, 0.64}, smoothstep(-0.3, 0.5, run));
        const Vec3 c =
            mix(cobalt, cream, smoothstep(-0.9, -0.45, edge) * (1 - smoothstep(0, 0.5, edge)));
        return mix({0.62, 0.38, 0.24}, c, smoothstep(0.05, 0.09, p.y + 0.03 * run));
    };
    return s;
}

/// A head of brain coral: winding ridges on an uneven ball, rough down to the finest triangle.
Surface coral(Detail detail) {
    const auto ridges = std::make_shared<WaveField>(0.42, 48, detail.seed + 5);
    Surface s;
    s.topology = Topology::octahedral;
    s.displaced = [=](Vec3 d) {
        const double swell = 0.16 * gradient_noise(d * 1.1, detail.seed + 40);
        const double ridge = 0.085 * std::tanh(1.5 * (*ridges)(d));
        const double rough = 0.03 * fractal_noise(d * 4, detail.octaves - 2, detail.seed + 60);
        const Vec3 p = d * (1 + swell + ridge + rough);
        return Vec3{p.x, 0.86 * p.y + 0.8, p.z};
    };
    s.colour = [=](Vec3 p, double, double) {
        const Vec3 d = normalize({p.x, (p.y - 0.8) / 0.86, p.z});
        const double ridge = std::tanh(1.5 * (*ridges)(d));
        const double tint = gradient_noise(d * 2, detail.seed + 3);
        const Vec3 crest = mix({0.95, 0.55, 0.36}, {0.97, 0.72, 0.5}, 0.5 + 0.5 * tint);
        return mix({0.42, 0.1, 0.13}, crest, smoothstep(-0.8, 0.7, ridge));
    };
    return s;
}

/// A spiral of ever larger whorls with ribs, as of an ammonite, its mouth hollow.
Vec3 ammonite_point(double u, double v) {
    constexpr double turns = 3.3, expansion = 2.15, tip = 0.04, mouth = 0.9;
    const double along = std::min(1.0, std::max(0.0, v) / mouth);
    const double inward = std::max(0.0, (v - mouth) / (1 - mouth));
    const double theta = 2 * pi * turns * (along - 1);
    const double growth = std::log(expansion) / (2 * pi);
    const double spiral = std::exp(growth * theta);
    const Vec3 out = {std::cos(theta), std::sin(theta), 0};
    const Vec3 tangent = normalize(out * growth + Vec3{-out.y, out.x, 0});
    const double close = std::sqrt(std::max(0.0, 1 - std::pow(1 - std::min(1.0, v / tip), 2)));
    const double rib = 0.05 * std::cos(14 * theta) * (1 - smoothstep(0.98, 1, along));
    const double tube = 0.36 * spiral * (1 + rib) * close * (1 - inward * inward);
    const double angle = 2 * pi * u;
    const Vec3 centre = out * spiral + tangent * (-0.45 * inward * inward * spiral);
    return tube_point(centre, tangent, out, tube, angle) + Vec3{0.12, 1.13, 0};
}

Surface ammonite(Detail detail) {
    Surface s;
    s.topology = Topology::revolved;
    s.aspect = 0.2;
    s.point = ammonite_point;
    s.colour = [detail](Vec3 p, double u, double v) {
        const double warp = 0.6 * fractal_noise(p * 3, 3, detail.seed);
        const double band = std::sin(2 * pi * (16 * v + 0.35 * std::cos(2 * pi * u)) + warp);
        const Vec3 dark = mix({0.36, 0.17, 0.08}, {0.52, 0.25, 0.12}, 0.5 + 0.5 * warp);
        const Vec3 light = mix({0.95, 0.88, 0.74}, {0.88, 0.7, 0.5}, 0.5 + 0.5 * warp);
        return mix(dark, light, smoothstep(-0.55, 0.1, band));
    };
    return s;
}

struct Lobe {
    Vec3 axis;
    double height, sharpness;
};

/// A smooth resting creature: a ball drawn out along a few directions.
Surface creature(Detail detail) {
    static const Lobe lobes[] = {{{0.55, 1, 0}, 0.85, 9},    {{-1, 0.3, 0}, 0.8, 8},
                                 {{0.9, -0.1, 0}, 0.25, 4},  {{0.25, -1, 0.5}, 0.3, 6},
                                 {{0.25, -1, -0.5}, 0.3, 6}, {{-0.4, -1, 0}, 0.25, 6},
                                 {{-0.2, 0.25, 1}, 0.3, 7},  {{-0.2, 0.25, -1}, 0.3, 7}};
    Surface s;
    s.topology = Topology::octahedral;
    s.displaced = [](Vec3 d) {
        double r = 0.5;
        for (const Lobe &lobe : lobes)
            r += lobe.height * std::exp(lobe.sharpness * (dot(d, normalize(lobe.axis)) - 1));
        // A soft floor under it gives it a foot to stand on.
        const double foot = -0.72, softness = 0.05, y = d.y * r;
        const double above = std::log1p(std::exp(-std::fabs(y - foot) / softness)) * softness;
        return Vec3{d.x * r, std::max(y, foot) + above - foot, d.z * r};
    };
    s.colour = [detail](Vec3 p, double, double) {
        // Celadon glaze, thicker and greener below, with a net of fine cracks.
        const double flow = fractal_noise(p * 1.5, 4, detail.seed);
        const Vec3 q = p + Vec3{0.15, 0.1, 0.2} * gradient_noise(p * 2.5, detail.seed + 7);
        const CellDistances cell = cell_noise(q * 3.6, detail.seed + 4);
        const double crack = smoothstep(0.012, 0.035, cell.second - cell.nearest);
        const double depth = 1 - smoothstep(0.1, 1.9, p.y + 0.35 * flow);
        const Vec3 glaze = mix({0.72, 0.83, 0.74}, {0.27, 0.53, 0.48}, depth);
        return mix({0.25, 0.2, 0.13}, glaze, 0.25 + 0.75 * crack);
    };
    return s;
}

using Maker = Surface (*)(Detail);
const std::map<std::string, Maker> &makers() {
    static const std::map<std::string, Maker> all = {{"ammonite", ammonite}, {"coral", coral},
                                                     {"creature", creature}, {"knot", knot},
                                                     {"ribbon", ribbon},     {"vase", vase}};
    return all;
}

} // namespace

std::vector<std::string> shape_names() {
    std::vector<std::string> names;
    for (const auto &[name, maker] : makers())
        names.push_back(name);
    return names;
}

Surface make_shape(const std::string &name, double triangles, uint32_t seed) {
    const auto found = makers().find(name);
    if (found == makers().end())
        throw std::invalid_argument("no shape is called '" + name + "'");
    // Four edges to the shortest wave, on a surface of about a dozen square units.
    const double edge = std::sqrt(24 / triangles);
    const int octaves = std::clamp(static_cast<int>(std::log2(1 / (4 * edge))) + 1, 2, 10);
    return found->second({octaves, seed});
}
