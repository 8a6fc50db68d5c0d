#include "shadowless_planars.h"
#include "shape_parts.h"

#include <algorithm>
#include <cmath>

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

/// The planars' shapes in the order of their primitives: those that cast no shadows last, and for
/// each kind of test one after the other, so that like scenes need the same kernel.
std::vector<std::size_t> order_planars(const Flattening &work, SceneFacts &facts) {
    const Scene &scene = work.scene;
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < scene.shapes.size(); ++i)
        if (test_of(scene.shapes[i], work) == ShapeTest::planar)
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
    for (const std::size_t i : order_planars(work, flat.facts)) {
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
