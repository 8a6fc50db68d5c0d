/// Emitters: point, area, directionalarea, constant, envmap; those in emitter_<kind>.cpp are called
/// from here.

#include "../log.h"
#include "mitsuba_scene.h"
#include "mitsuba_text.h"
#include "scene/limits.h"

#include <algorithm>
#include <fmt/core.h>

namespace clrender::mitsuba {

namespace {

const std::vector<std::string> emitter_types{"point", "area",        "constant",  "envmap",
                                             "spot",  "directional", "projector", "directionalarea",
                                             "sunsky"};

bool belongs_to_shape(const std::string &type) {
    return type == "area" || type == "directionalarea";
}

bool is_environment(const Emitter &emitter) {
    return emitter.kind == EmitterKind::constant || emitter.kind == EmitterKind::envmap ||
           emitter.kind == EmitterKind::sunsky;
}

/// Weights steer the sampling of lights, not the picture, unless a light is never sampled.
void accept_sampling_weight(Properties &properties) {
    if (!(properties.number("sampling_weight", 1) > 0))
        throw UnsupportedError(properties.where("sampling_weight"),
                               properties.description() +
                                   ": \"sampling_weight\" is not positive, expected a number "
                                   "above 0");
}

} // namespace

void SceneReader::read_emitter(int object) {
    Properties properties(document_, object);
    const std::string &type = properties.object().type;
    if (belongs_to_shape(type)) {
        if (area_emitters_.count(object) == 0)
            log::warn(properties.where(), "area light outside of a shape is ignored");
        return;
    }

    Emitter emitter;
    emitter.where = properties.where();
    if (type == "point") {
        read_point(properties, emitter);
    } else if (type == "constant") {
        emitter.kind = EmitterKind::constant;
        emitter.radiance =
            add_constant(read_constant(properties, "radiance", SpectrumUse::emission, Rgb(1)));
        properties.ignore({"to_world"});
    } else if (type == "envmap") {
        read_envmap(properties, emitter);
    } else if (type == "spot") {
        read_spot(properties, emitter);
    } else if (type == "directional") {
        read_directional(properties, emitter);
    } else if (type == "projector") {
        read_projector(properties, emitter);
    } else if (type == "sunsky") {
        read_sunsky(properties, emitter);
    } else {
        fail_unsupported(document_, properties.object(), emitter_types);
    }
    accept_sampling_weight(properties);
    properties.finish();

    // There is one environment at most.
    if (is_environment(emitter))
        for (const Emitter &other : scene_.emitters)
            if (is_environment(other))
                throw InputError(emitter.where, properties.description() +
                                                    " is a second environment, expected one "
                                                    "\"constant\", \"envmap\" or \"sunsky\"");
    scene_.emitters.push_back(std::move(emitter));
}

double read_emitter_scale(Properties &properties) {
    const double scale = properties.number("scale", 1);
    if (scale < 0)
        properties.fail("scale", "is negative, expected no number below 0");
    if (scale > max_radiance)
        properties.fail("scale", "is too large, expected no number above 1e+30");
    return scale;
}

void SceneReader::read_point(Properties &properties, Emitter &emitter) {
    emitter.kind = EmitterKind::point;
    emitter.intensity = read_constant(properties, "intensity", SpectrumUse::emission, Rgb(1));
    if (properties.has("position") && properties.has("to_world"))
        properties.fail("position", "and to_world are both given, expected only one of them");
    emitter.position =
        properties.point("position").value_or(glm::dvec3(properties.transform("to_world")[3]));
}

void SceneReader::read_envmap(Properties &properties, Emitter &emitter) {
    emitter.kind = EmitterKind::envmap;
    emitter.scale = read_emitter_scale(properties);
    emitter.to_world = properties.transform("to_world");
    properties.ignore({"mis_compensation"});
    emitter.bitmap =
        files_.image(properties.file("filename"), properties.where("filename"), {.is_light = true});
    files_.then([properties, image = emitter.bitmap] {
        if (image->width < 2 || image->height < 3)
            properties.fail("filename", fmt::format("has {}x{} pixels, expected at least 2x3",
                                                    image->width, image->height));
    });
}

int SceneReader::read_area_emitter(int object, int shape) {
    Properties properties(document_, object);
    const std::string &type = properties.object().type;
    if (!belongs_to_shape(type)) {
        if (std::count(emitter_types.begin(), emitter_types.end(), type) > 0)
            throw InputError(properties.where(), properties.description() +
                                                     " inside of a shape, expected an area light");
        fail_unsupported(document_, properties.object(), {"area", "directionalarea"});
    }
    if (!area_emitters_.insert(object).second)
        throw InputError(properties.where(), properties.description() +
                                                 " belongs to two shapes, expected one for each");

    Emitter emitter;
    emitter.kind = EmitterKind::area;
    emitter.where = properties.where();
    emitter.shape = shape;
    emitter.radiance = read_colour(properties, "radiance", SpectrumUse::emission);
    if (type == "directionalarea") {
        // Every direction but one is dark, and no path takes that one by chance.
        emitter.radiance = add_constant(Rgb(0));
        log::warn(properties.where(), properties.description() +
                                          " shines along its normals alone, where path tracing "
                                          "finds none of its light: the shape is black");
    }
    if (emitter.radiance == none)
        emitter.radiance = add_constant(Rgb(1));
    if (properties.has("to_world"))
        properties.fail("to_world", "is given, expected none: the light lies where its shape does");
    accept_sampling_weight(properties);
    properties.finish();
    scene_.emitters.push_back(std::move(emitter));
    return static_cast<int>(scene_.emitters.size()) - 1;
}

} // namespace clrender::mitsuba
