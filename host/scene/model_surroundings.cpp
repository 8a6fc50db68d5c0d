#include "model_surroundings.h"

#include "shape_bounds.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace clrender {

namespace {

/// +z of the object looks along `direction`, +y upwards.
glm::dmat4 look_along(const glm::dvec3 &origin, const glm::dvec3 &direction) {
    const glm::dvec3 z = glm::normalize(direction);
    const glm::dvec3 x = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), z));
    const glm::dvec3 y = glm::cross(z, x);
    return {glm::dvec4(x, 0), glm::dvec4(y, 0), glm::dvec4(z, 0), glm::dvec4(origin, 1)};
}

} // namespace

int add_color(Scene &scene, const Rgb &color) {
    Texture texture;
    texture.value = color;
    scene.textures.push_back(texture);
    return static_cast<int>(scene.textures.size()) - 1;
}

int add_bsdf(Scene &scene, const Bsdf &bsdf) {
    scene.bsdfs.push_back(bsdf);
    return static_cast<int>(scene.bsdfs.size()) - 1;
}

int add_twosided(Scene &scene, const BsdfModel &model) {
    const int side = add_bsdf(scene, {model, {}, {}});
    return add_bsdf(scene, {TwosidedBsdf{side, side}, {}, {}});
}

int add_diffuse(Scene &scene, int reflectance) {
    return add_twosided(scene, DiffuseBsdf{reflectance});
}

Shape &add_shape(Scene &scene, ShapeKind kind, const glm::dmat4 &to_world, int bsdf) {
    Shape shape;
    shape.kind = kind;
    shape.to_world = to_world;
    shape.bsdf = bsdf;
    scene.shapes.push_back(std::move(shape));
    return scene.shapes.back();
}

void add_area_light(Scene &scene, int radiance) {
    Emitter emitter;
    emitter.radiance = radiance;
    emitter.shape = static_cast<int>(scene.shapes.size()) - 1;
    scene.shapes.back().emitter = static_cast<int>(scene.emitters.size());
    scene.emitters.push_back(emitter);
}

ModelBounds bounds_of_meshes(const Scene &scene) {
    Box box;
    for (const Shape &shape : scene.shapes)
        if (shape.kind == ShapeKind::mesh)
            box.add(shape_box(shape));
    const std::vector<Box> instances = instance_boxes(scene);
    for (const Box &instance : instances)
        box.add(instance);
    ModelBounds bounds;
    if (box.empty())
        return bounds;
    bounds.center = 0.5 * (box.low + box.high);
    bounds.floor = box.low.y;
    double radius = 0;
    const auto reach = [&](const glm::dvec3 &p) {
        radius = std::max(radius, glm::length(p - bounds.center));
    };
    for (const Shape &shape : scene.shapes)
        if (shape.kind == ShapeKind::mesh)
            for (const glm::dvec3 &p : shape.mesh->positions)
                reach(glm::dvec3(shape.to_world * glm::dvec4(p, 1)));
    for (const Box &instance : instances)
        if (!instance.empty())
            for (const glm::dvec3 &corner : instance.corners())
                reach(corner);
    bounds.radius = radius > 0 ? radius : 1;
    return bounds;
}

void add_ground(Scene &scene, const ModelBounds &bounds) {
    // The ground reaches to what looks like a horizon.
    const double r = bounds.radius;
    const glm::dvec3 below(bounds.center.x, bounds.floor, bounds.center.z);
    glm::dmat4 ground = glm::translate(glm::dmat4(1.0), below);
    ground = glm::rotate(ground, glm::radians(-90.0), glm::dvec3(1, 0, 0));
    ground = glm::scale(ground, glm::dvec3(60 * r));
    add_shape(scene, ShapeKind::disk, ground,
              add_diffuse(scene, add_color(scene, Rgb(0.55, 0.55, 0.56))));
}

void add_lights(Scene &scene, const ModelBounds &bounds) {
    const double r = bounds.radius;
    // A warm disk as wide as the model, above to the left of the camera, and a cool dim sky.
    const glm::dvec3 to_light = glm::normalize(glm::dvec3(-0.55, 1.0, 0.75));
    const glm::dvec3 light_center = bounds.center + 4.5 * r * to_light;
    add_shape(scene, ShapeKind::disk,
              glm::scale(look_along(light_center, -to_light), glm::dvec3(1.5 * r)),
              add_diffuse(scene, add_color(scene, Rgb(0.0))));
    add_area_light(scene, add_color(scene, 9.0 * Rgb(1.0, 0.94, 0.86)));
    Emitter sky;
    sky.kind = EmitterKind::constant;
    sky.radiance = add_color(scene, Rgb(0.36, 0.4, 0.46));
    scene.emitters.push_back(sky);
}

void add_camera(Scene &scene, const ModelBounds &bounds) {
    // The sphere touches the upper and lower edge of the picture, with a little air.
    Sensor &sensor = scene.sensor;
    sensor.fov = 35;
    const double aspect = static_cast<double>(scene.film.height) / scene.film.width;
    const double half_height = std::atan(std::tan(glm::radians(0.5 * sensor.fov)) * aspect);
    const double distance = 1.02 * bounds.radius / std::sin(half_height);
    const glm::dvec3 to_camera = glm::normalize(glm::dvec3(0.55, 0.38, 1.0));
    sensor.to_world = look_along(bounds.center + distance * to_camera, -to_camera);
    sensor.focus_distance = distance;
}

} // namespace clrender
