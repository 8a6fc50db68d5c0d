#include "images.h"
#include "noise.h"
#include <algorithm>
#include <memory>
#include <stdexcept>
#include <vector>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image.h>
#include <stb/stb_image_write.h>

namespace {

void check(int written, const std::string &path) {
    if (!written)
        throw std::runtime_error("cannot write " + path);
}

/// Rounded to one of 64 levels: enough under a diffuse light, and half the file.
unsigned char to_byte(double value) {
    const double level = std::round(std::clamp(value, 0.0, 1.0) * 63);
    return static_cast<unsigned char>(level * 255 / 63 + 0.5);
}

/// Radiance of the sky in direction d.
Vec3 sky_radiance(Vec3 d) {
    const double height = std::max(0.0, d.y);
    const Vec3 sun = normalize({-0.55, 0.42, 0.6});
    const double to_sun = std::acos(std::clamp(dot(d, sun), -1.0, 1.0));

    const Vec3 zenith = {0.10, 0.22, 0.52}, middle = {0.38, 0.56, 0.85},
               horizon = {1.15, 0.82, 0.55};
    Vec3 sky = mix(middle, zenith, smoothstep(0.05, 0.8, height));
    sky = mix(sky, horizon, std::exp(-height * 7));
    sky = sky + Vec3{1.3, 0.75, 0.35} * (1.1 * std::exp(-to_sun * 3.2));

    // Thin clouds on a plane overhead, lit from the sun's side.
    const Vec3 on_plane = Vec3{d.x, 0, d.z} * (1 / (height + 0.12));
    const double cloud = fractal_noise({on_plane.x * 0.7, 3, on_plane.z * 1.6}, 6, 11);
    const double cover = smoothstep(0.05, 0.75, cloud) * smoothstep(0.02, 0.25, height);
    sky = mix(sky, Vec3{1.25, 1.1, 1.0} * (0.75 + 0.7 * std::exp(-to_sun * 1.5)), 0.65 * cover);

    const double disc = 1 - smoothstep(0.06, 0.14, to_sun);
    sky = sky + Vec3{1, 0.80, 0.55} * (75 * disc);
    const Vec3 ground = {0.16, 0.14, 0.12};
    return mix(ground, sky, smoothstep(-0.015, 0.01, d.y));
}

} // namespace

void write_texture(const Surface &surface, int width, int height, const std::string &path) {
    std::vector<unsigned char> pixels;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double u = (x + 0.5) / width, v = 1 - (y + 0.5) / height;
            const Vec3 c = surface.colour(surface_point(surface, u, v), u, v);
            pixels.insert(pixels.end(), {to_byte(c.x), to_byte(c.y), to_byte(c.z)});
        }
    stbi_write_png_compression_level = 32;
    check(stbi_write_png(path.c_str(), width, height, 3, pixels.data(), width * 3), path);
}

void write_sky(int width, int height, const std::string &path) {
    std::vector<float> pixels;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double theta = (y + 0.5) / height * pi, phi = (x + 0.5) / width * 2 * pi;
            const Vec3 d = {std::sin(phi) * std::sin(theta), std::cos(theta),
                            -std::cos(phi) * std::sin(theta)};
            const Vec3 c = sky_radiance(d);
            for (const double value : {c.x, c.y, c.z})
                pixels.push_back(static_cast<float>(value));
        }
    check(stbi_write_hdr(path.c_str(), width, height, 3, pixels.data()), path);
}

void enlarge(const std::string &input, int factor, const std::string &output) {
    int width = 0, height = 0, channels = 0;
    const std::unique_ptr<unsigned char, void (*)(void *)> image(
        stbi_load(input.c_str(), &width, &height, &channels, 3), stbi_image_free);
    if (!image)
        throw std::runtime_error("cannot read " + input);
    std::vector<unsigned char> pixels;
    for (int y = 0; y < height * factor; ++y)
        for (int x = 0; x < width * factor; ++x) {
            const unsigned char *p = image.get() + 3 * (y / factor * width + x / factor);
            pixels.insert(pixels.end(), p, p + 3);
        }
    check(stbi_write_png(output.c_str(), width * factor, height * factor, 3, pixels.data(),
                         width * factor * 3),
          output);
}
