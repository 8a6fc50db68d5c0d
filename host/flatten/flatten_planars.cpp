#include "shadowless_planars.h"
#include "shape_parts.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace clrender::inline CLR_PRECISION {

namespace {

/// Less than the precision shows of the renderer's units where the camera looks, within one of the
/// origin.
constexpr double unseen = CLR_EITHER(0x1p-22, 0x1p-51);
/// The outline of planars, for rays, is this share of their reach larger: eight units of rounding.
constexpr double planar_wider = CLR_EITHER(0x1p-21, 0x1p-50);
/// Hits nearer to it than this share are moved away from it (PLANAR_MARGIN in planar.clh).
constexpr double planar_margin = CLR_EITHER(0x1p-18, 0x1p-47);

glm::dvec3 transformed_normal(const Shape &shape, const glm::dvec3 &n) {
    const glm::dmat3 inverse_transpose = glm::transpose(glm::inverse(glm::dmat3(shape.to_world)));
    return glm::normalize(inverse_transpose * n);
}

/// How far a rectangle or disk reaches from the origin, to within a factor of two.
double planar_reach(const glm::dvec3 &du, const glm::dvec3 &dv, const glm::dvec3 &origin) {
    const glm::dvec3 size = glm::abs(origin);
    return std::max({size.x, size.y, size.z}) + glm::length(du) + glm::length(dv);
}

/// The vectors of the plane of du and dv with ra . du = rb . dv = 1, ra . dv = rb . du = 0.
struct DualBasis {
    glm::dvec3 ra, rb;
};

DualBasis dual_basis(const glm::dvec3 &du, const glm::dvec3 &dv) {
    const glm::dvec3 across = glm::cross(du, dv);
    const double area2 = glm::dot(across, across);
    return {glm::cross(dv, across) / area2, glm::cross(across, du) / area2};
}

Planar flatten_planar(const Shape &shape, const Placement &placement) {
    Planar p{};
    const double scale = placement.scale;
    const glm::dvec3 du = glm::dvec3(shape.to_world[0]) * scale;
    const glm::dvec3 dv = glm::dvec3(shape.to_world[1]) * scale;
    const glm::dvec3 across = glm::cross(du, dv);
    glm::dvec3 normal = transformed_normal(shape, {0, 0, 1});
    if (shape.flip_normals)
        normal = -normal;
    p.is_disk = shape.kind == ShapeKind::disk ? 1 : 0;
    p.area = static_cast<clr_real>(glm::length(across) * (p.is_disk != 0 ? M_PI : 4));
    const glm::dvec3 origin = placement.exact(glm::dvec3(shape.to_world[3]));
    store(p.origin, origin);
    store(p.normal, normal);
    p.distance = static_cast<clr_real>(glm::dot(normal, origin));
    store(p.du, du);
    store(p.dv, dv);
    // The outline that rays are tested against is larger by what the test may lose to rounding.
    const double wider = planar_wider * planar_reach(du, dv, origin);
    const double stretch_u = 1 + wider / glm::length(du);
    const double stretch_v = 1 + wider / glm::length(dv);
    const DualBasis dual = dual_basis(du, dv);
    store(p.ra, dual.ra / stretch_u);
    store(p.rb, dual.rb / stretch_v);
    const glm::dvec3 half = glm::abs(du) * stretch_u + glm::abs(dv) * stretch_v;
    p.half_x = static_cast<clr_real>(half.x);
    p.half_y = static_cast<clr_real>(half.y);
    p.half_z = static_cast<clr_real>(half.z);
    return p;
}

/// The axes are the normals of the faces on their positive sides; each face's middle lies on its
/// plane.
Cuboid flatten_cuboid(const Scene &scene, const CuboidFaces &faces, const Placement &placement) {
    Cuboid cuboid{};
    for (std::size_t k = 0; k < 3; ++k) {
        const Shape &face = scene.shapes[faces[2 * k + 1]];
        const auto middle_of = [&](std::size_t shape) {
            return placement.exact(glm::dvec3(scene.shapes[shape].to_world[3]));
        };
        const glm::dvec3 axis = transformed_normal(face, {0, 0, 1});
        const double high = glm::dot(axis, middle_of(faces[2 * k + 1]));
        const double low = glm::dot(axis, middle_of(faces[2 * k]));
        store(cuboid.axis[k], axis);
        cuboid.middle[k] = static_cast<clr_real>((high + low) / 2);
        cuboid.half_size[k] = static_cast<clr_real>((high - low) / 2);
        const Shape &first = scene.shapes[faces[0]];
        cuboid.slack = static_cast<clr_real>(
            planar_wider * planar_reach(glm::dvec3(first.to_world[0]) * placement.scale,
                                        glm::dvec3(first.to_world[1]) * placement.scale,
                                        middle_of(faces[0])));
    }
    return cuboid;
}

/// The axis that the vector, in the renderer's units, lies along, 0 to 2, or none.
int axis_of(const glm::dvec3 &v) {
    constexpr double aslant = 2e-7; // matrices in files are rotations by float32
    const glm::dvec3 size = glm::abs(v);
    for (int axis = 0; axis < 3; ++axis)
        if (std::max(size[(axis + 1) % 3], size[(axis + 2) % 3]) <=
            std::min(aslant * size[axis], unseen))
            return axis;
    return none;
}

/// The two bits of PLANAR_AXES.
unsigned axis_bits(const Shape &shape, const Placement &placement) {
    const int u = axis_of(glm::dvec3(shape.to_world[0]) * placement.scale);
    const int v = axis_of(glm::dvec3(shape.to_world[1]) * placement.scale);
    if (shape.kind != ShapeKind::rectangle || u == none || v == none || u == v)
        return 0;
    const int across = 3 - u - v;
    return static_cast<unsigned>(across) + 1;
}

/// The planars' shapes behind the faces of cuboids, in the order of their primitives: those that
/// cast no shadows last, and for each kind of test one after the other, so that like scenes need
/// the same kernel.
std::vector<std::size_t> order_planars(const Flattening &work, SceneFacts &facts) {
    const Scene &scene = work.scene;
    std::vector<std::size_t> order;
    std::set<std::size_t> faces;
    for (const CuboidFaces &cuboid : work.cuboids)
        faces.insert(cuboid.begin(), cuboid.end());
    for (std::size_t i = 0; i < scene.shapes.size(); ++i)
        if (test_of(scene.shapes[i], work) == ShapeTest::planar && faces.count(i) == 0)
            order.push_back(i);
    const auto bits_of = [&](std::size_t i) {
        return axis_bits(scene.shapes[i], work.flat.placement);
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return bits_of(a) < bits_of(b); });
    if (!order.empty()) {
        const ShadowlessPlanars shadowless(scene, unseen / work.flat.placement.scale);
        const auto last = std::stable_partition(
            order.begin(), order.end(), [&](std::size_t i) { return !shadowless.contains(i); });
        facts.shadowless_count = static_cast<int>(order.end() - last);
    }
    unsigned axes = 0; // where there are more planars than bits, they are disks, and have none
    for (std::size_t i = 0; i < order.size(); ++i)
        if (const unsigned bits = bits_of(order[i]); bits != 0)
            axes |= bits << (2 * i);
    facts.planar_axes = static_cast<int>(axes);
    return order;
}

} // namespace

void store_coordinates(PrimitiveRecord &out, const Shape &shape, const Placement &placement) {
    const DualBasis dual = dual_basis(glm::dvec3(shape.to_world[0]) * placement.scale,
                                      glm::dvec3(shape.to_world[1]) * placement.scale);
    const glm::dvec3 origin = placement.exact(glm::dvec3(shape.to_world[3]));
    for (int c = 0; c < 3; ++c) {
        out.to_a[c] = static_cast<clr_real>(dual.ra[c]);
        out.to_b[c] = static_cast<clr_real>(dual.rb[c]);
    }
    out.to_a[3] = static_cast<clr_real>(-glm::dot(dual.ra, origin));
    out.to_b[3] = static_cast<clr_real>(-glm::dot(dual.rb, origin));
}

void flatten_planars(Flattening &work) {
    FlatScene &flat = work.flat;
    std::vector<std::size_t> order;
    for (const CuboidFaces &faces : work.cuboids) {
        flat.cuboids.push_back(flatten_cuboid(work.scene, faces, flat.placement));
        order.insert(order.end(), faces.begin(), faces.end());
    }
    const std::vector<std::size_t> others = order_planars(work, flat.facts);
    order.insert(order.end(), others.begin(), others.end());
    for (const std::size_t i : order) {
        const Shape &shape = work.scene.shapes[i];
        append_lane_wise_shape(i, work);
        flat.planars.push_back(flatten_planar(shape, flat.placement));
    }
    if (work.wants("PLANAR_COUNT") && flat.planars.empty()) {
        append_no_shape(work);
        flat.planars.emplace_back();
    }
    // Up to these coordinates no planar's hits are near its outline.
    double rim = 1;
    for (const Planar &p : flat.planars) {
        const glm::dvec3 du(p.du[0], p.du[1], p.du[2]);
        const glm::dvec3 dv(p.dv[0], p.dv[1], p.dv[2]);
        const double margin =
            planar_margin * planar_reach(du, dv, {p.origin[0], p.origin[1], p.origin[2]});
        if (p.area > 0)
            rim = std::min(rim, 1 - margin / std::min(glm::length(du), glm::length(dv)));
    }
    flat.frame.planar_rim = static_cast<clr_real>(std::max(rim, 0.0));
}

} // namespace clrender::inline CLR_PRECISION
