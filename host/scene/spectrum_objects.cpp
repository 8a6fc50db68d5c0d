/// <spectrum type="...">: uniform, srgb, d65, blackbody, regular, irregular.

#include "../log.h"
#include "mitsuba_scene.h"
#include "mitsuba_text.h"
#include "scene/limits.h"

#include <algorithm>

namespace clrender::mitsuba {

namespace {

std::vector<double> read_list(Properties &properties, const std::string &name) {
    const auto text = properties.string(name);
    if (!text)
        properties.fail(name, "is missing, expected a list of numbers");
    return parse_numbers(properties.where(name), name, *text);
}

/// Values at even steps from wavelength_min to wavelength_max.
Spectrum read_regular(Properties &properties) {
    const auto first = properties.number("wavelength_min");
    const auto last = properties.number("wavelength_max");
    if (!first || !last || !(*last > *first))
        properties.fail("wavelength_max", "is not above wavelength_min, expected both, in nm");
    Spectrum spectrum;
    spectrum.values = read_list(properties, "values");
    const std::size_t count = spectrum.values.size();
    if (count < 2)
        properties.fail("values", "has fewer than two numbers, expected at least two");
    for (std::size_t i = 0; i < count; ++i)
        spectrum.wavelengths.push_back(*first + (*last - *first) * static_cast<double>(i) /
                                                    static_cast<double>(count - 1));
    return spectrum;
}

Spectrum read_irregular(Properties &properties) {
    Spectrum spectrum;
    spectrum.wavelengths = read_list(properties, "wavelengths");
    spectrum.values = read_list(properties, "values");
    if (spectrum.wavelengths.size() < 2)
        properties.fail("wavelengths", "has fewer than two numbers, expected at least two");
    if (spectrum.values.size() != spectrum.wavelengths.size())
        properties.fail("values", "has not as many numbers as wavelengths, expected one for each");
    if (std::adjacent_find(spectrum.wavelengths.begin(), spectrum.wavelengths.end(),
                           std::greater_equal<>()) != spectrum.wavelengths.end())
        properties.fail("wavelengths", "do not ascend, expected each one once, in order");
    return spectrum;
}

Spectrum read_blackbody(Properties &properties, SpectrumUse use) {
    constexpr double hottest = 1e6;
    if (use != SpectrumUse::emission)
        throw InputError(properties.where(),
                         properties.description() + " in a surface, expected it in a light");
    const auto kelvins = properties.number("temperature");
    if (!kelvins || !(*kelvins > 0 && *kelvins <= hottest))
        properties.fail("temperature", "is missing or out of range, expected kelvins above 0, at "
                                       "most 1e+06");
    Spectrum spectrum = blackbody_spectrum(*kelvins);
    const double scale = read_emitter_scale(properties);
    for (double &value : spectrum.values)
        value *= scale;
    return spectrum;
}

} // namespace

bool is_spectrum_type(const std::string &type) {
    return type == "uniform" || type == "srgb" || type == "d65" || type == "blackbody" ||
           type == "regular" || type == "irregular";
}

int SceneReader::read_d65(Properties &properties, SpectrumUse use) {
    const double scale = properties.number("scale", 1);
    check_range(properties, "scale", Rgb(scale), use, false);
    for (const char *tag : {"texture", "spectrum"})
        for (const Child *child : properties.children(tag)) {
            const int index = read_texture(child->object, use);
            if (scale == 1)
                return index;
            const Texture &texture = scene_.textures.at(static_cast<std::size_t>(index));
            if (texture.kind != TextureKind::constant)
                throw UnsupportedError(properties.where("scale"),
                                       properties.description() +
                                           ": \"scale\" of a texture is not supported, expected 1");
            return add_constant(texture.value * scale);
        }
    if (properties.find("color") == nullptr)
        return add_constant(Rgb(scale));
    const Rgb colour = read_constant(properties, "color", use, Rgb(1)) * scale;
    check_range(properties, "color", colour, use, true);
    return add_constant(colour);
}

int SceneReader::read_spectrum_object(Properties &properties, SpectrumUse use) {
    // In RGB mode "uniform" and "d65" are grey, also in lights.
    const std::string &type = properties.object().type;
    if (type == "d65")
        return read_d65(properties, use);
    if (type == "srgb" || type == "uniform") {
        const std::string needed = type == "srgb" ? "color" : "value";
        if (properties.find(needed) == nullptr)
            properties.fail(needed, "is missing, expected what the texture shows");
        if (type == "srgb")
            return read_colour(properties, "color", use);
        properties.ignore({"wavelength_min", "wavelength_max"});
        const Rgb value(properties.number("value", 1));
        check_range(properties, "value", value, use, false);
        return add_constant(value);
    }
    Spectrum spectrum;
    if (type == "blackbody")
        spectrum = read_blackbody(properties, use);
    else if (type == "regular")
        spectrum = read_regular(properties);
    else
        spectrum = read_irregular(properties);
    const Rgb colour =
        colour_of_spectrum(spectrum, use, properties.where(), properties.description());
    check_range(properties, "values", colour, use, false);
    return add_constant(colour);
}

} // namespace clrender::mitsuba
