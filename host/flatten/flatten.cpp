#include "flatten_parts.h"

#include <algorithm>

namespace clrender::inline CLR_PRECISION {

std::size_t FlatScene::bytes() const {
    std::size_t bytes = sizeof(frame);
    for_each_array(*this, [&](const auto &array) { bytes += bytes_of(array); });
    return bytes;
}

int FlatScene::sole_light_sphere() const {
    const bool is_sphere = lights.size() == 1 && lights.front().kind == CLR_LIGHT_SPHERE;
    if (!is_sphere || facts.environment == CLR_ENVIRONMENT_MAP || has_bvh_spheres())
        return none;
    return static_cast<int>(lights.front().prim);
}

bool FlatScene::has_tangents() const {
    return std::any_of(materials.begin(), materials.end(),
                       [](const Material &m) { return (m.kind & CLR_BSDF_TANGENTS) != 0; });
}

bool FlatScene::needs_uvs() const {
    return has_tangents() || std::any_of(textures.begin(), textures.end(), [](const auto &texture) {
               return texture.kind != CLR_TEXTURE_ATTRIBUTE;
           });
}

FlatScene flatten(const Scene &given, const SamplingOptions &options) {
    const std::optional<SceneOfFaces> with_faces = cubes_as_faces(given);
    const Scene &scene = with_faces ? with_faces->scene : given;
    Flattening work{scene, options};
    if (with_faces)
        work.cuboids = with_faces->cuboids;
    work.flat.facts.strategy = strategy_of(work);
    for (const Shape &shape : scene.shapes)
        work.boxes.push_back(shape_box(shape));
    work.instance_boxes = instance_boxes(scene);
    work.flat.placement = choose_placement(scene, work.boxes, work.instance_boxes);
    number_attributes(work);
    flatten_materials(work);
    // Textured lights need surface coordinates too, which the shapes have to know.
    for (const Emitter &emitter : scene.emitters)
        if (emitter.radiance != none && emitter.kind != EmitterKind::constant) {
            clr_real ignored[3];
            flatten_texture(work, emitter.radiance, Rgb{0.0}, ignored);
        }
    flatten_shapes(work);
    flatten_lights(work);
    flatten_camera(work);
    flatten_specular_connectors(work);
    work.flat.frame.film_exponent = film_exponent(scene, work.flat.placement);
    if (work.wants("ENVIRONMENT"))
        make_environment_map(work.flat);
    return std::move(work.flat);
}

} // namespace clrender::inline CLR_PRECISION
