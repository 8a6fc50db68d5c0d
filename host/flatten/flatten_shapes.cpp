#include "flatten_parts.h"
#include "log.h"
#include "scene/shape_bounds.h"
#include "shadowless_planars.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/core.h>
#include <limits>

namespace clrender::inline CLR_PRECISION {

namespace {

/// As many spheres, and as many rectangles and disks, are tested by every ray; more go into the
/// BVH.
constexpr std::ptrdiff_t few_primitives = 16;
/// Less than the precision shows of the renderer's units where the camera looks, within one of the
/// origin.
constexpr double unseen = CLR_EITHER(0x1p-22, 0x1p-51);

/// The outline of planars, for rays, is this share of their reach larger: eight units of rounding.
constexpr double planar_wider = CLR_EITHER(0x1p-21, 0x1p-50);
/// Hits nearer to it than this share are moved away from it (PLANAR_MARGIN in planar.clh).
constexpr double planar_margin = CLR_EITHER(0x1p-18, 0x1p-47);

constexpr clr_real missing = std::numeric_limits<clr_real>::quiet_NaN();

void store(clr_real (&out)[3], const glm::dvec3 &v) {
    out[0] = static_cast<clr_real>(v.x);
    out[1] = static_cast<clr_real>(v.y);
    out[2] = static_cast<clr_real>(v.z);
}

/// True where the normal points the other way than the shape's own.
bool is_inverted(const Shape &shape) {
    const bool mirrored = glm::determinant(glm::dmat3(shape.to_world)) < 0;
    return shape.flip_normals != mirrored;
}

glm::dvec3 transformed_normal(const Shape &shape, const glm::dvec3 &n) {
    const glm::dmat3 inverse_transpose = glm::transpose(glm::inverse(glm::dmat3(shape.to_world)));
    return glm::normalize(inverse_transpose * n);
}

/// The shape's entry among the shape infos, with the frame that spheres need for their (u, v).
uint append_shape(const Shape &shape, Flattening &work) {
    FlatScene &flat = work.flat;
    flat.shapes.push_back({work.sides_of_bsdf.at(shape.bsdf),
                           shape.emitter == none ? CLR_NONE : static_cast<uint>(shape.emitter)});
    if (flat.config.HAS_UVS != 0) {
        glm::dmat3 to_local{1.0};
        if (shape.kind == ShapeKind::sphere)
            to_local = glm::inverse(glm::dmat3(shape.to_world)) * sphere_radius(shape);
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column)
                flat.shape_frames.push_back(static_cast<clr_real>(to_local[column][row]));
    }
    return static_cast<uint>(flat.shapes.size() - 1);
}

/// The shape of a sphere without a radius, or a rectangle without a normal, which no ray meets.
void append_no_shape(FlatScene &flat) {
    flat.shapes.push_back({CLR_NO_MATERIAL | CLR_NO_MATERIAL << 16, CLR_NONE});
    if (flat.config.HAS_UVS != 0)
        flat.shape_frames.insert(flat.shape_frames.end(), 9, 0.0f);
}

Sphere flatten_sphere(const Shape &shape, const Placement &placement) {
    Sphere s{};
    store(s.center, glm::dvec3(placement.apply(glm::dvec3(shape.to_world[3]))));
    const double radius = sphere_radius(shape) * placement.scale;
    s.radius = static_cast<clr_real>(is_inverted(shape) ? -radius : radius);
    return s;
}

/// How far a rectangle or disk reaches from the origin, to within a factor of two.
double planar_reach(const glm::dvec3 &du, const glm::dvec3 &dv, const glm::dvec3 &origin) {
    const glm::dvec3 size = glm::abs(origin);
    return std::max({size.x, size.y, size.z}) + glm::length(du) + glm::length(dv);
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
    // The dual basis within the plane.
    const double area2 = glm::dot(across, across);
    store(p.ra, glm::cross(dv, across) / area2 / stretch_u);
    store(p.rb, glm::cross(across, du) / area2 / stretch_v);
    const glm::dvec3 half = glm::abs(du) * stretch_u + glm::abs(dv) * stretch_v;
    p.half_x = static_cast<clr_real>(half.x);
    p.half_y = static_cast<clr_real>(half.y);
    p.half_z = static_cast<clr_real>(half.z);
    return p;
}

/// PrimitiveRecord::frame of a rectangle or disk.
void store_frame(clr_real (&out)[8], const Shape &shape, const Placement &placement) {
    const glm::dvec3 du = glm::dvec3(shape.to_world[0]) * placement.scale;
    const glm::dvec3 dv = glm::dvec3(shape.to_world[1]) * placement.scale;
    const glm::dvec3 across = glm::cross(du, dv);
    const glm::dvec3 origin = placement.exact(glm::dvec3(shape.to_world[3]));
    const glm::dvec3 ra = glm::cross(dv, across) / glm::dot(across, across);
    const glm::dvec3 rb = glm::cross(across, du) / glm::dot(across, across);
    for (int c = 0; c < 3; ++c) {
        out[c] = static_cast<clr_real>(ra[c]);
        out[4 + c] = static_cast<clr_real>(rb[c]);
    }
    out[3] = static_cast<clr_real>(-glm::dot(ra, origin));
    out[7] = static_cast<clr_real>(-glm::dot(rb, origin));
}

/// The rectangle as two triangles, for scenes with many.
Mesh rectangle_mesh(bool mirrored) {
    Mesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    if (mirrored)
        mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
    else
        mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

/// What all meshes of the scene have, so that the arrays by vertex are there if any needs them.
struct VertexData {
    bool normals = false;
    bool uvs = false;
};

/// Appends a mesh's triangles to the corners, its vertex data and shape numbers to the flat scene.
void append_mesh(const Shape &shape, const Mesh &mesh, VertexData wanted, Flattening &work) {
    FlatScene &flat = work.flat;
    const uint shape_number = append_shape(shape, work);
    std::vector<Vec3> positions(mesh.positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i)
        positions[i] =
            flat.placement.apply(glm::dvec3(shape.to_world * glm::dvec4(mesh.positions[i], 1)));

    // A flipped mesh has its triangles wound the other way round.
    const std::size_t second = shape.flip_normals ? 2 : 1;
    const std::size_t third = shape.flip_normals ? 1 : 2;
    const auto first_vertex = static_cast<uint>(work.vertex_count);
    for (const auto &t : mesh.triangles) {
        flat.corners.push_back({positions[t[0]], positions[t[second]], positions[t[third]]});
        flat.shape_of.push_back(shape_number);
        if (wanted.normals || wanted.uvs)
            for (const std::size_t corner : {std::size_t{0}, second, third})
                flat.triangles.push_back(first_vertex + t[corner]);
    }
    if (wanted.normals) {
        const glm::dmat3 inverse_transpose =
            glm::transpose(glm::inverse(glm::dmat3(shape.to_world)));
        for (std::size_t i = 0; i < positions.size(); ++i) {
            Vec3 n{missing};
            if (!mesh.normals.empty())
                n = Vec3(glm::normalize(inverse_transpose * glm::dvec3(mesh.normals[i]))) *
                    clr_real{shape.flip_normals ? -1.0f : 1.0f};
            flat.normals.insert(flat.normals.end(), {n.x, n.y, n.z});
        }
    }
    if (wanted.uvs)
        for (std::size_t i = 0; i < positions.size(); ++i) {
            const Vec2 uv = mesh.uvs.empty() ? Vec2(missing) : Vec2(mesh.uvs[i]);
            flat.uvs.insert(flat.uvs.end(), {uv.x, uv.y});
        }
    work.vertex_count += positions.size();
}

/// True if no ray can start inside the sphere: it lets none through, and the camera is outside. A
/// path cannot get in without meeting the surface, unless a clip plane cuts the surface open.
bool is_solid(const Scene &scene, const Shape &shape) {
    if (scene.sensor.near_clip || scene.integrator.kind == IntegratorKind::depth)
        return false;
    const auto transmits = [&](int bsdf) {
        return bsdf != none &&
               scene.bsdfs[static_cast<std::size_t>(bsdf)].kind == BsdfKind::dielectric;
    };
    const Bsdf &bsdf = scene.bsdfs[static_cast<std::size_t>(shape.bsdf)];
    if (transmits(shape.bsdf) || transmits(bsdf.front) || transmits(bsdf.back) ||
        (shape.emitter != none && scene.integrator.hide_emitters))
        return false;
    const double distance =
        glm::length(glm::dvec3(shape.to_world[3]) - glm::dvec3(scene.sensor.to_world[3]));
    constexpr double margin = 1.0001;
    return distance > sphere_radius(shape) * margin + scene.sensor.aperture_radius;
}

/// Spheres from this radius on, in the renderer's units, are as large as the scene.
constexpr double wide_radius = 0.5;
/// From this radius on, a rounding of the radius is larger than what is seen of the scene.
constexpr double huge_radius = 64;

/// True if the sphere is large and its surface no farther from the origin than its radius.
bool is_beside(const Shape &shape, const Placement &placement, double least_radius) {
    const double radius = sphere_radius(shape) * placement.scale;
    return radius >= least_radius &&
           glm::length(placement.exact(glm::dvec3(shape.to_world[3]))) < 2 * radius;
}

/// The spheres' shapes in the order of their primitives: solid ones first, of these those that are
/// wide before the others; huge ones last. With `huge_only` no others.
std::vector<std::size_t> order_spheres(const Flattening &work, bool huge_only,
                                       KernelConfig &config) {
    const Scene &scene = work.scene;
    const Placement &placement = work.flat.placement;
    std::vector<std::size_t> order, huge;
    for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
        if (scene.shapes[i].kind != ShapeKind::sphere)
            continue;
        if (is_beside(scene.shapes[i], placement, huge_radius))
            huge.push_back(i);
        else if (!huge_only)
            order.push_back(i);
    }
    const auto others = std::stable_partition(order.begin(), order.end(), [&](std::size_t i) {
        return is_solid(scene, scene.shapes[i]);
    });
    const auto smaller = std::stable_partition(order.begin(), others, [&](std::size_t i) {
        return is_beside(scene.shapes[i], placement, wide_radius);
    });
    config.SOLID_COUNT = static_cast<int>(others - order.begin());
    config.WIDE_COUNT = static_cast<int>(smaller - order.begin());
    config.HUGE_COUNT = static_cast<int>(huge.size());
    order.insert(order.end(), huge.begin(), huge.end());
    return order;
}

/// The spheres that every ray tests: all of them, or the huge ones.
void flatten_lane_wise_spheres(Flattening &work, bool huge_only) {
    FlatScene &flat = work.flat;
    for (const std::size_t i : order_spheres(work, huge_only, flat.config)) {
        const Shape &shape = work.scene.shapes[i];
        work.primitive_of_shape[static_cast<int>(i)] = append_shape(shape, work);
        flat.spheres.push_back(flatten_sphere(shape, flat.placement));
    }
    if (work.wants("SPHERE_COUNT") && flat.spheres.empty()) {
        append_no_shape(flat);
        flat.spheres.emplace_back();
    }
    flat.config.SPHERE_COUNT = static_cast<int>(flat.spheres.size());
}

/// The spheres that are too many to test one by one.
void flatten_bvh_spheres(Flattening &work) {
    FlatScene &flat = work.flat;
    for (std::size_t i = 0; i < work.scene.shapes.size(); ++i) {
        const Shape &shape = work.scene.shapes[i];
        if (shape.kind != ShapeKind::sphere || work.primitive_of_shape.count(static_cast<int>(i)))
            continue;
        const auto id = static_cast<uint>(flat.shape_of.size());
        flat.shape_of.push_back(append_shape(shape, work));
        const Sphere s = flatten_sphere(shape, flat.placement);
        flat.spheres.push_back(s);
        flat.bvh_spheres.push_back(
            {{s.center[0], s.center[1], s.center[2]}, std::abs(s.radius), id});
        work.primitive_of_shape[static_cast<int>(i)] = static_cast<uint>(flat.config.SPHERE_COUNT) +
                                                       static_cast<uint>(flat.planars.size()) + id;
    }
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
std::vector<std::size_t> order_planars(const Flattening &work, bool rectangles_in_bvh,
                                       KernelConfig &config) {
    const Scene &scene = work.scene;
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
        const ShapeKind kind = scene.shapes[i].kind;
        if (kind == ShapeKind::disk || (kind == ShapeKind::rectangle && !rectangles_in_bvh))
            order.push_back(i);
    }
    const auto bits_of = [&](std::size_t i) {
        return axis_bits(scene.shapes[i], work.flat.placement);
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return bits_of(a) < bits_of(b); });
    if (!order.empty()) {
        const ShadowlessPlanars shadowless(scene, unseen / work.flat.placement.scale);
        const auto last = std::stable_partition(
            order.begin(), order.end(), [&](std::size_t i) { return !shadowless.contains(i); });
        config.SHADOWLESS_PLANAR_COUNT = static_cast<int>(order.end() - last);
    }
    unsigned axes = 0; // where there are more planars than bits, they are disks, and have none
    for (std::size_t i = 0; i < order.size(); ++i)
        if (const unsigned bits = bits_of(order[i]); bits != 0)
            axes |= bits << (2 * i);
    config.PLANAR_AXES = static_cast<int>(axes);
    return order;
}

void flatten_planars(Flattening &work, bool rectangles_in_bvh) {
    FlatScene &flat = work.flat;
    for (const std::size_t i : order_planars(work, rectangles_in_bvh, flat.config)) {
        const Shape &shape = work.scene.shapes[i];
        work.primitive_of_shape[static_cast<int>(i)] = append_shape(shape, work);
        flat.planars.push_back(flatten_planar(shape, flat.placement));
        if (shape.kind == ShapeKind::disk)
            flat.config.HAS_DISKS = 1;
    }
    if (work.wants("PLANAR_COUNT") && flat.planars.empty()) {
        append_no_shape(flat);
        flat.planars.emplace_back();
    }
    flat.config.PLANAR_COUNT = static_cast<int>(flat.planars.size());
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

void flatten_meshes(Flattening &work, bool rectangles_in_bvh) {
    FlatScene &flat = work.flat;
    VertexData wanted;
    wanted.uvs = flat.config.HAS_UVS != 0;
    wanted.normals = work.wants("HAS_VERTEX_NORMALS");
    for (const Shape &shape : work.scene.shapes)
        wanted.normals |= shape.kind == ShapeKind::mesh && !shape.mesh->normals.empty();
    for (std::size_t i = 0; i < work.scene.shapes.size(); ++i) {
        const Shape &shape = work.scene.shapes[i];
        const bool mirrored = glm::determinant(glm::dmat3(shape.to_world)) < 0;
        work.first_triangle_of_shape[static_cast<int>(i)] = flat.corners.size();
        if (shape.kind == ShapeKind::mesh)
            append_mesh(shape, *shape.mesh, wanted, work);
        else if (shape.kind == ShapeKind::rectangle && rectangles_in_bvh)
            append_mesh(shape, rectangle_mesh(mirrored), wanted, work);
    }
    flat.triangle_count = flat.corners.size();
    flat.config.HAS_TRIANGLES = flat.corners.empty() ? 0 : 1;
    flat.config.HAS_VERTEX_NORMALS = wanted.normals ? 1 : 0;
}

/// The shape of a lane-wise primitive.
const Shape &shape_of_primitive(const Flattening &work, std::size_t primitive) {
    const auto found = std::find_if(
        work.primitive_of_shape.begin(), work.primitive_of_shape.end(),
        [&](const auto &entry) { return entry.second == static_cast<uint>(primitive); });
    return work.scene.shapes[static_cast<std::size_t>(found->first)];
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
    const auto spheres = static_cast<std::size_t>(flat.config.SPHERE_COUNT);
    const auto ordinary = spheres - static_cast<std::size_t>(flat.config.HUGE_COUNT);
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
    const auto spheres = static_cast<std::size_t>(flat.config.SPHERE_COUNT);
    make_sphere_tests(flat, work);
    bool one_sided = true;
    for (std::size_t i = 0; i < spheres + flat.planars.size(); ++i) {
        PrimitiveRecord r{};
        if (i < spheres) {
            const bool huge = i + static_cast<std::size_t>(flat.config.HUGE_COUNT) >= spheres;
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
                store_frame(r.frame, shape_of_primitive(work, i), flat.placement);
        }
        r.materials = flat.shapes[i].materials;
        r.emitter = flat.shapes[i].emitter;
        const uint front = flat.shapes[i].materials & CLR_NO_MATERIAL;
        const uint back = flat.shapes[i].materials >> 16;
        one_sided =
            one_sided && (front == back || front == CLR_NO_MATERIAL || back == CLR_NO_MATERIAL);
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
        flat.config.RECORD_TABLE = 1;
    }
    const bool lane_wise_only = flat.shape_of.empty();
    flat.config.MATERIALS_IN_RECORDS = one_sided && lane_wise_only ? 1 : 0;
}

} // namespace

void flatten_shapes(Flattening &work) {
    FlatScene &flat = work.flat;
    const auto count = [&](auto... kinds) {
        return std::count_if(work.scene.shapes.begin(), work.scene.shapes.end(),
                             [=](const Shape &s) { return ((s.kind == kinds) || ...); });
    };
    const bool spheres_in_bvh = count(ShapeKind::sphere) > few_primitives;
    const bool rectangles_in_bvh = count(ShapeKind::rectangle, ShapeKind::disk) > few_primitives;

    // The order is that of the primitives' numbers: lane-wise spheres, planars, triangles, and
    // spheres that are too many to test one by one.
    flatten_lane_wise_spheres(work, spheres_in_bvh);
    flatten_planars(work, rectangles_in_bvh);
    flatten_meshes(work, rectangles_in_bvh);
    flat.frame.prim_bvh_sphere =
        static_cast<uint>(flat.spheres.size() + flat.planars.size() + flat.corners.size());
    if (spheres_in_bvh)
        flatten_bvh_spheres(work);

    make_records(work);
    flat.config.HAS_BVH_SPHERES = flat.bvh_spheres.empty() ? 0 : 1;
    if (flat.has_hierarchy())
        flat.config.BRUTE_FORCE = work.options.brute_force ? 1 : 0;
}

void build_hierarchy(FlatScene &flat) {
    if (!flat.has_hierarchy())
        return;
    flat.bvh = build_bvh(flat.corners, flat.bvh_spheres);
    // An empty list in place of an empty vector would keep the memory.
    flat.corners = std::vector<TriangleCorners>();
    flat.bvh_spheres = std::vector<BvhSphere>();
    flat.frame.triangle_blocks = static_cast<uint>(flat.bvh.triangle_blocks.size());
    flat.frame.sphere_blocks = static_cast<uint>(flat.bvh.sphere_blocks.size());
    if (flat.bvh.degenerate > 0)
        log::warn(
            fmt::format("{} triangles or spheres without area are left out", flat.bvh.degenerate));
}

} // namespace clrender::inline CLR_PRECISION
