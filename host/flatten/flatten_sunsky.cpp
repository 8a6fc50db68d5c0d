/// The sky and the sun of `sunsky`.

#include "light_list.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace clrender::inline CLR_PRECISION {

namespace {

constexpr double pi = std::numbers::pi;

/// The texels that light sampling chooses by: fine enough that the sky's radiance over the density
/// varies little between them.
constexpr std::size_t map_width = 256, map_rows = 128;

/// The sky's axes as those of a map: its zenith is +y.
glm::dmat3 to_map(const Emitter &emitter) {
    const glm::dmat3 axes(emitter.to_world);
    return glm::transpose(
        glm::dmat3(glm::normalize(axes[0]), glm::normalize(axes[2]), -glm::normalize(axes[1])));
}

double angle_between(const glm::dvec3 &a, const glm::dvec3 &b) {
    return 2 * std::atan2(glm::length(a - b), glm::length(a + b));
}

/// Weights of the texels of the map.
void append_weights(const SkyDistribution &sky, const glm::dvec3 &to_sun, FlatScene &flat) {
    flat.env_texels.assign(4 * (map_width + 1) * (map_rows + 1), 0);
    for (std::size_t row = 0; row <= map_rows / 2; ++row)
        for (std::size_t column = 0; column <= map_width; ++column) {
            const double theta = pi * static_cast<double>(row) / map_rows;
            const double phi = 2 * pi * (static_cast<double>(column) + 0.5) / map_width;
            const glm::dvec3 d(std::sin(phi) * std::sin(theta), std::cos(theta),
                               -std::cos(phi) * std::sin(theta));
            const Rgb radiance = sky.at(std::max(d.y, 0.0), angle_between(d, to_sun));
            flat.env_texels[4 * (row * (map_width + 1) + column) + 3] =
                static_cast<clr_real>(std::max(luminance(radiance), 0.0));
        }
}

void add_sun(const SunSky &sunsky, SkyModel &model, LightList &list) {
    const double chord = 2 * std::sin(sunsky.half_aperture / 2);
    model.chord2 = static_cast<clr_real>(chord * chord);
    model.cap = static_cast<clr_real>(chord * chord / 2);
    model.light = list.size();
    store(model.sun_radiance, sunsky.sun_radiance);
    Light light{};
    light.kind = CLR_LIGHT_SUN;
    light.texture = CLR_NONE;
    store(light.position, sunsky.sun_direction);
    store(light.radiance, sunsky.sun_radiance);
    LightExtent extent;
    extent.is_distant = true;
    extent.lower = sunsky.sun_direction - chord;
    extent.upper = sunsky.sun_direction + chord;
    extent.intensity = luminance(sunsky.sun_radiance) * pi * chord * chord;
    if (extent.intensity > 0)
        list.add(light, extent);
}

} // namespace

double largest_sky_radiance(const SunSky &sunsky) {
    double largest = 0;
    constexpr int steps = 64;
    for (int i = 0; i <= steps; ++i)
        for (int j = 0; j <= steps; ++j) {
            const Rgb value = sunsky.sky.at(double(i) / steps, pi * j / steps);
            largest = std::max({largest, std::abs(value.r), std::abs(value.g), std::abs(value.b)});
        }
    return largest;
}

void flatten_sunsky(Flattening &work, const Emitter &emitter, LightList &list, double *power) {
    FlatScene &flat = work.flat;
    FrameData &f = flat.frame;
    const SunSky &sunsky = emitter.sunsky;
    f.env_alpha = environment_alpha(work.scene.integrator);
    flat.facts.environment = CLR_ENVIRONMENT_CONSTANT; // where the sky is black
    SkyModel model{};
    const glm::dmat3 rotation = to_map(emitter);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            f.env_rotation[4 * row + column] = static_cast<clr_real>(rotation[column][row]);
    store(model.to_sun, sunsky.sun_direction);
    store(model.up, glm::normalize(glm::dvec3(emitter.to_world[2])));
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < sunsky.sky.parameters[c].size(); ++i)
            model.channels[c][i] = static_cast<clr_real>(sunsky.sky.parameters[c][i]);
        model.channels[c][9] = static_cast<clr_real>(sunsky.sky.radiance[static_cast<int>(c)]);
    }
    add_sun(sunsky, model, list);
    flat.sky.push_back(model);
    if (!(std::max({sunsky.sky.radiance.r, sunsky.sky.radiance.g, sunsky.sky.radiance.b}) > 0))
        return;
    f.env_width = map_width;
    f.env_height = map_rows + 1;
    append_weights(sunsky.sky, rotation * sunsky.sun_direction, flat);
    *power = build_map_cells(flat, flat.facts.strategy == Strategy::light);
    if (*power > 0) {
        flat.facts.environment = CLR_ENVIRONMENT_MAP;
        flat.facts.has_sky = true;
    }
}

} // namespace clrender::inline CLR_PRECISION
