#include "gltf_scene.h"

#include "../log.h"
#include "gltf_cameras.h"
#include "gltf_images.h"
#include "gltf_nodes.h"
#include "gltf_primitives.h"
#include "gltf_skins.h"
#include "gltf_surfaces.h"
#include "model_surroundings.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace clrender {

namespace {

using namespace gltf;

/// A mesh is shown by instances where its copies would add so many triangles.
constexpr std::size_t many_triangles = 100'000;

/// Materials whose emission is brighter than this light a scene; others are what glows in one.
constexpr double least_lamp = 1;

/// A mesh and the skin that moves it, or -1.
using ShownMesh = std::pair<int, int>;

class SceneMaker {
public:
    SceneMaker(const Document &document, Scene &scene)
        : document_(document), scene_(scene), nodes_(placed_nodes(document)), images_(document),
          surfaces_(document, images_, scene) {}

    void add_meshes();
    void add_lights();
    void add_sensor(std::optional<int> chosen);
    void warn_of_passages() const;

private:
    void read_primitives();
    void place(const ShownMesh &mesh, const std::vector<glm::dmat4> &places);
    void add_shapes(const SurfacedMesh &part, const glm::dmat4 &to_world);
    [[nodiscard]] Shape shape_of(const SurfacedMesh &part, const glm::dmat4 &to_world) const;

    const Document &document_;
    Scene &scene_;
    std::vector<PlacedNode> nodes_;
    Images images_;
    SurfaceMaker surfaces_;
    std::map<ShownMesh, std::vector<glm::dmat4>> places_;
    std::map<ShownMesh, std::vector<Primitive>> primitives_;
    std::map<ShownMesh, std::vector<SurfacedMesh>> parts_;
    bool is_lit_ = false;
    bool has_camera_ = false;
};

/// Reads the meshes that nodes show, and notes the pictures that their materials need.
void SceneMaker::read_primitives() {
    std::set<int> materials;
    std::map<int, glm::dmat4> joints;
    for (const PlacedNode &node : nodes_)
        joints[node.index] = node.to_world;
    for (const auto &[shown, places] : places_) {
        const auto [index, skin] = shown;
        const std::string place = place_of("meshes", index);
        const tinygltf::Mesh &mesh =
            element(document_, document_.model.meshes, index, "mesh", "nodes");
        for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
            Primitive primitive = read_primitive(
                document_, mesh.primitives[i],
                place + "." + place_of("primitives", static_cast<int>(i)), skin >= 0);
            if (primitive.mesh.triangles.empty())
                continue;
            if (skin >= 0)
                apply_skin(document_, skin, joints, primitive);
            if (materials.insert(primitive.material).second)
                images_.want(surfaces_.material(primitive.material));
            primitives_[shown].push_back(std::move(primitive));
        }
    }
}

void SceneMaker::add_meshes() {
    for (const PlacedNode &node : nodes_) {
        if (node.node->mesh < 0)
            continue;
        if (node.node->skin >= 0) // in the world already, as often as it is named
            places_[{node.node->mesh, node.node->skin}] = {glm::dmat4(1.0)};
        else if (glm::determinant(glm::dmat3(node.to_world)) == 0)
            document_.warn(place_of("nodes", node.index),
                           "its mesh has no volume in the world and is ignored");
        else
            places_[{node.node->mesh, -1}].push_back(node.to_world);
    }
    read_primitives();
    images_.read();
    for (auto &[shown, primitives] : primitives_)
        for (Primitive &primitive : primitives)
            for (SurfacedMesh &part : surfaced(document_, std::move(primitive), surfaces_))
                parts_[shown].push_back(std::move(part));
    for (const auto &[shown, places] : places_)
        place(shown, places);
}

Shape SceneMaker::shape_of(const SurfacedMesh &part, const glm::dmat4 &to_world) const {
    Shape shape;
    shape.kind = ShapeKind::mesh;
    shape.to_world = to_world;
    shape.mesh = part.mesh;
    shape.bsdf = part.surface.bsdf;
    shape.attribute_textures = part.surface.attribute_textures;
    shape.where = {document_.path, 0};
    return shape;
}

void SceneMaker::add_shapes(const SurfacedMesh &part, const glm::dmat4 &to_world) {
    Shape shape = shape_of(part, to_world);
    // The standard turns the order of a mirrored triangle's corners over.
    shape.flip_normals = part.mesh->normals.empty() && glm::determinant(glm::dmat3(to_world)) < 0;
    scene_.shapes.push_back(std::move(shape));
    if (part.surface.radiance != none)
        add_area_light(scene_, part.surface.radiance);
}

void SceneMaker::place(const ShownMesh &mesh, const std::vector<glm::dmat4> &places) {
    std::size_t triangles = 0;
    for (const SurfacedMesh &part : parts_[mesh])
        triangles += part.mesh->triangles.size();
    ShapeGroup group;
    const bool pays = triangles * (places.size() - 1) >= many_triangles;
    for (const SurfacedMesh &part : parts_[mesh]) {
        // What shines has no instances.
        if (pays && part.surface.radiance == none)
            group.shapes.push_back(shape_of(part, glm::dmat4(1.0)));
        else
            for (const glm::dmat4 &to_world : places)
                add_shapes(part, to_world);
    }
    if (group.shapes.empty())
        return;
    for (const glm::dmat4 &to_world : places)
        scene_.instances.push_back(
            {static_cast<int>(scene_.groups.size()), glm::dmat4x3(to_world)});
    scene_.groups.push_back(std::move(group));
}

void SceneMaker::add_lights() {
    for (const PlacedNode &node : nodes_)
        if (const int light = light_of(*node.node); light >= 0) {
            read_light(document_, node, light, scene_);
            is_lit_ = true;
        }
    for (const Emitter &emitter : scene_.emitters)
        if (emitter.kind == EmitterKind::area) {
            const Texture &texture = scene_.textures[static_cast<std::size_t>(emitter.radiance)];
            const Rgb radiance =
                texture.kind == TextureKind::constant ? texture.value : texture.scale;
            is_lit_ |= std::max({radiance.r, radiance.g, radiance.b}) > least_lamp;
        }
}

/// Lights that are points or directions are found by shadow rays alone, which take what light
/// passes straight through for opaque.
void SceneMaker::warn_of_passages() const {
    const bool has_passages =
        std::any_of(scene_.bsdfs.begin(), scene_.bsdfs.end(), [](const Bsdf &bsdf) {
            return std::holds_alternative<MaskBsdf>(bsdf.model) ||
                   std::holds_alternative<ThinDielectricBsdf>(bsdf.model);
        });
    if (is_lit_ && has_passages &&
        std::any_of(scene_.emitters.begin(), scene_.emitters.end(),
                    [](const Emitter &emitter) { return emitter.kind != EmitterKind::area; }))
        document_.warn("", "its punctual lights do not shine through surfaces with alpha or thin "
                           "glass, which throw whole shadows");
}

void SceneMaker::add_sensor(std::optional<int> chosen) {
    std::vector<const PlacedNode *> cameras;
    for (const PlacedNode &node : nodes_)
        if (node.node->camera >= 0)
            cameras.push_back(&node);
    const int count = static_cast<int>(cameras.size());
    if (chosen.value_or(0) != 0 && *chosen >= count)
        throw document_.error("", fmt::format("--sensor {}: the file has {} cameras, expected a "
                                              "number below that",
                                              *chosen, count));
    const ModelBounds bounds = bounds_of_meshes(scene_);
    if (!is_lit_) {
        log::info(document_.path + ": nothing in it gives light: a soft light and a dim sky are "
                                   "added");
        if (cameras.empty())
            add_ground(scene_, bounds);
        clrender::add_lights(scene_, bounds);
    }
    if (cameras.empty())
        add_camera(scene_, bounds);
    else
        read_camera(document_, *cameras[static_cast<std::size_t>(chosen.value_or(0))], scene_);
}

} // namespace

Scene load_gltf(const std::string &path, const LoadOptions &options) {
    const Document document = read_document(path);
    Scene scene;
    scene.name = std::filesystem::path(path).stem().string();
    scene.film.crop_width = scene.film.width;
    scene.film.crop_height = scene.film.height;
    scene.integrator.max_depth = 8;
    scene.integrator.skips_passages = true;
    scene.sample_count = 64;
    SceneMaker maker(document, scene);
    maker.add_meshes();
    maker.add_lights();
    maker.warn_of_passages();
    maker.add_sensor(options.sensor);
    return scene;
}

} // namespace clrender
