/// Textures, and the colours that may stand where a texture can.

#include "../log.h"
#include "mitsuba_scene.h"
#include "mitsuba_text.h"
#include "scene/limits.h"

#include <cmath>
#include <fmt/core.h>
#include <utility>

namespace clrender::mitsuba {

namespace {

const std::vector<std::string> texture_types{
    "bitmap", "checkerboard", "mesh_attribute", "rawconstant", "uniform", "srgb",
    "d65",    "blackbody",    "regular",        "irregular",   "scale"};

bool any_below(const Rgb &rgb, double limit) {
    return rgb.r < limit || rgb.g < limit || rgb.b < limit;
}

bool any_above(const Rgb &rgb, double limit) {
    return rgb.r > limit || rgb.g > limit || rgb.b > limit;
}

/// The colour of a value, or nothing if it is none.
std::optional<Rgb> colour_of(const Properties &properties, const Property &property,
                             SpectrumUse use) {
    const PropertyValue &value = property.value;
    if (const auto *number = std::get_if<double>(&value))
        return Rgb(*number);
    if (const auto *integer = std::get_if<std::int64_t>(&value))
        return Rgb(static_cast<double>(*integer));
    if (const auto *rgb = std::get_if<Colour>(&value))
        return rgb->value;
    if (const auto *spectrum = std::get_if<Spectrum>(&value)) {
        return colour_of_spectrum(*spectrum, use, properties.where(property.name),
                                  "spectrum " + in_quotes(property.name));
    }
    return std::nullopt;
}

double mean_of(const Rgb &rgb) {
    return (rgb.r + rgb.g + rgb.b) / 3;
}

/// What Mitsuba makes of colours where it asks for a number: constant ones give their mean, bitmaps
/// their luminance, and checkerboards show color1 where they else show color0.
void make_number(Texture &texture) {
    texture.is_number = true;
    std::swap(texture.color0, texture.color1);
    for (Rgb *constant : {&texture.value, &texture.color0, &texture.color1})
        *constant = Rgb(mean_of(*constant));
}

} // namespace

void check_range(const Properties &properties, const std::string &name, const Rgb &rgb,
                 SpectrumUse use, bool is_rgb) {
    if (any_below(rgb, 0))
        properties.fail(name, "is negative, expected no value below 0");
    if (any_above(rgb, max_radiance))
        properties.fail(name,
                        fmt::format("is too large, expected no value above {:g}", max_radiance));
    if (use != SpectrumUse::reflectance || !any_above(rgb, 1))
        return;
    if (is_rgb)
        properties.fail(name, "is above 1, expected an <rgb> from 0 to 1");
    log::warn(properties.where(name),
              in_quotes(name) + " is above 1: the surface gives more light than it gets");
}

Rgb colour_of_spectrum(const Spectrum &spectrum, SpectrumUse use, const SourceLocation &where,
                       const std::string &what) {
    const SpectrumColour colour = spectrum_to_rgb(spectrum, use);
    if (colour.clamped)
        log::warn(where, what + " has a colour outside of sRGB, which is clamped");
    return colour.rgb;
}

int SceneReader::add_constant(const Rgb &value) {
    Texture texture;
    texture.value = value;
    scene_.textures.push_back(std::move(texture));
    return static_cast<int>(scene_.textures.size()) - 1;
}

int SceneReader::read_colour(Properties &properties, const std::string &name, SpectrumUse use) {
    if (const Property *property = properties.find(name)) {
        const auto rgb = colour_of(properties, *property, use);
        if (!rgb)
            properties.fail(name, "is " + type_name(property->value) +
                                      ", expected an rgb, a float, a spectrum or a texture");
        check_range(properties, name, *rgb, use, std::holds_alternative<Colour>(property->value));
        return add_constant(use == SpectrumUse::number ? Rgb(mean_of(*rgb)) : *rgb);
    }
    const Child *child = properties.child(name);
    if (child == nullptr)
        return none;
    const Object &object = document_.at(child->object);
    if (object.tag != "texture" && object.tag != "spectrum")
        properties.fail(name, "is a " + object.tag + ", expected a texture or a colour");
    return read_texture(child->object, use);
}

Rgb SceneReader::read_constant(Properties &properties, const std::string &name, SpectrumUse use,
                               const Rgb &fallback) {
    const int index = read_colour(properties, name, use);
    if (index == none)
        return fallback;
    const Texture texture = scene_.textures.at(static_cast<std::size_t>(index));
    if (texture.kind != TextureKind::constant)
        throw UnsupportedError(properties.where(name),
                               properties.description() + ": " + in_quotes(name) +
                                   " varies over the surface, expected one colour");
    return texture.value;
}

int SceneReader::read_number(Properties &properties, const std::string &name, double fallback) {
    const int index = read_colour(properties, name, SpectrumUse::number);
    return index != none ? index : add_constant(Rgb(fallback));
}

int SceneReader::read_texture(int object, SpectrumUse use) {
    if (const auto known = textures_.find({object, use}); known != textures_.end())
        return known->second;
    int index = none;
    if (!attempt([&] { index = read_new_texture(object, use); }))
        index = add_constant(Rgb(0.5)); // nothing is rendered
    if (use == SpectrumUse::number)
        make_number(scene_.textures.at(static_cast<std::size_t>(index)));
    textures_[{object, use}] = index;
    return index;
}

int SceneReader::read_new_texture(int object, SpectrumUse use) {
    Properties properties(document_, object);
    const std::string &type = properties.object().type;
    int index = none;
    if (type == "bitmap")
        index = read_bitmap(properties, use);
    else if (type == "checkerboard")
        index = read_checkerboard(properties, use);
    else if (type == "mesh_attribute")
        index = read_mesh_attribute(properties);
    else if (type == "rawconstant")
        index = read_raw_constant(properties, use);
    else if (type == "scale")
        index = read_scaled_texture(properties, use);
    else if (is_spectrum_type(type))
        index = read_spectrum_object(properties, use);
    else
        fail_unsupported(document_, properties.object(), texture_types);
    properties.finish();
    return index;
}

int SceneReader::read_bitmap(Properties &properties, SpectrumUse use) {
    Texture texture;
    texture.kind = TextureKind::bitmap;
    texture.format.raw = properties.boolean("raw", false);
    texture.format.half = properties.choice("format", 0, {"auto", "variant", "fp16"}) == 2;
    texture.filter =
        static_cast<TextureFilter>(properties.choice("filter_type", 0, {"bilinear", "nearest"}));
    texture.wrap =
        static_cast<TextureWrap>(properties.choice("wrap_mode", 0, {"repeat", "mirror", "clamp"}));
    texture.to_uv = properties.uv_transform("to_uv");
    properties.ignore({"accel"});
    const std::string path = properties.file("filename");
    if (load_images_)
        texture.bitmap = files_.image(path, properties.where("filename"),
                                      {texture.format.raw, use == SpectrumUse::emission});
    if (load_images_ && properties.has("channel"))
        texture.bitmap = read_channel(properties, texture.bitmap, texture.format);
    else
        properties.find("channel");
    scene_.textures.push_back(std::move(texture));
    return static_cast<int>(scene_.textures.size()) - 1;
}

int SceneReader::read_checkerboard(Properties &properties, SpectrumUse use) {
    const SpectrumUse use_of_squares =
        use == SpectrumUse::number ? SpectrumUse::number : SpectrumUse::reflectance;
    Texture texture;
    texture.kind = TextureKind::checkerboard;
    texture.color0 = read_constant(properties, "color0", use_of_squares, texture.color0);
    texture.color1 = read_constant(properties, "color1", use_of_squares, texture.color1);
    texture.to_uv = properties.uv_transform("to_uv");
    scene_.textures.push_back(std::move(texture));
    return static_cast<int>(scene_.textures.size()) - 1;
}

int SceneReader::read_raw_constant(Properties &properties, SpectrumUse use) {
    const Property *property = properties.find("value");
    if (property == nullptr)
        properties.fail("value", "is missing, expected a float or a vector");
    Rgb value;
    if (const auto *number = std::get_if<double>(&property->value))
        value = Rgb(*number);
    else if (const auto *vector = std::get_if<Triple>(&property->value);
             vector != nullptr && use != SpectrumUse::number)
        value = vector->value;
    else
        properties.fail("value", "is " + type_name(property->value) + ", expected a float" +
                                     (use == SpectrumUse::number ? "" : " or a vector"));
    check_range(properties, "value", value, use, false);
    return add_constant(value);
}

} // namespace clrender::mitsuba
