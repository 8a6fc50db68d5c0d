#include "cuboids.h"

#include "scene/cube_mesh.h"
#include "shape_parts.h"

#include <algorithm>
#include <cmath>

namespace clrender::inline CLR_PRECISION {

namespace {

/// As many cubes are tested faster one by one than in a tree.
constexpr std::ptrdiff_t few_cubes = 8;

/// A face of the cube [-1,1]^3: half of its edges along u and v, and its outward normal.
struct Face {
    glm::dvec3 u, v, normal;
};

/// In the order of CuboidFaces, with the coordinates of cube_mesh().
constexpr std::array<Face, 6> faces{{
    {{0, 1, 0}, {0, 0, 1}, {-1, 0, 0}},
    {{0, 1, 0}, {0, 0, -1}, {1, 0, 0}},
    {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},
    {{-1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
    {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}},
    {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
}};

/// True if the axes are at right angles, to the precision of matrices in files.
bool is_right_angled(const glm::dmat4 &to_world) {
    constexpr double aslant = 1e-6;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 a(to_world[k]), b(to_world[(k + 1) % 3]);
        if (!(std::abs(glm::dot(a, b)) <= aslant * glm::length(a) * glm::length(b)))
            return false;
    }
    return true;
}

/// Cubes that let light through stay triangles: what they stand on is met before or behind their
/// own face by rounding alone, and as triangles they are nearer to other renderers there.
bool is_cuboid(const Scene &scene, const Shape &shape) {
    return !lets_light_through(scene, shape.bsdf) && shape.kind == ShapeKind::mesh &&
           shape.mesh == cube_mesh() && shape.emitter == none && shape.attribute_textures.empty() &&
           is_right_angled(shape.to_world);
}

Shape face_of(const Shape &cube, const Face &face) {
    Shape shape = cube;
    shape.kind = ShapeKind::rectangle;
    shape.mesh = nullptr;
    const glm::dmat4 place{glm::dvec4(face.u, 0), glm::dvec4(face.v, 0), glm::dvec4(face.normal, 0),
                           glm::dvec4(face.normal, 1)};
    shape.to_world = cube.to_world * place;
    return shape;
}

} // namespace

std::optional<SceneOfFaces> cubes_as_faces(const Scene &scene) {
    const auto count = [&](const auto &test) {
        return std::count_if(scene.shapes.begin(), scene.shapes.end(), test);
    };
    const auto is_cube = [&](const Shape &s) { return is_cuboid(scene, s); };
    const auto is_sphere = [](const Shape &s) { return s.kind == ShapeKind::sphere; };
    const auto is_planar = [](const Shape &s) {
        return s.kind == ShapeKind::rectangle || s.kind == ShapeKind::disk;
    };
    const std::ptrdiff_t cubes = count(is_cube), spheres = count(is_sphere);
    const std::ptrdiff_t planars = count(is_planar);
    const auto all = static_cast<std::ptrdiff_t>(scene.shapes.size());
    if (cubes == 0 || cubes > few_cubes || spheres > few_primitives || planars > few_primitives ||
        cubes + spheres + planars < all || !scene.instances.empty())
        return std::nullopt;
    SceneOfFaces result{scene, {}};
    std::vector<Shape> &shapes = result.scene.shapes;
    for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
        if (!is_cube(scene.shapes[i]))
            continue;
        CuboidFaces at{};
        for (std::size_t f = 0; f < faces.size(); ++f) {
            at[f] = f == 0 ? i : shapes.size();
            if (f > 0)
                shapes.emplace_back();
            shapes[at[f]] = face_of(scene.shapes[i], faces[f]);
        }
        result.cuboids.push_back(at);
    }
    return result;
}

} // namespace clrender::inline CLR_PRECISION
