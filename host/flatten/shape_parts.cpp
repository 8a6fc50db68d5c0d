#include "shape_parts.h"

namespace clrender::inline CLR_PRECISION {

bool is_inverted(const Shape &shape) {
    const bool mirrored = glm::determinant(glm::dmat3(shape.to_world)) < 0;
    return shape.flip_normals != mirrored;
}

uint append_shape(const Shape &shape, Flattening &work) {
    FlatScene &flat = work.flat;
    flat.shapes.push_back({work.sides_of_bsdf.at(shape.bsdf),
                           shape.emitter == none ? CLR_NONE : static_cast<uint>(shape.emitter)});
    if (work.needs_uvs()) {
        glm::dmat3 to_local{1.0};
        if (shape.kind == ShapeKind::sphere)
            to_local = glm::inverse(glm::dmat3(shape.to_world)) * sphere_radius(shape);
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column)
                flat.shape_frames.push_back(static_cast<clr_real>(to_local[column][row]));
    }
    return static_cast<uint>(flat.shapes.size() - 1);
}

void append_lane_wise_shape(std::size_t shape, Flattening &work) {
    const int index = static_cast<int>(shape);
    work.primitive_of_shape[index] = append_shape(work.scene.shapes[shape], work);
    work.lane_wise_shapes.push_back(index);
}

void append_no_shape(Flattening &work) {
    FlatScene &flat = work.flat;
    flat.shapes.push_back({CLR_NO_MATERIAL | CLR_NO_MATERIAL << 16, CLR_NONE});
    if (work.needs_uvs())
        flat.shape_frames.insert(flat.shape_frames.end(), 9, 0.0f);
    work.lane_wise_shapes.push_back(none);
}

const Shape &shape_of_primitive(const Flattening &work, std::size_t primitive) {
    return work.scene.shapes[static_cast<std::size_t>(work.lane_wise_shapes[primitive])];
}

} // namespace clrender::inline CLR_PRECISION
