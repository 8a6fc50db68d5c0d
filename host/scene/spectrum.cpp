#include "spectrum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace clrender {

namespace {

// The tables reach from 360 nm to 830 nm in steps of 5 nm.
constexpr double first_wavelength = 360, last_wavelength = 830;
constexpr int table_size = 95;

// The luminance of a unit spectrum with the weight of the illuminant D65.
constexpr double d65_luminance = 98.99741751876255;

/// CIE 1931 colour matching functions (2 degree observer): x, y, z of each wavelength.
constexpr std::array<std::array<double, 3>, table_size> cie_xyz{{
    {0.0001299, 3.917e-06, 0.0006061},
    {0.0002321, 6.965e-06, 0.001086},
    {0.0004149, 1.239e-05, 0.001946},
    {0.0007416, 2.202e-05, 0.003486},
    {0.001368, 3.9e-05, 0.006450001},
    {0.002236, 6.4e-05, 0.01054999},
    {0.004243, 0.00012, 0.02005001},
    {0.00765, 0.000217, 0.03621},
    {0.01431, 0.000396, 0.06785001},
    {0.02319, 0.00064, 0.1102},
    {0.04351, 0.00121, 0.2074},
    {0.07763, 0.00218, 0.3713},
    {0.13438, 0.004, 0.6456},
    {0.21477, 0.0073, 1.03905},
    {0.2839, 0.0116, 1.3856},
    {0.3285, 0.01684, 1.62296},
    {0.34828, 0.023, 1.74706},
    {0.34806, 0.0298, 1.7826},
    {0.3362, 0.038, 1.77211},
    {0.3187, 0.048, 1.7441},
    {0.2908, 0.06, 1.6692},
    {0.2511, 0.0739, 1.5281},
    {0.19536, 0.09098, 1.28764},
    {0.1421, 0.1126, 1.0419},
    {0.09564, 0.13902, 0.8129501},
    {0.05795001, 0.1693, 0.6162},
    {0.03201, 0.20802, 0.46518},
    {0.0147, 0.2586, 0.3533},
    {0.0049, 0.323, 0.272},
    {0.0024, 0.4073, 0.2123},
    {0.0093, 0.503, 0.1582},
    {0.0291, 0.6082, 0.1117},
    {0.06327, 0.71, 0.07824999},
    {0.1096, 0.7932, 0.05725001},
    {0.1655, 0.862, 0.04216},
    {0.2257499, 0.9148501, 0.02984},
    {0.2904, 0.954, 0.0203},
    {0.3597, 0.9803, 0.0134},
    {0.4334499, 0.9949501, 0.008749999},
    {0.5120501, 1, 0.005749999},
    {0.5945, 0.995, 0.0039},
    {0.6784, 0.9786, 0.002749999},
    {0.7621, 0.952, 0.0021},
    {0.8425, 0.9154, 0.0018},
    {0.9163, 0.87, 0.001650001},
    {0.9786, 0.8163, 0.0014},
    {1.0263, 0.757, 0.0011},
    {1.0567, 0.6949, 0.001},
    {1.0622, 0.631, 0.0008},
    {1.0456, 0.5668, 0.0006},
    {1.0026, 0.503, 0.00034},
    {0.9384, 0.4412, 0.00024},
    {0.8544499, 0.381, 0.00019},
    {0.7514, 0.321, 0.0001},
    {0.6424, 0.265, 4.999999e-05},
    {0.5419, 0.217, 3e-05},
    {0.4479, 0.175, 2e-05},
    {0.3608, 0.1382, 1e-05},
    {0.2835, 0.107, 0},
    {0.2187, 0.0816, 0},
    {0.1649, 0.061, 0},
    {0.1212, 0.04458, 0},
    {0.0874, 0.032, 0},
    {0.0636, 0.0232, 0},
    {0.04677, 0.017, 0},
    {0.0329, 0.01192, 0},
    {0.0227, 0.00821, 0},
    {0.01584, 0.005723, 0},
    {0.01135916, 0.004102, 0},
    {0.008110916, 0.002929, 0},
    {0.005790346, 0.002091, 0},
    {0.004109457, 0.001484, 0},
    {0.002899327, 0.001047, 0},
    {0.00204919, 0.00074, 0},
    {0.001439971, 0.00052, 0},
    {0.0009999493, 0.0003611, 0},
    {0.0006900786, 0.0002492, 0},
    {0.0004760213, 0.0001719, 0},
    {0.0003323011, 0.00012, 0},
    {0.0002348261, 8.48e-05, 0},
    {0.0001661505, 6e-05, 0},
    {0.000117413, 4.24e-05, 0},
    {8.307527e-05, 3e-05, 0},
    {5.870652e-05, 2.12e-05, 0},
    {4.150994e-05, 1.499e-05, 0},
    {2.935326e-05, 1.06e-05, 0},
    {2.067383e-05, 7.4657e-06, 0},
    {1.455977e-05, 5.2578e-06, 0},
    {1.025398e-05, 3.7029e-06, 0},
    {7.221456e-06, 2.6078e-06, 0},
    {5.085868e-06, 1.8366e-06, 0},
    {3.581652e-06, 1.2934e-06, 0},
    {2.522525e-06, 9.1093e-07, 0},
    {1.776509e-06, 6.4153e-07, 0},
    {1.251141e-06, 4.5181e-07, 0},
}};

/// CIE standard illuminant D65, 100 at 560 nm.
constexpr std::array<double, table_size> cie_d65{
    46.6383, 49.3637, 52.0891, 51.0323, 49.9755, 52.3118, 54.6482, 68.7015, 82.7549, 87.1204,
    91.486,  92.4589, 93.4318, 90.057,  86.6823, 95.7736, 104.865, 110.936, 117.008, 117.41,
    117.812, 116.336, 114.861, 115.392, 115.923, 112.367, 108.811, 109.082, 109.354, 108.578,
    107.802, 106.296, 104.79,  106.239, 107.689, 106.047, 104.405, 104.225, 104.046, 102.023,
    100,     98.1671, 96.3342, 96.0611, 95.788,  92.2368, 88.6856, 89.3459, 90.0062, 89.8026,
    89.5991, 88.6489, 87.6987, 85.4936, 83.2886, 83.4939, 83.6992, 81.863,  80.0268, 80.1207,
    80.2146, 81.2462, 82.2778, 80.281,  78.2842, 74.0027, 69.7213, 70.6652, 71.6091, 72.979,
    74.349,  67.9765, 61.604,  65.7448, 69.8856, 72.4863, 75.087,  69.3398, 63.5927, 55.0054,
    46.4182, 56.6118, 66.8054, 65.0941, 63.3828, 63.8434, 64.304,  61.8779, 59.4519, 55.7054,
    51.959,  54.6998, 57.4406, 58.8765, 60.3125,
};

/// Where a wavelength falls in the tables: between `index` and the next, at `fraction`.
struct TablePosition {
    std::size_t index;
    double fraction;
};

TablePosition table_position(double wavelength) {
    const double t =
        (wavelength - first_wavelength) * (table_size - 1) / (last_wavelength - first_wavelength);
    const auto index = static_cast<std::size_t>(std::clamp(static_cast<int>(t), 0, table_size - 2));
    return {index, t - static_cast<double>(index)};
}

Rgb colour_matching(double wavelength) {
    const auto [i, f] = table_position(wavelength);
    const auto &a = cie_xyz.at(i), &b = cie_xyz.at(i + 1);
    return glm::mix(Rgb(a[0], a[1], a[2]), Rgb(b[0], b[1], b[2]), f);
}

double d65_power(double wavelength) {
    const auto [i, f] = table_position(wavelength);
    return glm::mix(cie_d65.at(i), cie_d65.at(i + 1), f) / d65_luminance;
}

/// XYZ to the linear primaries of ITU-R BT.709.
Rgb xyz_to_rgb(const Rgb &xyz) {
    return {3.240479 * xyz.x - 1.537150 * xyz.y - 0.498535 * xyz.z,
            -0.969256 * xyz.x + 1.875991 * xyz.y + 0.041556 * xyz.z,
            0.055648 * xyz.x - 0.204043 * xyz.y + 1.057311 * xyz.z};
}

double value_at(const Spectrum &spectrum, double wavelength) {
    const auto &w = spectrum.wavelengths;
    const auto after = std::upper_bound(w.begin() + 1, w.end() - 1, wavelength);
    const auto i = static_cast<std::size_t>(after - w.begin());
    const double width = w[i] - w[i - 1];
    const double f = width > 0 ? (wavelength - w[i - 1]) / width : 0;
    return glm::mix(spectrum.values[i - 1], spectrum.values[i], f);
}

} // namespace

Rgb spectral_colour(double wavelength) {
    return wavelength < first_wavelength || wavelength > last_wavelength
               ? Rgb(0)
               : xyz_to_rgb(colour_matching(wavelength));
}

Spectrum blackbody_spectrum(double kelvins) {
    constexpr double speed_of_light = 299792458, planck = 6.62607015e-34, boltzmann = 1.380649e-23;
    constexpr double nanometre = 1e-9;
    Spectrum spectrum;
    for (double wavelength = first_wavelength; wavelength <= last_wavelength; ++wavelength) {
        const double metres = wavelength * nanometre;
        spectrum.wavelengths.push_back(wavelength);
        spectrum.values.push_back(
            2 * planck * speed_of_light * speed_of_light / std::pow(metres, 5) * nanometre /
            std::expm1(planck * speed_of_light / (metres * boltzmann * kelvins)));
    }
    return spectrum;
}

Rgb uniform_emission(double value) {
    return value * xyz_to_rgb(Rgb(1));
}

SpectrumColour spectrum_to_rgb(const Spectrum &spectrum, SpectrumUse use) {
    // A uniform spectrum is grey under D65, and the colour of a flat spectrum as a light.
    if (spectrum.wavelengths.empty()) {
        const double value = spectrum.values.at(0);
        return {use == SpectrumUse::emission ? uniform_emission(value) : Rgb(value), false};
    }

    // Integrate with a thousand evenly spaced samples; outside of the list the spectrum is 0.
    constexpr int steps = 1000;
    Rgb xyz(0);
    for (int i = 0; i < steps; ++i) {
        const double wavelength =
            first_wavelength + i / (steps - 1.0) * (last_wavelength - first_wavelength);
        if (wavelength < spectrum.wavelengths.front() || wavelength > spectrum.wavelengths.back())
            continue;
        const double light = use == SpectrumUse::emission ? 1 : d65_power(wavelength);
        xyz += colour_matching(wavelength) * (value_at(spectrum, wavelength) * light);
    }
    xyz *= (last_wavelength - first_wavelength) / steps / unit_spectrum_luminance;

    // Colours that no such quantity can have in these primaries are clamped.
    const Rgb rgb = xyz_to_rgb(xyz);
    const double highest =
        use == SpectrumUse::reflectance ? 1 : std::numeric_limits<double>::infinity();
    const Rgb clamped = glm::clamp(rgb, Rgb(0), Rgb(highest));
    return {clamped, clamped != rgb};
}

} // namespace clrender
