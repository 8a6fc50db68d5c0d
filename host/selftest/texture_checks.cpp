#include "checks.h"

#include "image/image.h"

#include <array>
#include <cmath>
#include <fmt/core.h>
#include <numbers>

namespace clrender::selftest {

namespace {

constexpr double pi = std::numbers::pi;

/// One texture in the scene's arrays, 8 bits a channel or float, of random texels.
struct Textures {
    FlatScene flat;
    Random random{21};

    Textures() {
        for (int i = 0; i < 256; ++i)
            flat.decode.push_back(static_cast<float>(i / 255.0));
        for (int i = 0; i < 256; ++i)
            flat.decode.push_back(static_cast<float>(srgb_decode(i / 255.0)));
        // No number of the arrays is 0: an offset that is left out shows.
        flat.texels_u8 = {random.bits(), random.bits()};
        flat.texels_f32 = {9, 9, 9, 9, 9, 9};
    }

    void add(uint kind, uint wrap, bool nearest, uint width, uint height) {
        TextureInfo t{};
        t.to_uv[0] = t.to_uv[4] = 1;
        t.kind = kind;
        t.wrap = wrap;
        t.wrap_v = (wrap + static_cast<uint>(flat.textures.size())) % 3;
        t.product = t.coordinates = CLR_NONE;
        t.nearest = nearest ? 1 : 0;
        t.width = width;
        t.height = height;
        t.decode = random.bits() % 2;
        for (int c = 0; c < 3; ++c) {
            t.color0[c] = random.unit();
            t.color1[c] = random.unit();
        }
        const std::size_t texels = std::size_t{width} * height;
        if (kind == CLR_TEXTURE_BITMAP_U8) {
            t.offset = static_cast<uint>(flat.texels_u8.size());
            for (std::size_t i = 0; i < texels; ++i)
                flat.texels_u8.push_back(random.bits());
        } else if (kind == CLR_TEXTURE_BITMAP_F32) {
            t.offset = static_cast<uint>(flat.texels_f32.size() / 3);
            for (std::size_t i = 0; i < 3 * texels; ++i)
                flat.texels_f32.push_back(random.unit());
        }
        flat.textures.push_back(t);
    }
};

/// A texel's index by the wrap mode, however far outside.
std::int64_t wrapped(double index, std::int64_t n, uint wrap) {
    if (wrap == CLR_WRAP_CLAMP)
        return static_cast<std::int64_t>(std::clamp(index, 0.0, static_cast<double>(n - 1)));
    const auto period = static_cast<double>(wrap == CLR_WRAP_MIRROR ? 2 * n : n);
    const auto m = static_cast<std::int64_t>(index - std::floor(index / period) * period);
    return m < n ? m : 2 * n - 1 - m;
}

glm::dvec3 texel(const FlatScene &flat, const TextureInfo &t, double column, double row) {
    const std::int64_t x = wrapped(column, t.width, t.wrap), y = wrapped(row, t.height, t.wrap_v);
    const auto at = static_cast<std::size_t>(t.offset + y * t.width + x);
    glm::dvec3 colour;
    for (int c = 0; c < 3; ++c)
        colour[c] = t.kind == CLR_TEXTURE_BITMAP_U8
                        ? flat.decode[256 * t.decode + (flat.texels_u8[at] >> (8 * c) & 255u)]
                        : flat.texels_f32[3 * at + static_cast<std::size_t>(c)];
    return colour;
}

/// The texture at (u, v) in double.
glm::dvec3 lookup(const FlatScene &flat, const TextureInfo &t, double u, double v) {
    if (t.kind == CLR_TEXTURE_CHECKERBOARD) {
        const bool same = (u - std::floor(u) > 0.5) == (v - std::floor(v) > 0.5);
        const float(&c)[3] = same ? t.color0 : t.color1;
        return {c[0], c[1], c[2]};
    }
    const glm::dvec3 factor(t.color0[0], t.color0[1], t.color0[2]);
    double x = u * t.width, y = v * t.height;
    if (t.nearest != 0)
        return factor * texel(flat, t, std::floor(x), std::floor(y));
    x -= 0.5;
    y -= 0.5;
    const double left = std::floor(x), top = std::floor(y);
    return factor *
           glm::mix(
               glm::mix(texel(flat, t, left, top), texel(flat, t, left + 1, top), x - left),
               glm::mix(texel(flat, t, left, top + 1), texel(flat, t, left + 1, top + 1), x - left),
               y - top);
}

/// Whether (u, v) lies within `slack` texels of where a texture jumps.
bool is_at_jump(const TextureInfo &t, double u, double v, double slack) {
    const bool checkerboard = t.kind == CLR_TEXTURE_CHECKERBOARD;
    if (!checkerboard && t.nearest == 0)
        return false;
    const auto close = [&](double x) { return std::abs(x - std::round(x)) <= slack; };
    return checkerboard ? close(2 * u) || close(2 * v) : close(u * t.width) || close(v * t.height);
}

const char *name_of(const TextureInfo &t) {
    constexpr std::array<const char *, 3> wraps{"repeat", "mirror", "clamp"};
    return t.kind == CLR_TEXTURE_CHECKERBOARD ? "checkerboard" : wraps[t.wrap];
}

/// All textures at coordinates up to `reach`.
void check_reach(ProbeDevice &device, Textures &textures, double reach, Checks &checks) {
    const FlatScene &flat = textures.flat;
    std::vector<float> in;
    const std::size_t count = device.count(2e5);
    for (std::size_t i = 0; i < count; ++i) {
        in.push_back(static_cast<float>(textures.random.between(-reach, reach)));
        in.push_back(static_cast<float>(textures.random.between(-reach, reach)));
        in.push_back(static_cast<float>(i % flat.textures.size()));
    }
    const std::vector<float> out = device.run_scene("probe_texture", flat, in, 3, 3);
    std::map<std::string, Worst> errors;
    for (std::size_t i = 0; i < count; ++i) {
        const TextureInfo &t = flat.textures[i % flat.textures.size()];
        const double u = in[3 * i], v = in[3 * i + 1];
        // What one rounding of u times the width moves the place by, in texels. Coordinates beyond
        // 2^14 are floats brought near 0 first, which rounds nothing.
        const double moved = ulp(std::min(reach, 16384.0) * std::max(t.width, t.height));
        if (is_at_jump(t, u, v, moved))
            continue;
        const glm::dvec3 colour(out[3 * i], out[3 * i + 1], out[3 * i + 2]);
        const glm::dvec3 off = glm::abs(colour - lookup(flat, t, u, v));
        errors[name_of(t)].see(std::max({off.x, off.y, off.z}) / (4 * moved + 1e-6));
    }
    for (const auto &[name, error] : errors)
        checks.push_back(
            {"texture_apply",
             fmt::format("error over that of the coordinates, {}, |uv| <= {:g}", name, reach),
             error.value(), 1});
}

void check_sphere_uv(ProbeDevice &device, Checks &checks) {
    Random random(22);
    FlatScene flat;
    const glm::dvec3 z = glm::normalize(random.direction());
    const glm::dvec3 x = glm::normalize(glm::cross(z, random.direction()));
    const glm::dmat3 frame(x, glm::cross(z, x), z); // columns are the sphere's own axes
    flat.shape_frames.emplace_back();
    for (int axis = 0; axis < 3; ++axis)
        store(flat.shape_frames.back().axis[axis], frame[axis]);
    std::vector<float> in;
    const std::size_t count = device.count(1e5);
    for (std::size_t i = 0; i < count; ++i) {
        const glm::dvec3 d = random.direction();
        for (int c = 0; c < 3; ++c)
            in.push_back(static_cast<float>(d[c]));
    }
    const std::vector<float> out = device.run_scene("probe_sphere_uv", flat, in, 3, 2);
    Worst error;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::dvec3 d(in[3 * i], in[3 * i + 1], in[3 * i + 2]);
        const glm::dvec3 own(glm::dot(frame[0], d), glm::dot(frame[1], d), glm::dot(frame[2], d));
        const double across = std::hypot(own.x, own.y);
        const double u = std::atan2(own.y, own.x) / (2 * pi);
        error.see(std::abs(std::remainder(double{out[2 * i]} - u, 1.0)) * across);
        error.see(std::abs(double{out[2 * i + 1]} - std::atan2(across, own.z) / pi));
        error.see(out[2 * i] >= 0 && out[2 * i] <= 1 ? 0 : 1);
    }
    checks.push_back(
        {"sphere_uv", "largest error of the place on a unit sphere", error.value(), 3e-7});
}

} // namespace

Checks check_textures(ProbeDevice &device) {
    Textures textures;
    for (const uint wrap : {CLR_WRAP_REPEAT, CLR_WRAP_MIRROR, CLR_WRAP_CLAMP})
        for (const bool nearest : {false, true})
            for (const auto &[width, height] :
                 {std::pair{1u, 1u}, std::pair{2u, 3u}, std::pair{5u, 4u}, std::pair{64u, 16u}}) {
                textures.add(CLR_TEXTURE_BITMAP_U8, wrap, nearest, width, height);
                textures.add(CLR_TEXTURE_BITMAP_F32, wrap, nearest, width, height);
            }
    textures.add(CLR_TEXTURE_CHECKERBOARD, CLR_WRAP_REPEAT, false, 1, 1);
    Checks checks;
    for (const double reach : {1.0, 10.0, 30000.0, 1e6})
        check_reach(device, textures, reach, checks);
    check_sphere_uv(device, checks);
    return checks;
}

} // namespace clrender::selftest
