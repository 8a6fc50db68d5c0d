/// Shapes: sphere, cylinder, rectangle, disk, cube, obj, ply, serialized; groups and instances lead
/// to mitsuba_instances.cpp.

#include "cube_mesh.h"
#include "mesh_normals.h"
#include "mitsuba_scene.h"
#include "mitsuba_text.h"
#include "mitsuba_transform.h"
#include "shape_bounds.h"
#include "similarity.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

namespace clrender::mitsuba {

namespace {

const std::vector<std::string> shape_types{"sphere",     "cylinder", "rectangle", "disk",
                                           "cube",       "obj",      "ply",       "serialized",
                                           "shapegroup", "instance"};

void extend(glm::dvec3 &lowest, glm::dvec3 &highest, const glm::dvec3 &point) {
    lowest = glm::min(lowest, point);
    highest = glm::max(highest, point);
}

} // namespace

/// The frame whose third axis is n, as Mitsuba has it (Duff et al., "Building an orthonormal basis,
/// revisited", JCGT 2017).
glm::dmat3 frame_of(const glm::dvec3 &n) {
    const double sign = std::copysign(1.0, n.z);
    const double a = -1 / (sign + n.z);
    const double b = n.x * n.y * a;
    return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

void check_thickness(const Properties &properties, const Shape &shape) {
    if (is_nearly_singular(glm::dmat3(shape.to_world)))
        throw InputError(properties.where(),
                         properties.description() +
                             " is stretched more than 1e8 times as much one way as another, "
                             "expected less");
}

void SceneReader::read_shape(int object) {
    Properties properties(document_, object);
    const std::string &type = properties.object().type;
    if (std::find(shape_types.begin(), shape_types.end(), type) == shape_types.end())
        fail_unsupported(document_, properties.object(), shape_types);
    if (type == "shapegroup") {
        read_group(object);
        return;
    }
    if (type == "instance") {
        read_instance(object);
        return;
    }

    Shape shape;
    shape.id = properties.object().id;
    shape.where = properties.where();
    shape.to_world = properties.transform("to_world");
    shape.flip_normals = properties.boolean("flip_normals", false);
    properties.ignore({"silhouette_sampling_weight"});
    if (type == "sphere") {
        read_sphere(properties, shape);
    } else if (type == "cylinder") {
        read_cylinder(properties, shape);
    } else if (type == "rectangle") {
        shape.kind = ShapeKind::rectangle;
    } else if (type == "disk") {
        shape.kind = ShapeKind::disk;
    } else {
        shape.kind = ShapeKind::mesh;
        if (type == "cube")
            shape.mesh = cube_mesh();
        else
            read_mesh_file(properties, shape);
    }
    read_surface(properties, shape);
    read_attributes_of(object, shape);
    properties.finish();
    scene_.shapes.push_back(std::move(shape));
}

void SceneReader::read_sphere(Properties &properties, Shape &shape) {
    shape.kind = ShapeKind::sphere;
    const glm::dvec3 center = properties.point("center").value_or(glm::dvec3(0));
    const double radius = properties.number("radius", 1);
    if (!(radius > 0))
        properties.fail("radius", "is not positive, expected a number above 0");
    shape.to_world = glm::scale(glm::translate(shape.to_world, center), glm::dvec3(radius));
    if (!is_similarity(glm::dmat3(shape.to_world)))
        shape.kind = ShapeKind::ellipsoid;
    check_thickness(properties, shape);
}

void SceneReader::read_cylinder(Properties &properties, Shape &shape) {
    shape.kind = ShapeKind::cylinder;
    const glm::dvec3 from = properties.point("p0").value_or(glm::dvec3(0));
    const glm::dvec3 to = properties.point("p1").value_or(glm::dvec3(0, 0, 1));
    const double radius = properties.number("radius", 1);
    if (!(radius > 0))
        properties.fail("radius", "is not positive, expected a number above 0");
    const double length = glm::length(to - from);
    if (!(length > 0))
        throw InputError(properties.where(), properties.description() +
                                                 " has no length, expected p0 and p1 that differ");
    shape.to_world *= glm::translate(glm::dmat4(1.0), from) *
                      glm::dmat4(frame_of((to - from) / length)) *
                      glm::scale(glm::dmat4(1.0), glm::dvec3(radius, radius, length));
    check_thickness(properties, shape);
}

void SceneReader::read_mesh_file(Properties &properties, Shape &shape) {
    const std::string &type = properties.object().type;
    const auto format = type == "obj"   ? MeshFormat::obj
                        : type == "ply" ? MeshFormat::ply
                                        : MeshFormat::serialized;
    MeshReadOptions options;
    options.face_normals = properties.boolean("face_normals", false);
    if (format == MeshFormat::serialized)
        options.shape_index = static_cast<int>(
            properties.integer("shape_index", 0, 0, std::numeric_limits<int>::max()));
    else
        options.flip_tex_coords = properties.boolean("flip_tex_coords", format == MeshFormat::obj);
    const std::string path = properties.file("filename");
    shapes_from_files_.push_back(scene_.shapes.size());
    shape.mesh = files_.mesh(format, path, options, properties.where("filename"));
}

void SceneReader::read_surface(Properties &properties, Shape &shape) {
    // A shape may have one light; only an area light can be one.
    const auto emitters = properties.children("emitter");
    if (emitters.size() > 1)
        throw InputError(document_.where(properties.object(), emitters[1]->line),
                         properties.description() + " has a second emitter, expected one");
    if (!emitters.empty())
        shape.emitter =
            read_area_emitter(emitters[0]->object, static_cast<int>(scene_.shapes.size()));

    const auto bsdfs = properties.children("bsdf");
    if (bsdfs.size() > 1)
        throw InputError(document_.where(properties.object(), bsdfs[1]->line),
                         properties.description() + " has a second BSDF, expected one");

    // Without a BSDF a light is black, anything else is grey.
    shape.bsdf =
        !bsdfs.empty() ? read_bsdf(bsdfs[0]->object) : default_bsdf(shape.emitter != none ? 0 : .5);
}

/// Mitsuba computes the normals of a mesh that states none after `to_world`, where reflections turn
/// them and stretching weighs the triangles differently. Such a mesh gets its own normals, in
/// object space, that become those.
void follow_transform(Shape &shape) {
    const glm::dmat3 linear(shape.to_world);
    const Mesh &mesh = *shape.mesh;
    const bool keeps_normals = is_similarity(linear) && glm::determinant(linear) > 0;
    if (keeps_normals || !mesh.has_computed_normals)
        return;

    auto placed = std::make_shared<Mesh>(mesh);
    for (glm::dvec3 &position : placed->positions)
        position = glm::dvec3(shape.to_world * glm::dvec4(position, 1));
    placed->normals = smooth_normals(*placed);
    for (glm::vec3 &normal : placed->normals)
        normal = glm::vec3(glm::normalize(glm::transpose(linear) * glm::dvec3(normal)));
    placed->positions = mesh.positions;
    shape.mesh = std::move(placed);
}

bool bounds_of(const Scene &scene, glm::dvec3 &lowest, glm::dvec3 &highest) {
    lowest = glm::dvec3(std::numeric_limits<double>::infinity());
    highest = -lowest;
    for (const Shape &shape : scene.shapes) {
        const glm::dmat4 &m = shape.to_world;
        if (shape.kind == ShapeKind::mesh) {
            for (const glm::dvec3 &position : shape.mesh->positions)
                extend(lowest, highest, glm::dvec3(m * glm::dvec4(position, 1)));
            continue;
        }

        if (shape.kind == ShapeKind::ellipsoid || shape.kind == ShapeKind::cylinder) {
            const Box box = shape_box(shape);
            extend(lowest, highest, box.low);
            extend(lowest, highest, box.high);
            continue;
        }

        // The half extent along an axis: of a box the sum of its edges, of a ball or disk the
        // length.
        const bool is_sphere = shape.kind == ShapeKind::sphere;
        glm::dvec3 half(0);
        for (int axis = 0; axis < 3; ++axis) {
            const glm::dvec3 row(m[0][axis], m[1][axis], is_sphere ? m[2][axis] : 0);
            half[axis] = shape.kind == ShapeKind::rectangle ? std::abs(row.x) + std::abs(row.y)
                                                            : glm::length(row);
        }
        extend(lowest, highest, glm::dvec3(m[3]) - half);
        extend(lowest, highest, glm::dvec3(m[3]) + half);
    }
    for (const Box &box : instance_boxes(scene)) {
        extend(lowest, highest, box.low);
        extend(lowest, highest, box.high);
    }
    return lowest.x <= highest.x;
}

} // namespace clrender::mitsuba
