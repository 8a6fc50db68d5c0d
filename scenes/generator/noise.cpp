#include "noise.h"
#include <algorithm>

namespace {

uint32_t hash(uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ (x >> 16);
}

uint32_t hash_cell(int x, int y, int z, uint32_t seed) {
    const uint32_t h = hash(seed + static_cast<uint32_t>(x));
    return hash(hash(h + static_cast<uint32_t>(y)) + static_cast<uint32_t>(z));
}

double unit(uint32_t h) {
    return h * 0x1p-32;
}

Vec3 unit_vector(uint32_t h) {
    const double z = 1 - 2 * unit(h);
    const double phi = 2 * pi * unit(hash(h));
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    return {r * std::cos(phi), r * std::sin(phi), z};
}

double fade(double t) {
    return t * t * t * (t * (t * 6 - 15) + 10);
}
double lerp(double a, double b, double t) {
    return a + (b - a) * t;
}

} // namespace

double gradient_noise(Vec3 p, uint32_t seed) {
    const double fx = std::floor(p.x), fy = std::floor(p.y), fz = std::floor(p.z);
    const int x = static_cast<int>(fx), y = static_cast<int>(fy), z = static_cast<int>(fz);
    const Vec3 f = {p.x - fx, p.y - fy, p.z - fz};
    const auto corner = [&](int i, int j, int k) {
        const Vec3 gradient = unit_vector(hash_cell(x + i, y + j, z + k, seed));
        return dot(gradient, {f.x - i, f.y - j, f.z - k});
    };
    const double u = fade(f.x), v = fade(f.y), w = fade(f.z);
    const auto edge = [&](int j, int k) { return lerp(corner(0, j, k), corner(1, j, k), u); };
    return 1.5 * lerp(lerp(edge(0, 0), edge(1, 0), v), lerp(edge(0, 1), edge(1, 1), v), w);
}

double fractal_noise(Vec3 p, int octaves, uint32_t seed) {
    double sum = 0, weight = 1;
    for (int i = 0; i < octaves; ++i) {
        sum += weight * gradient_noise(p, seed + static_cast<uint32_t>(i));
        p = p * 2;
        weight /= 2;
    }
    return sum;
}

CellDistances cell_noise(Vec3 p, uint32_t seed) {
    const int x = static_cast<int>(std::floor(p.x)), y = static_cast<int>(std::floor(p.y)),
              z = static_cast<int>(std::floor(p.z));
    CellDistances found{9, 9, 0};
    for (int i = 0; i < 27; ++i) {
        const int cx = x + i % 3 - 1, cy = y + i / 3 % 3 - 1, cz = z + i / 9 - 1;
        const uint32_t h = hash_cell(cx, cy, cz, seed);
        const Vec3 site = {cx + unit(h), cy + unit(hash(h)), cz + unit(hash(h ^ 0x5bd1e995u))};
        const double d = length(site - p);
        if (d < found.nearest)
            found = {d, found.nearest, h};
        else
            found.second = std::min(found.second, d);
    }
    return found;
}

WaveField::WaveField(double wavelength, int waves, uint32_t seed) {
    for (int i = 0; i < waves; ++i) {
        const uint32_t h = hash(seed * 7919u + static_cast<uint32_t>(i));
        waves_.push_back({unit_vector(h) * (2 * pi / wavelength), 2 * pi * unit(hash(h + 1))});
    }
}

double WaveField::operator()(Vec3 p) const {
    double sum = 0;
    for (const Wave &wave : waves_)
        sum += std::cos(dot(wave.k, p) + wave.phase);
    return sum * std::sqrt(2.0 / static_cast<double>(waves_.size()));
}
