#pragma once
/// What the files that flatten shapes of one kind have in common.

#include "flatten_parts.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace clrender::inline CLR_PRECISION {

/// As many spheres, and as many rectangles and disks beside the faces of cubes, are tested by every
/// ray; more go into the BVH.
inline constexpr std::ptrdiff_t few_primitives = 16;

/// What rays are tested against.
enum class ShapeTest {
    sphere,     ///< every ray, lane-wise
    bvh_sphere, ///< in the BVH
    planar,     ///< every ray, lane-wise
    quadric,    ///< in the BVH
    triangles,  ///< in the BVH
};

/// How a shape of the scene is tested.
ShapeTest test_of(const Shape &shape, const Flattening &work);

/// The planars that every ray tests.
void flatten_planars(Flattening &work);
/// The ellipsoids, cylinders and disks of the BVH, the last of its primitives.
void flatten_quadrics(Flattening &work);
/// What the light tree knows of a quadric that emits: how far it reaches from its center, and the
/// largest area of its projections.
struct QuadricExtent {
    glm::dvec3 half{0.0};
    double projected_area = 0;
};
QuadricExtent quadric_extent(const Quadric &quadric);
/// What becomes triangles.
void flatten_meshes(Flattening &work);
/// The triangles of a mesh or a rectangle, in the coordinates of `placement`.
void append_triangles(const Shape &shape, const Placement &placement, Flattening &work);

/// A vertex that splitting a mesh's triangle adds, behind the mesh's own.
struct AddedVertex {
    std::array<std::uint32_t, 3> parent; ///< corners of the mesh's triangle
    glm::dvec3 weights;
};

/// What became of a mesh in the flat scene.
struct PlacedMesh {
    uint shape = 0;                     ///< its entry among the shape infos
    uint first_vertex = 0;              ///< number of its first vertex among the scene's
    uint first_triangle = 0;            ///< likewise
    std::vector<AddedVertex> added;     ///< the vertices behind its own
    std::vector<std::uint32_t> sources; ///< by triangle of the flat scene: that of the mesh
};
/// Appends the attributes of a mesh that its shape shows.
void append_attributes(const Shape &shape, const PlacedMesh &placed, Flattening &work);

/// Notes whose the primitives from `first` on are, where layers ask for it.
void note_hits(const Shape &shape, std::size_t first, std::vector<std::uint32_t> faces,
               Flattening &work);
/// The shape's entry among the shape infos, with the frame that spheres need for their (u, v).
uint append_shape(const Shape &shape, Flattening &work);
/// The same of the next lane-wise primitive, which has the number of its entry.
void append_lane_wise_shape(std::size_t shape, Flattening &work);
/// A lane-wise primitive that no ray meets: a sphere without a radius, a rectangle without a
/// normal.
void append_no_shape(Flattening &work);
/// The shape of a lane-wise primitive that has one.
const Shape &shape_of_primitive(const Flattening &work, std::size_t primitive);

/// True if the sphere is large and its surface no farther from the origin than its radius.
bool is_beside(const Shape &sphere, const Placement &placement, double least_radius);
/// The same of one that is tested by its curvature (sphere.clh), and in no BVH.
bool is_huge(const Shape &sphere, const Placement &placement);

/// True where the normal points the other way than the shape's own.
bool is_inverted(const Shape &shape);
/// PrimitiveRecord::to_a and to_b of a rectangle or disk.
void store_coordinates(PrimitiveRecord &out, const Shape &shape, const Placement &placement);

} // namespace clrender::inline CLR_PRECISION
