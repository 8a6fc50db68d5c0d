#include "sky_model.h"

#include "spectrum.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace clrender {

namespace {

constexpr double pi = std::numbers::pi;
constexpr std::size_t turbidities = 10, albedos = 2, control_points = 6, channels = 3,
                      parameter_count = 9;
constexpr std::size_t sun_elevations = 30, wavelengths = 11;

using SkyRow = std::array<double, channels * parameter_count + channels>;
using SunRow = std::array<double, wavelengths>;

constexpr SkyRow sky_rows[turbidities * albedos * control_points] = {
#include "hosek_wilkie/sky_rgb.inc"
};
constexpr SunRow sun_rows[turbidities * sun_elevations] = {
#include "hosek_wilkie/sun_irradiance.inc"
};

/// Between entries `first` and `first + 1` of `count`, at `fraction`.
struct Between {
    std::size_t first;
    double fraction;
};

Between between(double at, std::size_t count) {
    const double held = std::clamp(at, 0.0, static_cast<double>(count - 1));
    const auto first = std::min(static_cast<std::size_t>(held), count - 2);
    return {first, held - static_cast<double>(first)};
}

/// Number `column` of the table's rows for the sun's elevation, as a Bezier curve of degree 5 over
/// its cube root.
double along_elevation(std::size_t turbidity, std::size_t albedo, std::size_t column,
                       double elevation) {
    const double x = std::min(std::cbrt(elevation / (pi / 2)), 1.0);
    constexpr std::array<double, control_points> binomial{1, 5, 10, 10, 5, 1};
    double sum = 0;
    for (std::size_t i = 0; i < control_points; ++i)
        sum += binomial.at(i) * std::pow(x, static_cast<double>(i)) *
               std::pow(1 - x, static_cast<double>(control_points - 1 - i)) *
               sky_rows[(turbidity * albedos + albedo) * control_points + i].at(column);
    return sum;
}

/// The same, bilinear between turbidities and between the albedos 0 and 1 of a channel.
double sky_number(const Atmosphere &atmosphere, std::size_t channel, std::size_t column) {
    const Between turbidity = between(atmosphere.turbidity - 1, turbidities);
    const double albedo = atmosphere.albedo[static_cast<int>(channel)];
    const auto at = [&](std::size_t t) {
        return std::lerp(along_elevation(t, 0, column, atmosphere.elevation),
                         along_elevation(t, 1, column, atmosphere.elevation), albedo);
    };
    return std::lerp(at(turbidity.first), at(turbidity.first + 1), turbidity.fraction);
}

} // namespace

SkyDistribution sky_distribution(const Atmosphere &atmosphere) {
    SkyDistribution sky;
    for (std::size_t channel = 0; channel < channels; ++channel) {
        for (std::size_t i = 0; i < parameter_count; ++i)
            sky.parameters.at(channel).at(i) =
                sky_number(atmosphere, channel, channel * parameter_count + i);
        sky.radiance[static_cast<int>(channel)] =
            sky_number(atmosphere, channel, channels * parameter_count + channel) /
            unit_spectrum_luminance;
    }
    return sky;
}

Rgb SkyDistribution::at(double cos_theta, double gamma) const {
    Rgb value;
    const double cosine = std::cos(gamma);
    for (int channel = 0; channel < 3; ++channel) {
        const auto &[a, b, c, d, e, f, g, h, i] = parameters.at(static_cast<std::size_t>(channel));
        // The anisotropic term's denominator, which cancels where i is about 1 and gamma small.
        const double apart = (1 - i) * (1 - i) + 4 * i * std::pow(std::sin(gamma / 2), 2);
        const double chi = (1 + cosine * cosine) / std::pow(apart, 1.5);
        value[channel] = radiance[channel] * (1 + a * std::exp(b / (cos_theta + 0.01))) *
                         (c + d * std::exp(e * gamma) + f * cosine * cosine + g * chi +
                          h * std::sqrt(cos_theta));
    }
    return value;
}

Rgb sun_irradiance(const Atmosphere &atmosphere) {
    const Between turbidity = between(atmosphere.turbidity - 1, turbidities);
    const Between elevation = between((atmosphere.elevation * 180 / pi - 2) / 3, sun_elevations);
    Rgb sum(0);
    for (std::size_t i = 0; i < wavelengths; ++i) {
        const auto at = [&](std::size_t t) {
            const SunRow *rows = &sun_rows[t * sun_elevations + elevation.first];
            return std::lerp(rows[0].at(i), rows[1].at(i), elevation.fraction);
        };
        const double value =
            std::lerp(at(turbidity.first), at(turbidity.first + 1), turbidity.fraction);
        sum += value * spectral_colour(320 + 40 * static_cast<double>(i));
    }
    // Over the wavelengths of visible light; Mitsuba divides by the luminance of a unit spectrum,
    // as it does with what it integrates over them.
    constexpr double range = 467.069280386;
    return sum * (range / wavelengths / unit_spectrum_luminance);
}

} // namespace clrender
