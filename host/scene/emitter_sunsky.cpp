/// Emitter "sunsky".

#include "../log.h"
#include "mitsuba_scene.h"
#include "scene/limits.h"
#include "similarity.h"

#include <cmath>
#include <numbers>

namespace clrender::mitsuba {

namespace {

constexpr double pi = std::numbers::pi;

const std::vector<std::string> time_names{"year",   "month",    "day",       "hour",    "minute",
                                          "second", "latitude", "longitude", "timezone"};

double read_scale(Properties &properties, const std::string &name) {
    const double scale = properties.number(name, 1);
    if (!(scale >= 0 && scale <= max_radiance))
        properties.fail(name, "is out of range, expected a number from 0 to 1e+30");
    return scale;
}

SunTime read_time(Properties &properties) {
    SunTime time;
    constexpr int most_years = 100000;
    time.year = static_cast<int>(properties.integer("year", time.year, -most_years, most_years));
    time.month = static_cast<int>(properties.integer("month", time.month, 1, 12));
    time.day = static_cast<int>(properties.integer("day", time.day, 1, 31));
    time.hour = properties.number("hour", time.hour);
    time.minute = properties.number("minute", time.minute);
    time.second = properties.number("second", time.second);
    time.latitude = properties.number("latitude", time.latitude);
    time.longitude = properties.number("longitude", time.longitude);
    time.timezone = properties.number("timezone", time.timezone);
    return time;
}

/// Towards the sun, in the world.
glm::dvec3 read_sun_direction(Properties &properties, const glm::dmat3 &to_world) {
    const auto direction = properties.point("sun_direction");
    if (!direction)
        return glm::normalize(to_world * sun_direction(read_time(properties)));
    for (const std::string &name : time_names)
        if (properties.has(name))
            properties.fail(name, "and sun_direction are both given, expected only one of them");
    if (!(glm::length(*direction) > 0))
        properties.fail("sun_direction", "has no length, expected a vector towards the sun");
    return glm::normalize(*direction);
}

} // namespace

void SceneReader::read_sunsky(Properties &properties, Emitter &emitter) {
    emitter.kind = EmitterKind::sunsky;
    emitter.to_world = properties.transform("to_world");
    const glm::dmat3 to_world(emitter.to_world);
    if (!is_similarity(to_world))
        properties.fail("to_world", "shears the sky or scales it unevenly, expected rotations, "
                                    "reflections and even scales");
    SunSky &sunsky = emitter.sunsky;
    Atmosphere atmosphere;
    atmosphere.turbidity = properties.number("turbidity", atmosphere.turbidity);
    if (!(atmosphere.turbidity >= 1 && atmosphere.turbidity <= 10))
        properties.fail("turbidity", "is out of range, expected a number from 1 to 10");
    atmosphere.albedo =
        read_constant(properties, "albedo", SpectrumUse::reflectance, atmosphere.albedo);
    for (int c = 0; c < 3; ++c)
        if (atmosphere.albedo[c] > 1)
            properties.fail("albedo", "is above 1, expected a colour from 0 to 1");
    const double sky_scale = read_scale(properties, "sky_scale");
    const double sun_scale = read_scale(properties, "sun_scale");
    const double aperture = properties.number("sun_aperture", 2 * sun_half_angle * 180 / pi);
    if (!(aperture > 1e-3 && aperture < 180))
        properties.fail("sun_aperture", "is out of range, expected degrees above 0.001, below 180");
    if (properties.boolean("complex_sun", false))
        throw UnsupportedError(properties.where("complex_sun"),
                               properties.description() +
                                   ": \"complex_sun\" is not supported, expected false: the sun's "
                                   "disk is even");

    sunsky.sun_direction = read_sun_direction(properties, to_world);
    const double height = glm::dot(sunsky.sun_direction, glm::normalize(to_world[2]));
    if (height < 0) {
        log::warn(properties.where(),
                  properties.description() + ": the sun is below the horizon: the sky is black");
        return;
    }
    atmosphere.elevation = std::asin(std::min(height, 1.0));
    sunsky.sky = sky_distribution(atmosphere);
    sunsky.sky.radiance *= sky_scale;
    sunsky.half_aperture = aperture / 2 * pi / 180;
    sunsky.sun_radiance = sun_irradiance(atmosphere) * sun_scale /
                          (4 * pi * std::pow(std::sin(sunsky.half_aperture / 2), 2));
}

} // namespace clrender::mitsuba
