#pragma once
/// Spectra to linear sRGB, with the numbers of Mitsuba 3's RGB mode.

#include "scene.h"

#include <vector>

namespace clrender {

/// Values at ascending wavelengths (nm), linear in between, 0 outside; or, with no wavelengths,
/// one value for all of them.
struct Spectrum {
    std::vector<double> wavelengths, values;
};

/// What a spectrum stands for decides its conversion: quantities that light is multiplied with are
/// weighted by the illuminant D65 (so that 1 is white), lights are not. Reflectances are clamped to
/// [0, 1], everything else to be no less than 0. `number`: one value is asked for; `data`: three
/// that are no colour.
enum class SpectrumUse { reflectance, refractive_index, emission, number, data };

struct SpectrumColour {
    Rgb rgb;
    bool clamped; ///< it lay outside of what the primaries can show
};

/// Linear sRGB of a spectrum that has one value, or two and more at wavelengths.
SpectrumColour spectrum_to_rgb(const Spectrum &spectrum, SpectrumUse use);

/// The luminance of a spectrum of 1, by which colours are divided.
inline constexpr double unit_spectrum_luminance = 106.7502593994140625;

/// Linear sRGB of the colour matching functions at a wavelength (nm), which are 0 beyond 360 to
/// 830.
Rgb spectral_colour(double wavelength);

/// The radiance of a black body of that many kelvins, W m^-2 sr^-1 nm^-1, by Planck's law.
Spectrum blackbody_spectrum(double kelvins);

/// The colour of a light with the same power at every wavelength.
Rgb uniform_emission(double value);

} // namespace clrender
