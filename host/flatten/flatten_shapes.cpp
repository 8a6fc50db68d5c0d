#include "scene/shape_bounds.h"
#include "shape_parts.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace clrender::inline CLR_PRECISION {

namespace {

Sphere flatten_sphere(const Shape &shape, const Placement &placement) {
    Sphere s{};
    store(s.center, glm::dvec3(placement.apply(glm::dvec3(shape.to_world[3]))));
    const double radius = sphere_radius(shape) * placement.scale;
    s.radius = static_cast<clr_real>(is_inverted(shape) ? -radius : radius);
    return s;
}

/// True if no ray can start inside the sphere: it lets none through, and the camera is outside. A
/// path cannot get in without meeting the surface, unless a clip plane cuts the surface open.
bool is_opaque(const Scene &scene, const Shape &shape) {
    if (scene.sensor.near_clip || scene.integrator.kind == IntegratorKind::depth)
        return false;
    if (lets_light_through(scene, shape.bsdf) ||
        (shape.emitter != none && scene.integrator.hide_emitters))
        return false;
    const Sensor &sensor = scene.sensor;
    const glm::dvec3 way = glm::dvec3(shape.to_world[3]) - glm::dvec3(sensor.to_world[3]);
    double distance = glm::length(way);
    if (sensor.kind == SensorKind::orthographic) { // that from the film's plane
        const glm::dvec3 normal =
            glm::cross(glm::dvec3(sensor.to_world[0]), glm::dvec3(sensor.to_world[1]));
        distance = std::abs(glm::dot(way, glm::normalize(normal)));
    }
    constexpr double margin = 1.0001;
    return distance > sphere_radius(shape) * margin + sensor.aperture_radius;
}

/// Spheres from this radius on, in the renderer's units, are as large as the scene.
constexpr double large_radius = 0.5;
/// The lane-wise spheres' shapes in the order of their primitives: opaque ones first, of these
/// those that are large before the others; huge ones last.
std::vector<std::size_t> order_spheres(const Flattening &work, SceneFacts &facts) {
    const Scene &scene = work.scene;
    const Placement &placement = work.flat.placement;
    std::vector<std::size_t> order, huge;
    for (std::size_t i = 0; i < scene.shapes.size(); ++i)
        if (test_of(scene.shapes[i], work) == ShapeTest::sphere)
            (is_huge(scene.shapes[i], placement) ? huge : order).push_back(i);
    const auto others = std::stable_partition(order.begin(), order.end(), [&](std::size_t i) {
        return is_opaque(scene, scene.shapes[i]);
    });
    const auto smaller = std::stable_partition(order.begin(), others, [&](std::size_t i) {
        return is_beside(scene.shapes[i], placement, large_radius);
    });
    facts.opaque_count = static_cast<int>(others - order.begin());
    facts.large_count = static_cast<int>(smaller - order.begin());
    facts.huge_count = static_cast<int>(huge.size());
    order.insert(order.end(), huge.begin(), huge.end());
    return order;
}

void flatten_lane_wise_spheres(Flattening &work) {
    FlatScene &flat = work.flat;
    for (const std::size_t i : order_spheres(work, flat.facts)) {
        const Shape &shape = work.scene.shapes[i];
        append_lane_wise_shape(i, work);
        flat.spheres.push_back(flatten_sphere(shape, flat.placement));
    }
    if (work.wants("SPHERE_COUNT") && flat.spheres.empty()) {
        append_no_shape(work);
        flat.spheres.emplace_back();
    }
    flat.facts.sphere_count = static_cast<int>(flat.spheres.size());
}

/// The spheres that are too many to test one by one.
void flatten_bvh_spheres(Flattening &work) {
    FlatScene &flat = work.flat;
    for (std::size_t i = 0; i < work.scene.shapes.size(); ++i) {
        const Shape &shape = work.scene.shapes[i];
        if (test_of(shape, work) != ShapeTest::bvh_sphere)
            continue;
        const auto id = static_cast<uint>(flat.shape_of.size());
        flat.shape_of.push_back(append_shape(shape, work));
        note_hits(shape, flat.lane_wise_count() + id, {}, work);
        const Sphere s = flatten_sphere(shape, flat.placement);
        flat.spheres.push_back(s);
        flat.bvh_spheres.push_back(
            {{s.center[0], s.center[1], s.center[2]}, std::abs(s.radius), id});
        work.primitive_of_shape[static_cast<int>(i)] = static_cast<uint>(flat.facts.sphere_count) +
                                                       static_cast<uint>(flat.planars.size()) + id;
    }
}

/// What sphere.clh needs of a huge sphere: center / radius, and the difference of their squares
/// over twice the radius, which is negative where the normal points inwards.
struct HugeSphere {
    glm::dvec3 a{0.0};
    double h = 0;
    double radius = 0;
};

HugeSphere huge_sphere(const Shape &shape, const Flattening &work) {
    const glm::dvec3 center = work.flat.placement.exact(glm::dvec3(shape.to_world[3]));
    const double size = sphere_radius(shape) * work.flat.placement.scale;
    const double radius = is_inverted(shape) ? -size : size;
    const double distance = glm::length(center);
    return {center / radius, (distance - size) * (distance + size) / (2 * radius), radius};
}

/// What rays test of the lane-wise spheres, see SphereTest.
void make_sphere_tests(FlatScene &flat, const Flattening &work) {
    const auto spheres = static_cast<std::size_t>(flat.facts.sphere_count);
    const auto ordinary = spheres - static_cast<std::size_t>(flat.facts.huge_count);
    flat.sphere_tests.resize(2 * spheres);
    for (std::size_t i = 0; i < ordinary; ++i) {
        const Sphere &s = flat.spheres[i];
        const SphereTest test{{s.center[0], s.center[1], s.center[2]}, s.radius * s.radius};
        flat.sphere_tests[i] = flat.sphere_tests[spheres + i] = test;
    }
    for (std::size_t i = ordinary; i < spheres; ++i) {
        const HugeSphere sphere = huge_sphere(shape_of_primitive(work, i), work);
        const double sign = sphere.radius < 0 ? -1 : 1;
        store(flat.sphere_tests[i].center, sphere.a * sign);
        flat.sphere_tests[i].radius2 = static_cast<clr_real>(sphere.h * sign);
        flat.sphere_tests[spheres + i].center[0] = static_cast<clr_real>(sign / sphere.radius);
        flat.sphere_tests[spheres + i].center[1] = static_cast<clr_real>(sign * sphere.radius);
    }
}

/// What rays find of the lane-wise primitives, in their order.
void make_records(Flattening &work) {
    FlatScene &flat = work.flat;
    const auto spheres = static_cast<std::size_t>(flat.facts.sphere_count);
    make_sphere_tests(flat, work);
    for (std::size_t i = 0; i < spheres + flat.planars.size(); ++i) {
        PrimitiveRecord r{};
        if (i < spheres) {
            const bool huge = i + static_cast<std::size_t>(flat.facts.huge_count) >= spheres;
            std::copy_n(flat.spheres[i].center, 3, r.place);
            r.size = flat.spheres[i].radius;
            r.inv_size = 1 / r.size;
            if (huge) {
                const HugeSphere sphere = huge_sphere(shape_of_primitive(work, i), work);
                store(r.place, sphere.a);
                r.size = static_cast<clr_real>(sphere.h);
            }
        } else {
            const Planar &p = flat.planars[i - spheres];
            std::copy_n(p.normal, 3, r.place);
            r.size = p.distance;
            r.is_disk = p.is_disk != 0 ? CLR_NONE : 0;
            if (p.area > 0)
                store_coordinates(r, shape_of_primitive(work, i), flat.placement);
        }
        r.materials = flat.shapes[i].materials;
        r.emitter = flat.shapes[i].emitter;
        const uint front = flat.shapes[i].materials & CLR_NO_MATERIAL;
        const uint back = flat.shapes[i].materials >> 16;
        const uint material = front != CLR_NO_MATERIAL ? front : back;
        if (material != CLR_NO_MATERIAL)
            std::memcpy(r.material, &flat.materials[material], sizeof(r.material));
        flat.records.push_back(r);
    }
    // Few records lie field by field, filled up with empty ones.
    if (flat.records.size() <= CLR_TABLE_SIZE && !work.wants("RECORD_TABLE")) {
        constexpr std::size_t fields = sizeof(PrimitiveRecord) / sizeof(clr_real);
        std::vector<PrimitiveRecord> table(CLR_TABLE_SIZE);
        auto *to = reinterpret_cast<unsigned char *>(table.data());
        for (std::size_t i = 0; i < flat.records.size(); ++i)
            for (std::size_t field = 0; field < fields; ++field)
                std::memcpy(to + (field * CLR_TABLE_SIZE + i) * sizeof(clr_real),
                            reinterpret_cast<const unsigned char *>(&flat.records[i]) +
                                field * sizeof(clr_real),
                            sizeof(clr_real));
        flat.records = std::move(table);
    }
}

} // namespace

void flatten_shapes(Flattening &work) {
    FlatScene &flat = work.flat;
    const auto count = [&](auto... kinds) {
        return std::count_if(work.scene.shapes.begin(), work.scene.shapes.end(),
                             [=](const Shape &s) { return ((s.kind == kinds) || ...); });
    };
    work.spheres_in_bvh = count(ShapeKind::sphere) > few_primitives;
    work.disks_in_bvh = count(ShapeKind::disk) > few_primitives;
    const auto faces = static_cast<std::ptrdiff_t>(6 * work.cuboids.size());
    work.rectangles_in_bvh = count(ShapeKind::rectangle, ShapeKind::disk) - faces > few_primitives;

    // The order is that of the primitives' numbers: lane-wise spheres, planars, triangles,
    // spheres that are too many to test one by one, quadrics.
    flatten_lane_wise_spheres(work);
    flatten_planars(work);
    flatten_meshes(work);
    flatten_instances(work);
    flat.frame.prim_bvh_sphere =
        static_cast<uint>(flat.spheres.size() + flat.planars.size() + flat.corners.size());
    flatten_bvh_spheres(work);
    flatten_quadrics(work);

    make_records(work);
}

} // namespace clrender::inline CLR_PRECISION
