#include "flatten_parts.h"
#include "scene/mesh_attributes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace clrender::inline CLR_PRECISION {

namespace {

/// A point light is taken to come as near as this to a surface, in renderer's units, of which a
/// scene is about one across.
constexpr double near_point = 1.0 / 16;

/// Depths are taken to reach this far, in renderer's units.
constexpr double far_depth = 1024;

/// The film's exponents have this size at most, so that the unit and its reciprocal are floats.
constexpr int largest_exponent = 126;

double largest(const Rgb &c) {
    return std::max({std::abs(c.r), std::abs(c.g), std::abs(c.b)});
}

/// The largest value of a picture; of one with 8 bits a channel a bound.
double largest(const Image &image) {
    double size = image.type == PixelType::u8 ? 1 : 0;
    for (const float value : image.f32)
        size = std::max(size, std::abs(double{value}));
    return size;
}

/// The largest value of an attribute of the shape that shines; 0 where there is none.
double largest(const std::string &attribute, const Scene &scene, const Emitter &emitter) {
    if (emitter.shape == none)
        return 0;
    const Mesh &mesh = *scene.shapes[static_cast<std::size_t>(emitter.shape)].mesh;
    const MeshAttribute *found = find_attribute(mesh, attribute);
    return found == nullptr ? 0 : largest_value(*found);
}

double largest(const Texture &texture, const Scene &scene, const Emitter &emitter) {
    const double factor = largest(texture.scale) *
                          (texture.product.empty() ? 1 : largest(texture.product, scene, emitter));
    switch (texture.kind) {
    case TextureKind::constant:
        return largest(texture.value);
    case TextureKind::checkerboard:
        return std::max(largest(texture.color0), largest(texture.color1));
    case TextureKind::bitmap:
        return largest(*texture.bitmap) * factor;
    case TextureKind::attribute:
        return largest(texture.attribute, scene, emitter) * factor;
    }
    return 0;
}

/// The largest radiance that an emitter gives a surface or the camera.
double largest_radiance(const Scene &scene, const Emitter &emitter, double unit) {
    const double texture =
        emitter.radiance == none
            ? 1
            : largest(scene.textures[static_cast<std::size_t>(emitter.radiance)], scene, emitter);
    const double of_place = unit * unit / (near_point * near_point);
    switch (emitter.kind) {
    case EmitterKind::point:
    case EmitterKind::spot:
        return largest(emitter.intensity) * texture * of_place;
    case EmitterKind::projector:
        return std::numbers::pi * emitter.scale * texture * of_place;
    case EmitterKind::directional:
        return largest(emitter.intensity);
    case EmitterKind::area:
    case EmitterKind::constant:
        return texture;
    case EmitterKind::envmap:
        return largest(*emitter.bitmap) * std::abs(emitter.scale);
    case EmitterKind::sunsky:
        return largest_sky_radiance(emitter.sunsky) + largest(emitter.sunsky.sun_radiance);
    }
    return 0;
}

} // namespace

int film_exponent(const Scene &scene, const Placement &placement) {
    double size = 0;
    if (scene.integrator.kind == IntegratorKind::depth)
        size = far_depth / placement.scale;
    else
        for (const Emitter &emitter : scene.emitters)
            size = std::max(size, largest_radiance(scene, emitter, placement.scale));
    if (!(size > 0) || !std::isfinite(size))
        return 0;
    return std::clamp(std::ilogb(size) + 1, -largest_exponent, largest_exponent);
}

} // namespace clrender::inline CLR_PRECISION
