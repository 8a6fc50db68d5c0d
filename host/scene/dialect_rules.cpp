#include "dialect_rules.h"

#include "../log.h"
#include "mitsuba_properties.h"
#include "mitsuba_text.h"

#include <charconv>
#include <optional>

namespace clrender::mitsuba {

namespace {

constexpr const char *any = "*";
constexpr auto all = Versions::all;
constexpr auto before_2 = Versions::before_2;

constexpr const char *bilinear_said =
    "the texture is filtered bilinearly: filters of a wider footprint are not supported";
/// The number that a text is, if it is one.
std::optional<double> number_of(std::string_view text) {
    double number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc{} && end == text.data() + text.size() ? std::optional(number)
                                                                    : std::nullopt;
}

constexpr const char *eight_bits_said =
    "the film is read as \"hdrfilm\": the picture is rendered linear, and stored as --output says";
constexpr const char *microfacets_said =
    "Phong's distribution of microfacets is replaced by Beckmann's, which it resembles";
constexpr const char *tone_said =
    "the picture is linear, and pictures of 8 bits are encoded as sRGB without exposure";

} // namespace

const TagRule tag_rules[] = {
    {all, "lookAt", "lookat"},
    {before_2, "camera", "sensor"},
    {before_2, "luminaire", "emitter"},
    {all, nullptr, nullptr},
};

const TypeRule type_rules[] = {
    {all, "film", "ldrfilm", "hdrfilm", eight_bits_said},
    {before_2, "film", "pngfilm", "hdrfilm", eight_bits_said},
    {before_2, "film", "exrfilm", "hdrfilm", ""},
    {before_2, "film", "tiledhdrfilm", "hdrfilm", ""},
    {before_2, "film", "mfilm", "hdrfilm", eight_bits_said},
    {before_2, "bsdf", "lambertian", "diffuse", ""},
    {before_2, "bsdf", "mirror", "conductor", ""},
    {before_2, "bsdf", "roughmetal", "roughconductor", ""},
    {before_2, "bsdf", "roughglass", "roughdielectric", ""},
    {before_2, "bsdf", "bump", "bumpmap", ""},
    {before_2, "emitter", "sky", "sunsky", ""},
    {before_2, "emitter", "sun", "sunsky", ""},
    {before_2, "texture", "vertexcolors", "mesh_attribute", ""},
    {before_2, "texture", "ldrtexture", "bitmap", ""},
    {before_2, "texture", "exrtexture", "bitmap", ""},
    {all, nullptr, nullptr, nullptr, nullptr},
};

const PropertyRule property_rules[] = {
    {before_2, "bsdf", "diffuse lambertian", "diffuse_reflectance", "reflectance"},
    {before_2, "bsdf", "roughmetal roughglass", "alpha_b", "alpha"},
    {before_2, "bsdf", "roughmetal", "ior", "eta"},
    {before_2, "shape", "sphere", "inverted", "flip_normals"},
    {before_2, "texture", "checkerboard", "bright_color", "color0"},
    {before_2, "texture", "checkerboard", "dark_color", "color1"},
    {before_2, "texture", any, "wrap_mode_u", "wrap_mode"},
    {before_2, "emitter", "area constant", "intensity", "radiance"},
    {before_2, "emitter", "directional", "intensity", "irradiance"},
    {before_2, "emitter", any, "intensity_scale", "scale"},
    {before_2, "sensor", any, "focus_depth", "focus_distance"},
    {before_2, "integrator", any, "luminaire_samples", "emitter_samples"},
    {all, "film", any, "high_quality_edges", "sample_border"},
    {all, nullptr, nullptr, nullptr, nullptr},
};

const ValueRule value_rules[] = {
    {all, "texture", any, "filter_type", "ewa trilinear", "bilinear", bilinear_said},
    {before_2, "bsdf", any, "distribution", "phong as", "beckmann", microfacets_said},
    {all, "film", any, "pixel_format", "luminancealpha", "luminance_alpha", ""},
    {all, "film", any, "pixel_format", "spectrum", "rgb", ""},
    {all, "film", any, "pixel_format", "spectrumalpha", "rgba", ""},
    {all, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr},
};

const DroppedRule dropped_rules[] = {
    {before_2, "texture", "bitmap ldrtexture exrtexture", "cache", any, ""},
    {before_2, "texture", "bitmap ldrtexture exrtexture", "max_anisotropy", any, ""},
    {before_2, "texture", "bitmap ldrtexture exrtexture", "gamma", "-1 0 2.2",
     "texels are linear or sRGB, as \"raw\" says"},
    {before_2, "bsdf", "conductor roughconductor roughmetal", "ext_eta", "1 1.000277 air vacuum",
     "the indices of metals are relative to vacuum"},
    {before_2, "emitter", "sky sun sunsky", "resolution", any, ""},
    {before_2, "emitter", "sky sun sunsky", "stretch", "1", "the sky ends at the horizon"},
    {before_2, "emitter", "sky sun sunsky", "extend", "false", "the sky ends at the horizon"},
    {before_2, "emitter", "envmap", "cache", any, ""},
    {before_2, "emitter", "envmap", "gamma", "-1 0 1 2.2",
     "the map's pixels are taken as its format has them"},
    {all, "film", "ldrfilm pngfilm mfilm", "file_format", any, ""},
    {all, "film", "ldrfilm pngfilm mfilm", "component_format", any, ""},
    {all, "film", "ldrfilm pngfilm mfilm", "tonemap_method", "gamma", tone_said},
    {all, "film", "ldrfilm pngfilm mfilm", "gamma", "-1 0 2.2", tone_said},
    {all, "film", "ldrfilm pngfilm mfilm", "exposure", "0", tone_said},
    {all, "film", "ldrfilm pngfilm mfilm", "key", any, ""},
    {all, "film", "ldrfilm pngfilm mfilm", "burn", any, ""},
    {all, "film", "mfilm", "digits", any, ""},
    {all, "film", "mfilm", "variable", any, ""},
    {before_2, "film", "hdrfilm exrfilm tiledhdrfilm", "channel_names", any, ""},
    {before_2, "shape", "obj ply serialized", "max_smooth_angle", "0 180",
     "the mesh has the normals of its file"},
    {before_2, "shape", "obj", "collapse", any, ""},
    {before_2, "shape", "obj", "load_materials", "false",
     "the shape has the material that the scene gives it"},
    {before_2, "shape", "ply", "srgb", any, ""},
    {before_2, "integrator", any, "strict_normals", "false",
     "where shading and geometric normals disagree, light is taken as path tracing of Mitsuba 3 "
     "takes it"},
    {all, nullptr, nullptr, nullptr, nullptr, nullptr},
};

bool is_listed(std::string_view list, std::string_view word) {
    if (list == any)
        return true;
    const auto number = number_of(word);
    for (const std::string_view entry : split_list(list))
        if (entry == word || (number && number_of(entry) == number))
            return true;
    return false;
}

namespace {

/// The child of `object` that gives `name` its value, or none.
pugi::xml_node property_of(pugi::xml_node object, const char *name) {
    return object.find_child_by_attribute("name", name);
}

void add_value(pugi::xml_node object, const char *tag, const char *name, const char *value,
               const pugi::xml_node &like, XmlFile &file) {
    pugi::xml_node added = file.append(object, tag, like);
    added.append_attribute("name").set_value(name);
    added.append_attribute("value").set_value(value);
}

/// `uscale`, `vscale`, `uoffset` and `voffset` of textures: u is scaled, then moved.
void upgrade_uv(pugi::xml_node object, XmlFile &file) {
    struct Step {
        const char *tag, *u, *v, *unchanged;
    };
    pugi::xml_node transform;
    for (const Step &step :
         {Step{"scale", "uscale", "vscale", "1"}, Step{"translate", "uoffset", "voffset", "0"}}) {
        const pugi::xml_node u = property_of(object, step.u);
        const pugi::xml_node v = property_of(object, step.v);
        if (!u && !v)
            continue;
        if (!transform) {
            transform = file.append(object, "transform", u ? u : v);
            transform.append_attribute("name").set_value("to_uv");
        }
        pugi::xml_node added = file.append(transform, step.tag, u ? u : v);
        added.append_attribute("x").set_value(u ? u.attribute("value").value() : step.unchanged);
        added.append_attribute("y").set_value(v ? v.attribute("value").value() : step.unchanged);
        object.remove_child(u);
        object.remove_child(v);
    }
}

/// One wrap mode for both axes: the second of two equal ones goes. What is not stated repeats.
void upgrade_wrap_modes(pugi::xml_node object, const XmlFile &file) {
    const pugi::xml_node u = property_of(object, "wrap_mode_u");
    const pugi::xml_node v = property_of(object, "wrap_mode_v");
    if (!v)
        return;
    const std::string along_u = u ? to_lower(u.attribute("value").value()) : "repeat";
    if (along_u != to_lower(v.attribute("value").value()))
        throw UnsupportedError(file.where(v), "\"wrap_mode_v\" is " +
                                                  in_quotes(v.attribute("value").value()) +
                                                  ", \"wrap_mode_u\" " + in_quotes(along_u) +
                                                  ", expected one wrap mode for both");
    object.remove_child(v);
}

/// A `gamma` of 1 tells that the texels are linear.
void upgrade_gamma(pugi::xml_node texture, XmlFile &file) {
    const pugi::xml_node gamma = property_of(texture, "gamma");
    if (!is_listed("1", gamma.attribute("value").value()))
        return;
    add_value(texture, "boolean", "raw", "true", gamma, file);
    texture.remove_child(gamma);
}

/// Before version 0.4 cameras looked along +z with +x to the right, and their field of view was
/// that of the smaller side unless `mapSmallerSide` was off.
void upgrade_camera(pugi::xml_node camera, XmlFile &file) {
    if (const pugi::xml_node transform = property_of(camera, "to_world"))
        file.prepend(transform, "scale", transform).append_attribute("x").set_value("-1");
    if (std::string_view(camera.attribute("type").value()) != "perspective")
        return;
    const pugi::xml_node smaller = property_of(camera, "map_smaller_side");
    const bool is_off = std::string_view(smaller.attribute("value").value()) == "false";
    add_value(camera, "string", "fov_axis", is_off ? "larger" : "smaller",
              smaller ? smaller : camera, file);
    camera.remove_child(smaller);
}

/// <boolean name="alpha"> of the films before 0.4.
void upgrade_alpha(pugi::xml_node film, XmlFile &file) {
    const pugi::xml_node alpha = property_of(film, "alpha");
    if (!alpha)
        return;
    const bool has_alpha = std::string_view(alpha.attribute("value").value()) == "true";
    add_value(film, "string", "pixel_format", has_alpha ? "rgba" : "rgb", alpha, file);
    film.remove_child(alpha);
}

/// Metals that name no material: copper once, a perfect mirror today.
void warn_of_mirror(pugi::xml_node metal, const XmlFile &file) {
    for (const char *name : {"material", "eta", "k"})
        if (property_of(metal, name))
            return;
    log::warn(file.where(metal), "the metal names no material: as in Mitsuba 3 it is a perfect "
                                 "mirror, copper in Mitsuba 0.6");
}

} // namespace

void upgrade_forms(pugi::xml_node object, const std::string &tag, const std::string &type,
                   XmlFile &file) {
    if (tag == "texture") {
        upgrade_uv(object, file);
        upgrade_wrap_modes(object, file);
        if (is_listed("bitmap ldrtexture exrtexture", type))
            upgrade_gamma(object, file);
        else if (type == "vertexcolors")
            add_value(object, "string", "name", "vertex_color", object, file);
    } else if ((tag == "emitter" || tag == "luminaire") && is_listed("sky sun sunsky", type)) {
        upgrade_sky(object, type, file);
    } else if (tag == "camera") {
        upgrade_camera(object, file);
    } else if (tag == "film") {
        upgrade_alpha(object, file);
    } else if (tag == "bsdf" && type == "mirror") {
        add_value(object, "string", "material", "Cr", object, file);
    } else if (tag == "bsdf" && is_listed("conductor roughconductor roughmetal", type)) {
        warn_of_mirror(object, file);
    }
}

} // namespace clrender::mitsuba
