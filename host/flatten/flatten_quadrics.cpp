#include "shape_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace clrender::inline CLR_PRECISION {

namespace {

/// The outline of cylinders and disks, for rays, is this share of their reach larger, and hits
/// nearer to it than the other are moved away from it: as for planars.
constexpr double quadric_wider = CLR_EITHER(0x1p-21, 0x1p-50);
constexpr double quadric_margin = CLR_EITHER(0x1p-18, 0x1p-47);
/// Boxes are so much larger, beyond the rounding of their corners.
constexpr double box_wider = CLR_EITHER(0x1p-22, 0x1p-51);

/// A quadric in the renderer's coordinates: its points are center + axes * p, with p on the unit
/// sphere, on the cylinder x^2 + y^2 = 1, |z| <= 1, or on the unit disk in z = 0, where axes[2] is
/// the unit normal.
struct PlacedQuadric {
    uint kind = CLR_QUADRIC_ELLIPSOID;
    glm::dvec3 center{0.0};
    glm::dmat3 axes{1.0};
};

PlacedQuadric placed_quadric(const Shape &shape, const Placement &placement) {
    PlacedQuadric q;
    q.center = placement.exact(glm::dvec3(shape.to_world[3]));
    q.axes = glm::dmat3(shape.to_world) * placement.scale;
    if (shape.kind == ShapeKind::cylinder) {
        q.kind = CLR_QUADRIC_CYLINDER;
        q.center = placement.exact(glm::dvec3(shape.to_world * glm::dvec4(0, 0, 0.5, 1)));
        q.axes[2] *= 0.5;
    } else if (shape.kind == ShapeKind::disk) {
        q.kind = CLR_QUADRIC_DISK;
        q.axes[2] = glm::normalize(glm::cross(q.axes[0], q.axes[1]));
        if (glm::dot(q.axes[2], glm::dmat3(shape.to_world)[2]) < 0)
            q.axes[2] = -q.axes[2];
    }
    return q;
}

/// How far it reaches from the center along the coordinate axes.
glm::dvec3 half_box(const PlacedQuadric &q) {
    glm::dvec3 half(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        const double x = q.axes[0][axis], y = q.axes[1][axis], z = q.axes[2][axis];
        half[axis] = std::hypot(x, y, q.kind == CLR_QUADRIC_ELLIPSOID ? z : 0) +
                     (q.kind == CLR_QUADRIC_CYLINDER ? std::abs(z) : 0);
    }
    return half;
}

double largest(const glm::dvec3 &v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// The record of shared/quadric.h. The rows of the map are those of the inverse of `axes`, scaled
/// so that the longest of those that are round together has length 1; a cylinder's z by itself.
Quadric make_quadric(const PlacedQuadric &q, bool inverted) {
    const glm::dmat3 rows = glm::transpose(glm::inverse(q.axes));
    double longest = std::max(glm::length(rows[0]), glm::length(rows[1]));
    if (q.kind == CLR_QUADRIC_ELLIPSOID)
        longest = std::max(longest, glm::length(rows[2]));
    const double radius = 1 / longest;
    const double half_length = 1 / glm::length(rows[2]);
    const bool has_height = q.kind == CLR_QUADRIC_CYLINDER;
    const double scale_z = q.kind == CLR_QUADRIC_ELLIPSOID ? radius : has_height ? half_length : 1;
    const glm::dvec3 scale(radius, radius, scale_z);
    const double margin =
        quadric_margin * (largest(q.center) + glm::length(q.axes[0]) + glm::length(q.axes[1]) +
                          (has_height ? glm::length(q.axes[2]) : 0));
    const double rim = has_height ? half_length : radius;

    Quadric result{};
    store(result.center, q.center);
    result.kind = q.kind;
    store(result.x, rows[0] * scale.x);
    store(result.y, rows[1] * scale.y);
    store(result.z, rows[2] * scale.z);
    store(result.from_x, q.axes[0] / scale.x);
    store(result.from_y, q.axes[1] / scale.y);
    store(result.from_z, q.axes[2] / scale.z);
    result.radius = static_cast<clr_real>(radius);
    result.half_length = static_cast<clr_real>(half_length);
    result.volume =
        static_cast<clr_real>(std::abs(glm::determinant(q.axes)) / (scale.x * scale.y * scale.z));
    result.orientation = inverted ? -1.0f : 1.0f;
    result.rim = static_cast<clr_real>(std::max(rim - margin, 0.0));
    return result;
}

BvhQuadric make_bvh_quadric(const PlacedQuadric &q, const Quadric &record, uint prim) {
    const auto vector = [](const clr_real(&v)[3]) { return Vec3(v[0], v[1], v[2]); };
    BvhQuadric result;
    result.center = vector(record.center);
    result.rows = {vector(record.x), vector(record.y), vector(record.z)};
    result.kind = q.kind;
    result.prim = prim;
    const glm::dvec3 half = half_box(q);
    const double reach = largest(q.center) + largest(half);
    const double wider = quadric_wider * reach;
    result.radius = record.radius;
    result.half_length = std::numeric_limits<clr_real>::infinity();
    if (q.kind == CLR_QUADRIC_CYLINDER)
        result.half_length = static_cast<clr_real>(double{record.half_length} + wider);
    if (q.kind == CLR_QUADRIC_DISK)
        result.radius = static_cast<clr_real>(double{record.radius} + wider);
    const double outline = q.kind == CLR_QUADRIC_ELLIPSOID ? 0 : 2 * wider;
    const glm::dvec3 around = half + outline + box_wider * reach;
    result.lower = Vec3(q.center - around);
    result.upper = Vec3(q.center + around);
    return result;
}

/// The quadric as its record has it, rounded to float32: both precisions then see the same.
PlacedQuadric as_single(const Quadric &record) {
    const auto vector = [](const clr_real(&v)[3]) {
        return glm::dvec3(glm::vec3(v[0], v[1], v[2]));
    };
    const auto number = [](clr_real v) { return double{static_cast<float>(v)}; };
    PlacedQuadric q;
    q.kind = static_cast<uint>(record.kind);
    q.axes[0] = vector(record.from_x) * number(record.radius);
    q.axes[1] = vector(record.from_y) * number(record.radius);
    q.axes[2] = vector(record.from_z) *
                number(q.kind == CLR_QUADRIC_CYLINDER ? record.half_length : record.radius);
    return q;
}

} // namespace

QuadricExtent quadric_extent(const Quadric &quadric) {
    const PlacedQuadric q = as_single(quadric);
    const glm::dvec3 xy = glm::cross(q.axes[0], q.axes[1]);
    const glm::dvec3 yz = glm::cross(q.axes[1], q.axes[2]);
    const glm::dvec3 zx = glm::cross(q.axes[2], q.axes[0]);
    QuadricExtent extent;
    extent.half = half_box(q);
    switch (q.kind) {
    case CLR_QUADRIC_CYLINDER: // that of the parallelogram between two lines of the wall
        extent.projected_area = 4 * largest_stretch(glm::dmat3(yz, zx, glm::dvec3(0.0)));
        break;
    case CLR_QUADRIC_DISK:
        extent.projected_area = M_PI * glm::length(xy);
        break;
    default: // of an ellipsoid pi |(xy . w, yz . w, zx . w)| along w
        extent.projected_area = M_PI * largest_stretch(glm::dmat3(xy, yz, zx));
    }
    return extent;
}

void flatten_quadrics(Flattening &work) {
    FlatScene &flat = work.flat;
    const auto first = static_cast<uint>(flat.lane_wise_count());
    flat.frame.prim_quadric = first + static_cast<uint>(flat.shape_of.size());
    for (std::size_t i = 0; i < work.scene.shapes.size(); ++i) {
        const Shape &shape = work.scene.shapes[i];
        if (test_of(shape, work) != ShapeTest::quadric)
            continue;
        const auto id = static_cast<uint>(flat.shape_of.size());
        flat.shape_of.push_back(append_shape(shape, work));
        const PlacedQuadric placed = placed_quadric(shape, flat.placement);
        const bool inverted =
            shape.kind == ShapeKind::ellipsoid ? is_inverted(shape) : shape.flip_normals;
        flat.quadrics.push_back(make_quadric(placed, inverted));
        flat.bvh_quadrics.push_back(make_bvh_quadric(placed, flat.quadrics.back(), id));
        work.primitive_of_shape[static_cast<int>(i)] = first + id;
        note_hits(shape, first + id, {}, work);
    }
    if (work.wants("HAS_QUADRICS") && flat.quadrics.empty())
        flat.quadrics.emplace_back();
}

} // namespace clrender::inline CLR_PRECISION
