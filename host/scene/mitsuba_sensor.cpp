/// Sensors (perspective, thinlens, orthographic) and samplers.

#include "../log.h"
#include "mitsuba_scene.h"
#include "mitsuba_text.h"
#include "scene/limits.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

namespace clrender::mitsuba {

namespace {

/// The diagonal of 35 mm film (36 mm x 24 mm), which focal lengths refer to.
const double film_diagonal = std::hypot(36.0, 24.0);

double fov_of_focal_length(double millimetres) {
    return glm::degrees(2 * std::atan(film_diagonal / (2 * millimetres)));
}

void read_clip_distances(Properties &properties, Sensor &sensor) {
    sensor.near_clip = properties.number("near_clip");
    sensor.far_clip = properties.number("far_clip");
    if (sensor.near_clip && !(*sensor.near_clip > 0))
        properties.fail("near_clip", "is not positive, expected a distance above 0");
    if (sensor.far_clip && !(*sensor.far_clip > sensor.near_clip.value_or(0)))
        properties.fail("far_clip", "is too small, expected a distance beyond near_clip");
}

void read_lens(Properties &properties, Sensor &sensor) {
    sensor.kind = SensorKind::thinlens;
    if (!properties.has("aperture_radius"))
        throw InputError(properties.where(), properties.description() +
                                                 " has no \"aperture_radius\", expected a float");
    sensor.aperture_radius = properties.number("aperture_radius", 0);
    if (sensor.aperture_radius < 0)
        properties.fail("aperture_radius", "is negative, expected no number below 0");
    if (!(sensor.focus_distance > 0))
        properties.fail("focus_distance", "is not positive, expected a distance above 0");
}

void check_unscaled(const Properties &properties, const glm::dmat4 &to_world) {
    constexpr double tolerance = 1e-3;
    for (int axis = 0; axis < 3; ++axis)
        if (std::abs(glm::length(glm::dvec3(to_world[axis])) - 1) > tolerance)
            properties.fail("to_world", "scales the camera, expected only rotations and "
                                        "translations");
}

/// The only child of a kind, or none.
int single_child(Properties &properties, const std::string &tag) {
    const auto found = properties.children(tag);
    if (found.size() > 1)
        throw InputError(properties.document().where(properties.object(), found[1]->line),
                         properties.description() + " has a second " + tag + ", expected one");
    return found.empty() ? none : found[0]->object;
}

} // namespace

FieldOfView read_field_of_view(Properties &properties) {
    const auto fov = properties.number("fov");
    const auto focal_length = properties.string("focal_length");
    if (fov && focal_length)
        properties.fail("focal_length", "and fov are both given, expected only one of them");
    const auto axis = static_cast<FovAxis>(
        properties.choice("fov_axis", 0, {"x", "y", "diagonal", "smaller", "larger"}));
    if (fov) {
        if (!(*fov > 0 && *fov < 180))
            properties.fail("fov", "is out of range, expected degrees above 0 and below 180");
        return {*fov, axis};
    }

    // Without either, Mitsuba takes a lens of 50 mm.
    std::string text = focal_length.value_or("50mm");
    if (text.size() > 2 && text.substr(text.size() - 2) == "mm")
        text.resize(text.size() - 2);
    const double millimetres =
        parse_number(properties.where("focal_length"), "\"focal_length\"", text);
    if (!(millimetres > 0))
        properties.fail("focal_length", "is not positive, expected a length such as \"50mm\"");
    return {fov_of_focal_length(millimetres), FovAxis::diagonal};
}

void SceneReader::read_sensor(int object) {
    Properties properties(document_, object);
    const std::string &type = properties.object().type;
    if (type != "perspective" && type != "thinlens" && type != "orthographic")
        fail_unsupported(document_, properties.object(),
                         {"perspective", "thinlens", "orthographic"});

    Sensor &sensor = scene_.sensor;
    sensor = Sensor();
    sensor.where = properties.where();
    sensor.to_world = properties.transform("to_world");
    read_clip_distances(properties, sensor);
    sensor.focus_distance = properties.number("focus_distance", sensor.focus_distance);
    if (type == "orthographic") {
        sensor.kind = SensorKind::orthographic;
    } else {
        check_unscaled(properties, sensor.to_world);
        const FieldOfView field = read_field_of_view(properties);
        sensor.fov = field.degrees;
        sensor.fov_axis = field.axis;
        sensor.principal_point_offset = {properties.number("principal_point_offset_x", 0),
                                         properties.number("principal_point_offset_y", 0)};
    }
    if (type == "thinlens")
        read_lens(properties, sensor);
    properties.ignore({"shutter_open", "shutter_close"});

    read_film(single_child(properties, "film"));
    read_sampler(single_child(properties, "sampler"));
    properties.finish();
}

void SceneReader::read_sampler(int object) {
    scene_.sample_count = 4; // Mitsuba's default
    if (object == none)
        return;

    // All samplers lead to the same expected picture: only their number of samples counts.
    Properties properties(document_, object);
    scene_.sample_count = static_cast<int>(
        properties.integer("sample_count", scene_.sample_count, 1, max_sample_count));
    properties.ignore_rest();
    properties.finish();
}

void SceneReader::place_default_sensor() {
    scene_.sensor = Sensor();
    scene_.sensor.fov = 45;
    glm::dvec3 lowest(0);
    glm::dvec3 highest(0);
    if (bounds_of(scene_, lowest, highest)) {
        // Far enough along -z for the largest extent of the scene to fill the picture.
        const glm::dvec3 extent = highest - lowest;
        const double largest = std::max({extent.x, extent.y, extent.z});
        const double distance = largest / (2 * std::tan(glm::radians(45.0) / 2));
        const glm::dvec3 center = (lowest + highest) / 2.0;
        scene_.sensor.to_world =
            glm::translate(glm::dmat4(1), glm::dvec3(center.x, center.y, lowest.z - distance));
        scene_.sensor.focus_distance = distance + extent.z / 2;
    }
    read_film(none);
    read_sampler(none);
}

} // namespace clrender::mitsuba
