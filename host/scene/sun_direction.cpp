#include "sky_model.h"

#include <cmath>
#include <numbers>

namespace clrender {

namespace {

constexpr double pi = std::numbers::pi;

/// Days from noon of 1 January 2000 to midnight at the beginning of a date of the Gregorian
/// calendar: 365.25 days a year and 30.6 a month from March on, without three of four leap days of
/// centuries.
double days_since_2000(int year, int month, int day) {
    const int shifted_month = month > 2 ? month : month + 12;
    const int shifted_year = month > 2 ? year : year - 1;
    const double century = std::floor(shifted_year / 100.0);
    return std::floor(365.25 * shifted_year) + std::floor(30.6001 * (shifted_month + 1)) + day -
           century + std::floor(century / 4) - 730548.5;
}

} // namespace

glm::dvec3 sun_direction(const SunTime &time) {
    const double universal_hours =
        time.hour - time.timezone + (time.minute + time.second / 60) / 60;
    const double days = days_since_2000(time.year, time.month, time.day) + universal_hours / 24;

    // The ecliptic.
    const double node = 2.1429 - 0.0010394594 * days;
    const double mean_longitude = 4.8950630 + 0.017202791698 * days;
    const double anomaly = 6.2400600 + 0.0172019699 * days;
    const double longitude = mean_longitude + 0.03341607 * std::sin(anomaly) +
                             0.00034894 * std::sin(2 * anomaly) - 0.0001134 -
                             0.0000203 * std::sin(node);
    const double obliquity = 0.4090928 - 6.2140e-9 * days + 0.0000396 * std::cos(node);

    // The equator: right ascension and declination.
    const double ascension =
        std::atan2(std::cos(obliquity) * std::sin(longitude), std::cos(longitude));
    const double declination = std::asin(std::sin(obliquity) * std::sin(longitude));

    // The horizon.
    const double sidereal_hours = 6.6974243242 + 0.0657098283 * days + universal_hours;
    const double hour_angle = (sidereal_hours * 15 + time.longitude) * pi / 180 - ascension;
    const double latitude = time.latitude * pi / 180;
    double zenith = std::acos(std::cos(latitude) * std::cos(hour_angle) * std::cos(declination) +
                              std::sin(declination) * std::sin(latitude));
    const double azimuth =
        std::atan2(-std::sin(hour_angle), std::tan(declination) * std::cos(latitude) -
                                              std::sin(latitude) * std::cos(hour_angle));
    constexpr double earth_radius = 6371.01, sun_distance = 149597890; // km, for the parallax
    zenith += earth_radius / sun_distance * std::sin(zenith);

    // The azimuth is counted from the north over the east.
    return {-std::cos(azimuth) * std::sin(zenith), -std::sin(azimuth) * std::sin(zenith),
            std::cos(zenith)};
}

} // namespace clrender
