#pragma once
/// The sky and the sun as Mitsuba 3's `sunsky` has them: Hosek and Wilkie, "An analytic model for
/// full spectral sky-dome radiance" (2012), in its RGB version, and "Adding a solar-radiance
/// function to the Hosek-Wilkie skylight model" (2013). Tables and their licence: hosek_wilkie/.

#include "bsdf.h"

#include <array>
#include <glm/glm.hpp>

namespace clrender {

/// What the models ask for.
struct Atmosphere {
    double turbidity = 3; ///< 1 to 10
    Rgb albedo{0.3};      ///< of the ground, 0 to 1
    double elevation = 0; ///< of the sun's centre above the horizon, radians, not negative
};

/// The half angle of the sun, radians.
inline constexpr double sun_half_angle = 0.5358 / 2 * 3.14159265358979323846 / 180;

/// The sky for one atmosphere: of each channel the parameters A to I of the model, and the mean
/// radiance that the distribution is scaled by.
struct SkyDistribution {
    std::array<std::array<double, 9>, 3> parameters{};
    Rgb radiance{0.0};

    /// Radiance at an angle from the zenith of cosine `cos_theta` (not negative), `gamma` radians
    /// from the sun's centre.
    [[nodiscard]] Rgb at(double cos_theta, double gamma) const;
};

SkyDistribution sky_distribution(const Atmosphere &atmosphere);

/// Irradiance of the sun's disk across its rays. Below 2 degrees as at 2 degrees, above 89 as
/// there.
Rgb sun_irradiance(const Atmosphere &atmosphere);

/// Where the sun stands, seen from a place on the earth.
struct SunTime {
    int year = 2010, month = 7, day = 10;
    double hour = 15, minute = 0, second = 0;        ///< local time
    double latitude = 35.6894, longitude = 139.6917; ///< degrees, north and east
    double timezone = 9;                             ///< hours
};

/// Unit vector towards the sun in the coordinates of `sunsky`: +z is the zenith, -x the north and
/// -y the east. Blanco-Muriel et al., "Computing the solar vector" (Solar Energy 70, 2001), whose
/// error is half a minute of arc from 1999 to 2015.
glm::dvec3 sun_direction(const SunTime &time);

} // namespace clrender
