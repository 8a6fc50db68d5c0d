#include "surface.h"

namespace {

/// Two unit vectors that with the unit vector n make a right-handed frame.
void frame(Vec3 n, Vec3 &s, Vec3 &t) {
    s = normalize(cross(std::fabs(n.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}, n));
    t = cross(n, s);
}

Vec3 displaced_normal(const Surface &surface, Vec3 d, double step) {
    Vec3 s, t;
    frame(d, s, t);
    const auto at = [&](Vec3 offset) { return surface.displaced(normalize(d + offset * step)); };
    return cross(at(s) - at(s * -1), at(t) - at(t * -1));
}

Vec3 parametric_normal(const Surface &surface, double u, double v, double step) {
    const auto &p = surface.point;
    return cross(p(u + step, v) - p(u - step, v), p(u, v + step) - p(u, v - step));
}

/// At the end of a revolved surface du vanishes: average around a small circle.
Vec3 pole_normal(const Surface &surface, double v, double step) {
    const double inside = v < 0.5 ? 2 * step : 1 - 2 * step;
    Vec3 sum;
    for (int i = 0; i < 8; ++i)
        sum = sum + normalize(parametric_normal(surface, i / 8.0, inside, step));
    return sum;
}

} // namespace

Vec3 octahedral_direction(double u, double v) {
    const double x = 2 * u - 1, y = 2 * v - 1;
    const double ax = std::fabs(x), ay = std::fabs(y);
    const double signed_distance = 1 - ax - ay;
    const double r = 1 - std::fabs(signed_distance);
    const double phi = r <= 0 ? 0 : ((ay - ax) / r + 1) * pi / 4;
    const double radius = r * std::sqrt(2 - r * r);
    return {std::copysign(std::cos(phi), x) * radius, std::copysign(1 - r * r, signed_distance),
            -std::copysign(std::sin(phi), y) * radius};
}

Vec3 surface_point(const Surface &surface, double u, double v) {
    return surface.topology == Topology::octahedral ? surface.displaced(octahedral_direction(u, v))
                                                    : surface.point(u, v);
}

Vec3 surface_normal(const Surface &surface, double u, double v, double step, double outward) {
    if (surface.topology == Topology::octahedral)
        return normalize(displaced_normal(surface, octahedral_direction(u, v), 2 * step));
    if (surface.topology == Topology::revolved && (v <= 0 || v >= 1))
        return normalize(pole_normal(surface, v, step)) * outward;
    return normalize(parametric_normal(surface, u, v, step)) * outward;
}

double outward_sign(const Surface &surface) {
    constexpr int n = 96;
    double volume = 0;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const auto corner = [&](int di, int dj) {
                return surface_point(surface, (i + di) / double(n), (j + dj) / double(n));
            };
            const Vec3 a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
            volume += dot(a, cross(b, c)) + dot(a, cross(c, d));
        }
    return volume > 0 ? 1 : -1;
}
