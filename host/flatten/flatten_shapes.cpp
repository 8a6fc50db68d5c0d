#include "flatten_parts.h"
#include "log.h"
#include "shadowless_planars.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/core.h>
#include <limits>

namespace clrender {

namespace {

/// As many spheres, and as many rectangles and disks, are tested by every ray; more go into the
/// BVH.
constexpr std::ptrdiff_t few_primitives = 16;
/// Less than float32 shows of the renderer's units where the camera looks, within one of the
/// origin.
constexpr double unseen = 0x1p-22;

constexpr float missing = std::numeric_limits<float>::quiet_NaN();

void store(float (&out)[3], const glm::dvec3 &v) {
    out[0] = static_cast<float>(v.x);
    out[1] = static_cast<float>(v.y);
    out[2] = static_cast<float>(v.z);
}

double sphere_radius(const Shape &shape) {
    return std::cbrt(std::abs(glm::determinant(glm::dmat3(shape.to_world))));
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
                flat.shape_frames.push_back(static_cast<float>(to_local[column][row]));
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
    s.radius = static_cast<float>(is_inverted(shape) ? -radius : radius);
    return s;
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
    p.area = static_cast<float>(glm::length(across) * (p.is_disk != 0 ? M_PI : 4));
    store(p.origin, glm::dvec3(placement.apply(glm::dvec3(shape.to_world[3]))));
    store(p.normal, normal);
    store(p.du, du);
    store(p.dv, dv);
    // The dual basis within the plane.
    const double area2 = glm::dot(across, across);
    store(p.ra, glm::cross(dv, across) / area2);
    store(p.rb, glm::cross(across, du) / area2);
    const glm::dvec3 half = glm::abs(du) + glm::abs(dv);
    p.half_x = static_cast<float>(half.x);
    p.half_y = static_cast<float>(half.y);
    p.half_z = static_cast<float>(half.z);
    return p;
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
    std::vector<glm::vec3> positions(mesh.positions.size());
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
            glm::vec3 n{missing};
            if (!mesh.normals.empty())
                n = glm::vec3(glm::normalize(inverse_transpose * glm::dvec3(mesh.normals[i]))) *
                    (shape.flip_normals ? -1.0f : 1.0f);
            flat.normals.insert(flat.normals.end(), {n.x, n.y, n.z});
        }
    }
    if (wanted.uvs)
        for (std::size_t i = 0; i < positions.size(); ++i) {
            const glm::vec2 uv = mesh.uvs.empty() ? glm::vec2(missing) : mesh.uvs[i];
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

/// Spheres from this radius on, in the renderer's units, are as large as what the camera is near
/// to.
constexpr double wide_radius = 0.5;

/// The spheres' shapes in the order of their primitives: solid ones first, of these those that are
/// wide before the others.
std::vector<std::size_t> order_spheres(const Flattening &work, KernelConfig &config) {
    const Scene &scene = work.scene;
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < scene.shapes.size(); ++i)
        if (scene.shapes[i].kind == ShapeKind::sphere)
            order.push_back(i);
    const auto others = std::stable_partition(order.begin(), order.end(), [&](std::size_t i) {
        return is_solid(scene, scene.shapes[i]);
    });
    const auto smaller = std::stable_partition(order.begin(), others, [&](std::size_t i) {
        return sphere_radius(scene.shapes[i]) * work.flat.placement.scale >= wide_radius;
    });
    config.SOLID_COUNT = static_cast<int>(others - order.begin());
    config.WIDE_COUNT = static_cast<int>(smaller - order.begin());
    return order;
}

void flatten_spheres(Flattening &work, bool in_bvh) {
    FlatScene &flat = work.flat;
    const std::vector<std::size_t> order = order_spheres(work, flat.config);
    if (in_bvh)
        flat.config.SOLID_COUNT = flat.config.WIDE_COUNT = 0;
    for (const std::size_t i : order) {
        const Shape &shape = work.scene.shapes[i];
        const uint shape_number = append_shape(shape, work);
        const Sphere s = flatten_sphere(shape, flat.placement);
        flat.spheres.push_back(s);
        uint primitive = shape_number;
        if (in_bvh) {
            const auto id = static_cast<uint>(flat.shape_of.size());
            flat.shape_of.push_back(shape_number);
            flat.bvh_spheres.push_back(
                {{s.center[0], s.center[1], s.center[2]}, std::abs(s.radius), id});
            primitive = static_cast<uint>(flat.config.SPHERE_COUNT) +
                        static_cast<uint>(flat.planars.size()) + id;
        }
        work.primitive_of_shape[static_cast<int>(i)] = primitive;
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

/// What rays test and find of the lane-wise primitives, in their order.
void make_records(Flattening &work) {
    FlatScene &flat = work.flat;
    const auto spheres = static_cast<std::size_t>(flat.config.SPHERE_COUNT);
    for (std::size_t i = 0; i < 2 * spheres; ++i) {
        const Sphere &s = flat.spheres[i % spheres];
        flat.sphere_tests.push_back({{s.center[0], s.center[1], s.center[2]}, s.radius * s.radius});
    }
    bool one_sided = true;
    for (std::size_t i = 0; i < spheres + flat.planars.size(); ++i) {
        PrimitiveRecord r{};
        if (i < spheres) {
            std::copy_n(flat.spheres[i].center, 3, r.place);
            r.size = flat.spheres[i].radius;
            r.inv_size = 1 / r.size;
        } else {
            const Planar &p = flat.planars[i - spheres];
            std::copy_n(p.normal, 3, r.place);
            for (int c = 0; c < 3; ++c)
                r.size += p.normal[c] * p.origin[c];
            r.is_disk = p.is_disk != 0 ? CLR_NONE : 0;
        }
        r.materials = flat.shapes[i].materials;
        r.emitter = flat.shapes[i].emitter;
        const uint front = r.materials & CLR_NO_MATERIAL;
        const uint back = r.materials >> 16;
        one_sided =
            one_sided && (front == back || front == CLR_NO_MATERIAL || back == CLR_NO_MATERIAL);
        const uint material = front != CLR_NO_MATERIAL ? front : back;
        if (material != CLR_NO_MATERIAL)
            std::memcpy(r.material, &flat.materials[material], sizeof(r.material));
        flat.records.push_back(r);
    }
    // Few records lie field by field, filled up with empty ones.
    if (flat.records.size() <= CLR_TABLE_SIZE && !work.wants("RECORD_TABLE")) {
        constexpr std::size_t fields = sizeof(PrimitiveRecord) / sizeof(float);
        std::vector<PrimitiveRecord> table(CLR_TABLE_SIZE);
        auto *to = reinterpret_cast<unsigned char *>(table.data());
        for (std::size_t i = 0; i < flat.records.size(); ++i)
            for (std::size_t field = 0; field < fields; ++field)
                std::memcpy(to + (field * CLR_TABLE_SIZE + i) * sizeof(float),
                            reinterpret_cast<const unsigned char *>(&flat.records[i]) +
                                field * sizeof(float),
                            sizeof(float));
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
    if (!spheres_in_bvh)
        flatten_spheres(work, false);
    if (work.wants("SPHERE_COUNT") && flat.spheres.empty()) {
        append_no_shape(flat);
        flat.spheres.emplace_back();
    }
    flat.config.SPHERE_COUNT = static_cast<int>(flat.spheres.size());
    flatten_planars(work, rectangles_in_bvh);
    flatten_meshes(work, rectangles_in_bvh);
    flat.frame.prim_bvh_sphere =
        static_cast<uint>(flat.spheres.size() + flat.planars.size() + flat.corners.size());
    if (spheres_in_bvh)
        flatten_spheres(work, true);

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

} // namespace clrender
