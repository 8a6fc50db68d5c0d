#include "flatten_parts.h"

namespace clrender::inline CLR_PRECISION {

std::size_t FlatScene::bytes() const {
    std::size_t bytes = sizeof(frame);
    for_each_array(*this, [&](const auto &array) { bytes += bytes_of(array); });
    return bytes;
}

FlatScene flatten(const Scene &scene, const FlattenOptions &options) {
    Flattening work{scene, options};
    for (const Shape &shape : scene.shapes)
        work.boxes.push_back(shape_box(shape));
    work.flat.placement = choose_placement(scene, work.boxes);
    flatten_materials(work);
    // Textured lights need surface coordinates too, which the shapes have to know.
    for (const Emitter &emitter : scene.emitters)
        if (emitter.kind == EmitterKind::area) {
            clr_real ignored[3];
            flatten_texture(work, emitter.radiance, Rgb{0.0}, ignored);
        }
    if (work.wants("HAS_UVS") || work.wants("HAS_TANGENTS"))
        work.flat.config.HAS_UVS = 1;
    flatten_shapes(work);
    flatten_lights(work);
    flatten_camera(work);
    work.flat.frame.film_exponent = film_exponent(scene, work.flat.placement);
    apply_generality(options.generality, work.flat);
    return std::move(work.flat);
}

} // namespace clrender::inline CLR_PRECISION
