#include "shape_parts.h"
#include "triangle_split.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace clrender::inline CLR_PRECISION {

namespace {

constexpr clr_real missing = std::numeric_limits<clr_real>::quiet_NaN();

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
    bool attributes = false;

    [[nodiscard]] bool any() const { return normals || uvs || attributes; }
};

glm::dvec3 corner_uv(const Mesh &mesh, std::uint32_t vertex, int corner) {
    // A mesh without coordinates has the barycentrics of its triangles.
    if (mesh.uvs.empty())
        return {corner == 1 ? 1 : 0, corner == 2 ? 1 : 0, 0};
    return {mesh.uvs[vertex], 0};
}

/// Appends the triangles that a huge one is split into.
void append_split(const std::array<std::uint32_t, 3> &parent,
                  const std::array<glm::dvec3, 3> &corners, uint first_added, bool by_vertex,
                  std::vector<AddedVertex> &added, FlatScene &flat) {
    for (const SplitTriangle &part : split_triangle(corners)) {
        flat.corners.push_back(
            {Vec3(part[0].position), Vec3(part[1].position), Vec3(part[2].position)});
        for (const SplitVertex &vertex : part) {
            if (!by_vertex)
                continue;
            flat.triangles.push_back(first_added + static_cast<uint>(added.size()));
            added.push_back({parent, vertex.weights});
        }
    }
}

/// Normals and coordinates of the vertices: the mesh's own, then the added ones, between those of
/// their parents' corners.
void append_vertex_data(const Shape &shape, const Mesh &mesh, const std::vector<AddedVertex> &added,
                        VertexData wanted, FlatScene &flat) {
    const std::size_t own = mesh.positions.size();
    if (wanted.normals) {
        const glm::dmat3 inverse_transpose =
            glm::transpose(glm::inverse(glm::dmat3(shape.to_world)));
        const auto normal_of = [&](std::uint32_t vertex) {
            return glm::normalize(inverse_transpose * glm::dvec3(mesh.normals[vertex])) *
                   (shape.flip_normals ? -1.0 : 1.0);
        };
        for (std::size_t i = 0; i < own + added.size(); ++i) {
            Vec3 n{missing};
            if (!mesh.normals.empty() && i < own) {
                n = Vec3(normal_of(static_cast<std::uint32_t>(i)));
            } else if (!mesh.normals.empty()) {
                const auto &[parent, w] = added[i - own];
                n = Vec3(normal_of(parent[0]) * w.x + normal_of(parent[1]) * w.y +
                         normal_of(parent[2]) * w.z);
            }
            flat.normals.insert(flat.normals.end(), {n.x, n.y, n.z});
        }
    }
    if (!wanted.uvs)
        return;
    for (std::size_t i = 0; i < own; ++i) {
        const Vec2 uv = mesh.uvs.empty() ? Vec2(missing) : Vec2(mesh.uvs[i]);
        flat.uvs.insert(flat.uvs.end(), {uv.x, uv.y});
    }
    for (const auto &[parent, w] : added) {
        const glm::dvec3 uv = corner_uv(mesh, parent[0], 0) * w.x +
                              corner_uv(mesh, parent[1], 1) * w.y +
                              corner_uv(mesh, parent[2], 2) * w.z;
        flat.uvs.insert(flat.uvs.end(), {static_cast<clr_real>(uv.x), static_cast<clr_real>(uv.y)});
    }
}

/// Appends a mesh's triangles to the corners, its vertex data and shape numbers to the flat scene.
void append_mesh(const Shape &shape, const Mesh &mesh, const Placement &placement,
                 VertexData wanted, Flattening &work) {
    FlatScene &flat = work.flat;
    PlacedMesh placed;
    placed.shape = append_shape(shape, work);
    const auto exact = [&](std::uint32_t vertex) {
        return placement.exact(glm::dvec3(shape.to_world * glm::dvec4(mesh.positions[vertex], 1)));
    };
    std::vector<Vec3> positions(mesh.positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i)
        positions[i] = Vec3(exact(static_cast<std::uint32_t>(i)));

    // A flipped mesh has its triangles wound the other way round.
    const std::size_t second = shape.flip_normals ? 2 : 1;
    const std::size_t third = shape.flip_normals ? 1 : 2;
    placed.first_vertex = static_cast<uint>(work.vertex_count);
    placed.first_triangle = static_cast<uint>(flat.corners.size());
    const auto first_added = placed.first_vertex + static_cast<uint>(positions.size());
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const std::array<std::uint32_t, 3> &t = mesh.triangles[i];
        const std::array<std::uint32_t, 3> turned = {t[0], t[second], t[third]};
        const TriangleCorners corners = {positions[turned[0]], positions[turned[1]],
                                         positions[turned[2]]};
        if (wants_split(corners)) {
            append_split(turned, {exact(turned[0]), exact(turned[1]), exact(turned[2])},
                         first_added, wanted.any(), placed.added, flat);
        } else {
            flat.corners.push_back(corners);
            for (const std::uint32_t vertex : turned)
                if (wanted.any())
                    flat.triangles.push_back(placed.first_vertex + vertex);
        }
        if (!shape.attribute_textures.empty() || work.options.first_hits)
            placed.sources.resize(flat.corners.size() - placed.first_triangle, i);
    }
    flat.shape_of.resize(flat.corners.size(), placed.shape);
    append_vertex_data(shape, mesh, placed.added, wanted, flat);
    append_attributes(shape, placed, work);
    if (placed.sources.size() == mesh.triangles.size())
        placed.sources.clear(); // none was split
    note_hits(shape, flat.lane_wise_count() + placed.first_triangle, std::move(placed.sources),
              work);
    work.vertex_count += positions.size() + placed.added.size();
}

} // namespace

void append_triangles(const Shape &shape, const Placement &placement, Flattening &work) {
    VertexData wanted;
    wanted.normals = work.vertex_normals;
    wanted.uvs = work.needs_uvs();
    wanted.attributes = !work.attribute_index.empty();
    const bool mirrored = glm::determinant(glm::dmat3(shape.to_world)) < 0;
    if (shape.mesh)
        append_mesh(shape, *shape.mesh, placement, wanted, work);
    else
        append_mesh(shape, rectangle_mesh(mirrored), placement, wanted, work);
}

void flatten_meshes(Flattening &work) {
    FlatScene &flat = work.flat;
    const auto has_normals = [](const Shape &shape) {
        return shape.kind == ShapeKind::mesh && !shape.mesh->normals.empty();
    };
    const auto any_has_normals = [&](const std::vector<Shape> &shapes) {
        return std::any_of(shapes.begin(), shapes.end(), has_normals);
    };
    work.vertex_normals =
        work.wants("HAS_VERTEX_NORMALS") || any_has_normals(work.scene.shapes) ||
        std::any_of(work.scene.groups.begin(), work.scene.groups.end(),
                    [&](const ShapeGroup &group) { return any_has_normals(group.shapes); });
    for (std::size_t i = 0; i < work.scene.shapes.size(); ++i) {
        const Shape &shape = work.scene.shapes[i];
        TriangleRange &range = work.triangles_of_shape[static_cast<int>(i)];
        range.first = flat.corners.size();
        if (test_of(shape, work) == ShapeTest::triangles)
            append_triangles(shape, flat.placement, work);
        range.count = flat.corners.size() - range.first;
    }
}

} // namespace clrender::inline CLR_PRECISION
