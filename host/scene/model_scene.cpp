#include "model_scene.h"

#include "mesh_io.h"
#include "scene_files.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <utility>
#include <vector>

namespace clrender {

namespace {

/// A sphere around all vertices.
struct Bounds {
    glm::dvec3 center{0.0};
    double radius = 1;
    double floor = 0; ///< smallest y
};

Bounds bounds_of(const std::vector<ObjPart> &parts) {
    glm::dvec3 low(std::numeric_limits<double>::infinity());
    glm::dvec3 high(-std::numeric_limits<double>::infinity());
    for (const ObjPart &part : parts)
        for (const glm::dvec3 &p : part.mesh.positions) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
    Bounds bounds;
    bounds.center = 0.5 * (low + high);
    bounds.floor = low.y;
    double radius = 0;
    for (const ObjPart &part : parts)
        for (const glm::dvec3 &p : part.mesh.positions)
            radius = std::max(radius, glm::length(p - bounds.center));
    bounds.radius = radius > 0 ? radius : 1;
    return bounds;
}

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

/// Diffuse on both sides: models are seldom closed.
int add_diffuse(Scene &scene, int reflectance) {
    const int side = add_bsdf(scene, {DiffuseBsdf{reflectance}, {}, {}});
    return add_bsdf(scene, {TwosidedBsdf{side, side}, {}, {}});
}

/// Textures that may turn out not to be readable, and the colour that then takes their place.
using TextureColors = std::vector<std::pair<int, Rgb>>;

int add_material(Scene &scene, const ObjMaterial &material, SceneFiles &files,
                 TextureColors &colors) {
    const auto reflectance = [](const Rgb &c) { return glm::clamp(c, 0.0, 1.0); };
    Bsdf bsdf;
    bsdf.id = material.name;
    switch (surface_of(material)) {
    case ObjSurface::glass:
        bsdf.model = DielectricBsdf{{material.ior > 1 ? material.ior : 1.5, 1}};
        return add_bsdf(scene, bsdf);
    case ObjSurface::mirror:
        bsdf.model = ConductorBsdf{add_color(scene, reflectance(material.specular))};
        return add_bsdf(scene, bsdf);
    case ObjSurface::diffuse:
        break;
    }
    if (material.diffuse_map.empty())
        return add_diffuse(scene, add_color(scene, reflectance(material.diffuse)));

    Texture texture;
    texture.kind = TextureKind::bitmap;
    texture.to_uv = material.map_to_uv;
    texture.wrap = material.is_map_clamped ? TextureWrap::clamp : TextureWrap::repeat;
    texture.bitmap = files.image(material.diffuse_map, material.where_map, {.is_optional = true});
    scene.textures.push_back(std::move(texture));
    const int index = static_cast<int>(scene.textures.size()) - 1;
    colors.emplace_back(index, reflectance(material.diffuse));
    return add_diffuse(scene, index);
}

/// Gives textures without a picture a plain colour.
void replace_missing(Scene &scene, const TextureColors &colors) {
    for (const auto &[index, color] : colors) {
        Texture &texture = scene.textures[static_cast<std::size_t>(index)];
        if (texture.bitmap->width > 0)
            continue;
        texture = Texture();
        texture.value = color;
    }
}

Shape &add_shape(Scene &scene, ShapeKind kind, const glm::dmat4 &to_world, int bsdf) {
    Shape shape;
    shape.kind = kind;
    shape.to_world = to_world;
    shape.bsdf = bsdf;
    scene.shapes.push_back(std::move(shape));
    return scene.shapes.back();
}

/// Makes the last shape shine.
void add_light(Scene &scene, const Rgb &radiance) {
    Emitter emitter;
    emitter.radiance = add_color(scene, radiance);
    emitter.shape = static_cast<int>(scene.shapes.size()) - 1;
    scene.shapes.back().emitter = static_cast<int>(scene.emitters.size());
    scene.emitters.push_back(emitter);
}

/// +z of the object looks along `direction`, +y upwards.
glm::dmat4 look_along(const glm::dvec3 &origin, const glm::dvec3 &direction) {
    const glm::dvec3 z = glm::normalize(direction);
    const glm::dvec3 x = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), z));
    const glm::dvec3 y = glm::cross(z, x);
    return {glm::dvec4(x, 0), glm::dvec4(y, 0), glm::dvec4(z, 0), glm::dvec4(origin, 1)};
}

void add_model(Scene &scene, ObjFile &model) {
    SceneFiles files;
    TextureColors colors;
    std::map<std::string, const ObjMaterial *> materials;
    for (const ObjMaterial &material : model.materials)
        materials.try_emplace(material.name, &material);

    std::map<std::string, int> bsdfs;
    const int default_bsdf = add_diffuse(scene, add_color(scene, Rgb(0.7, 0.66, 0.6)));
    for (ObjPart &part : model.parts) {
        const auto found = materials.find(part.material);
        const ObjMaterial *material = found == materials.end() ? nullptr : found->second;
        if (material != nullptr && bsdfs.count(part.material) == 0)
            bsdfs[part.material] = add_material(scene, *material, files, colors);
        Shape &shape = add_shape(scene, ShapeKind::mesh, glm::dmat4(1.0),
                                 material ? bsdfs[part.material] : default_bsdf);
        shape.mesh = std::make_shared<const Mesh>(std::move(part.mesh));
        shape.id = part.material;
        if (material != nullptr &&
            std::max({material->emission.r, material->emission.g, material->emission.b}) > 0)
            add_light(scene, glm::max(material->emission, 0.0));
    }
    files.read();
    replace_missing(scene, colors);
}

void add_surroundings(Scene &scene, const Bounds &bounds) {
    // The ground reaches to what looks like a horizon.
    const double r = bounds.radius;
    const glm::dvec3 below(bounds.center.x, bounds.floor, bounds.center.z);
    glm::dmat4 ground = glm::translate(glm::dmat4(1.0), below);
    ground = glm::rotate(ground, glm::radians(-90.0), glm::dvec3(1, 0, 0));
    ground = glm::scale(ground, glm::dvec3(60 * r));
    add_shape(scene, ShapeKind::disk, ground,
              add_diffuse(scene, add_color(scene, Rgb(0.55, 0.55, 0.56))));

    // A warm disk as wide as the model, above to the left of the camera, and a cool dim sky.
    const glm::dvec3 to_light = glm::normalize(glm::dvec3(-0.55, 1.0, 0.75));
    const glm::dvec3 light_center = bounds.center + 4.5 * r * to_light;
    add_shape(scene, ShapeKind::disk,
              glm::scale(look_along(light_center, -to_light), glm::dvec3(1.5 * r)),
              add_diffuse(scene, add_color(scene, Rgb(0.0))));
    add_light(scene, 9.0 * Rgb(1.0, 0.94, 0.86));
    Emitter sky;
    sky.kind = EmitterKind::constant;
    sky.radiance = add_color(scene, Rgb(0.36, 0.4, 0.46));
    scene.emitters.push_back(sky);
}

void add_camera(Scene &scene, const Bounds &bounds) {
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

} // namespace

Scene load_model(const std::string &path) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    ObjFile model;
    if (extension == ".ply")
        model.parts.push_back({"", read_ply_mesh(path, {})});
    else
        model = read_obj_file(path);

    Scene scene;
    scene.name = std::filesystem::path(path).stem().string();
    scene.film.crop_width = scene.film.width;
    scene.film.crop_height = scene.film.height;
    scene.integrator.max_depth = 8;
    scene.sample_count = 64;
    const Bounds bounds = bounds_of(model.parts);
    add_model(scene, model);
    add_surroundings(scene, bounds);
    add_camera(scene, bounds);
    return scene;
}

} // namespace clrender
