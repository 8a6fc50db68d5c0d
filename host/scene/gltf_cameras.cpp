#include "gltf_cameras.h"

#include "scene/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace clrender::gltf {

namespace {

/// A sensor's and a spot's +z is -z of a node, and +x is -x: rotations and places alone.
glm::dmat4 turned_place(const Document &document, const PlacedNode &node) {
    const glm::dvec3 back(node.to_world[2]);
    const glm::dvec3 up(node.to_world[1]);
    const glm::dvec3 left = -glm::cross(up, back);
    if (!(glm::length(back) > 0 && glm::length(left) > 0))
        throw document.error(place_of("nodes", node.index),
                             "scales a camera or a light to nothing, expected no scale");
    const glm::dvec3 z = -glm::normalize(back);
    const glm::dvec3 x = glm::normalize(left);
    const glm::dvec3 y = glm::cross(z, x);
    return {glm::dvec4(x, 0), glm::dvec4(y, 0), glm::dvec4(z, 0), node.to_world[3]};
}

void set_aspect(double aspect, FilmSettings &film) {
    constexpr double least = 1.0 / 64;
    film.width = static_cast<int>(std::lround(film.height * std::clamp(aspect, least, 64.0)));
    film.crop_width = film.width;
}

double positive(const Document &document, const std::string &place, const char *name,
                double value) {
    if (!(value > 0 && value <= max_radiance))
        throw document.error(place,
                             fmt::format("{} is {:g}, expected a number above 0", name, value));
    return value;
}

} // namespace

void read_camera(const Document &document, const PlacedNode &node, Scene &scene) {
    const std::string place = place_of("cameras", node.node->camera);
    const tinygltf::Camera &camera = element(document, document.model.cameras, node.node->camera,
                                             "camera", place_of("nodes", node.index));
    Sensor &sensor = scene.sensor;
    sensor = Sensor();
    sensor.where = {document.path, 0};
    sensor.to_world = turned_place(document, node);
    double near_clip = 0;
    double far_clip = 0;
    if (camera.type == "perspective") {
        const tinygltf::PerspectiveCamera &p = camera.perspective;
        sensor.fov = glm::degrees(positive(document, place, "yfov", p.yfov));
        if (!(sensor.fov < 180))
            throw document.error(place, fmt::format("yfov is {:g}, expected radians below {:.4f}",
                                                    p.yfov, std::numbers::pi));
        sensor.fov_axis = FovAxis::y;
        if (p.aspectRatio != 0)
            set_aspect(positive(document, place, "aspectRatio", p.aspectRatio), scene.film);
        near_clip = positive(document, place, "znear", p.znear);
        far_clip = p.zfar;
    } else if (camera.type == "orthographic") {
        const tinygltf::OrthographicCamera &o = camera.orthographic;
        const double width = positive(document, place, "xmag", std::abs(o.xmag));
        const double height = positive(document, place, "ymag", std::abs(o.ymag));
        sensor.kind = SensorKind::orthographic;
        for (int axis : {0, 1})
            sensor.to_world[axis] *= width;
        set_aspect(width / height, scene.film);
        near_clip = o.znear;
        far_clip = o.zfar;
    } else {
        throw document.error(place, "type " + camera.type.substr(0, 40) +
                                        ", expected perspective or orthographic");
    }
    if (near_clip > 0)
        sensor.near_clip = near_clip;
    if (far_clip != 0) {
        if (!(far_clip > near_clip))
            throw document.error(place, "zfar is not beyond znear");
        sensor.far_clip = far_clip;
    }
}

int light_of(const tinygltf::Node &node) {
    const auto found = node.extensions.find("KHR_lights_punctual");
    if (found == node.extensions.end() || !found->second.Has("light"))
        return -1;
    return found->second.Get("light").GetNumberAsInt();
}

void read_light(const Document &document, const PlacedNode &node, int light, Scene &scene) {
    const std::string place = place_of("lights", light);
    const tinygltf::Light &source =
        element(document, document.model.lights, light, "light", place_of("nodes", node.index));
    Emitter emitter;
    emitter.where = {document.path, 0};
    Rgb color(1);
    if (!source.color.empty() && source.color.size() != 3)
        throw document.error(place, "color has not three numbers");
    for (std::size_t c = 0; c < source.color.size(); ++c)
        color[static_cast<int>(c)] = source.color[c];
    emitter.intensity = color * source.intensity;
    for (int c = 0; c < 3; ++c)
        if (!(emitter.intensity[c] >= 0 && emitter.intensity[c] <= max_radiance))
            throw document.error(place, fmt::format("color times intensity is {:g}, expected a "
                                                    "number from 0 to {:g}",
                                                    emitter.intensity[c], max_radiance));
    if (source.type == "point") {
        emitter.kind = EmitterKind::point;
        emitter.position = glm::dvec3(node.to_world[3]);
    } else if (source.type == "directional") {
        emitter.kind = EmitterKind::directional;
        emitter.direction = glm::dvec3(turned_place(document, node)[2]);
    } else if (source.type == "spot") {
        emitter.kind = EmitterKind::spot;
        emitter.to_world = turned_place(document, node);
        const double inner = source.spot.innerConeAngle;
        const double outer = source.spot.outerConeAngle;
        if (!(inner >= 0 && inner <= outer && outer > 0 && outer <= std::numbers::pi / 2 + 1e-6))
            throw document.error(place, fmt::format("cone angles {:g} and {:g}, expected 0 <= "
                                                    "innerConeAngle < outerConeAngle <= pi/2",
                                                    inner, outer));
        emitter.cutoff_angle = std::min(glm::degrees(outer), 90.0);
        emitter.beam_width = std::min(glm::degrees(inner), emitter.cutoff_angle);
    } else {
        throw document.error(place, "type " + source.type.substr(0, 40) +
                                        ", expected point, spot or directional");
    }
    if (source.range > 0)
        document.warn(place, "range is ignored: light falls off with the square of the distance");
    scene.emitters.push_back(emitter);
}

} // namespace clrender::gltf
