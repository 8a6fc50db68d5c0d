#include "shape_parts.h"

#include <utility>

namespace clrender::inline CLR_PRECISION {

namespace {

/// From this radius on, in the renderer's units, a rounding of the radius is larger than what is
/// seen of the scene.
constexpr double huge_radius = 64;

} // namespace

bool is_beside(const Shape &sphere, const Placement &placement, double least_radius) {
    const double radius = sphere_radius(sphere) * placement.scale;
    return radius >= least_radius &&
           glm::length(placement.exact(glm::dvec3(sphere.to_world[3]))) < 2 * radius;
}

bool is_huge(const Shape &sphere, const Placement &placement) {
    return is_beside(sphere, placement, huge_radius);
}

ShapeTest test_of(const Shape &shape, const Flattening &work) {
    switch (shape.kind) {
    case ShapeKind::sphere:
        return work.spheres_in_bvh && !is_huge(shape, work.flat.placement) ? ShapeTest::bvh_sphere
                                                                           : ShapeTest::sphere;
    case ShapeKind::rectangle:
        return work.rectangles_in_bvh ? ShapeTest::triangles : ShapeTest::planar;
    case ShapeKind::disk:
        return work.disks_in_bvh ? ShapeTest::quadric : ShapeTest::planar;
    case ShapeKind::ellipsoid:
    case ShapeKind::cylinder:
        return ShapeTest::quadric;
    case ShapeKind::mesh:
        break;
    }
    return ShapeTest::triangles;
}

bool is_inverted(const Shape &shape) {
    const bool mirrored = glm::determinant(glm::dmat3(shape.to_world)) < 0;
    return shape.flip_normals != mirrored;
}

uint append_shape(const Shape &shape, Flattening &work) {
    FlatScene &flat = work.flat;
    flat.shapes.push_back(
        {work.sides_of_bsdf.at(shape.bsdf),
         shape.emitter == none || work.is_black() ? CLR_NONE : static_cast<uint>(shape.emitter)});
    flat.attribute_places.resize(flat.shapes.size() * work.attribute_index.size());
    if (work.needs_uvs()) {
        glm::dmat3 to_local{1.0};
        if (shape.kind == ShapeKind::sphere)
            to_local = glm::inverse(glm::dmat3(shape.to_world)) * sphere_radius(shape);
        const glm::dmat3 axes = glm::transpose(to_local);
        flat.shape_frames.emplace_back();
        for (int k = 0; k < 3; ++k)
            store(flat.shape_frames.back().axis[k], axes[k]);
    }
    return static_cast<uint>(flat.shapes.size() - 1);
}

void note_hits(const Shape &shape, std::size_t first, std::vector<std::uint32_t> faces,
               Flattening &work) {
    if (work.options.first_hits)
        work.flat.hits.ranges.push_back({static_cast<std::uint32_t>(first), shape.object,
                                         shape.bsdf, shape.kind == ShapeKind::rectangle,
                                         std::move(faces)});
}

void append_lane_wise_shape(std::size_t shape, Flattening &work) {
    const int index = static_cast<int>(shape);
    work.primitive_of_shape[index] = append_shape(work.scene.shapes[shape], work);
    work.lane_wise_shapes.push_back(index);
    note_hits(work.scene.shapes[shape], work.primitive_of_shape[index], {}, work);
}

void append_no_shape(Flattening &work) {
    FlatScene &flat = work.flat;
    flat.shapes.push_back({CLR_NO_MATERIAL | CLR_NO_MATERIAL << 16, CLR_NONE});
    flat.attribute_places.resize(flat.shapes.size() * work.attribute_index.size());
    if (work.needs_uvs())
        flat.shape_frames.emplace_back();
    work.lane_wise_shapes.push_back(none);
}

const Shape &shape_of_primitive(const Flattening &work, std::size_t primitive) {
    return work.scene.shapes[static_cast<std::size_t>(work.lane_wise_shapes[primitive])];
}

} // namespace clrender::inline CLR_PRECISION
