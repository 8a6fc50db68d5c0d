#pragma once
/// What the files that flatten shapes of one kind have in common.

#include "flatten_parts.h"

namespace clrender::inline CLR_PRECISION {

/// Rectangles and disks that every ray tests, and, with `rectangles_in_bvh`, disks alone.
void flatten_planars(Flattening &work, bool rectangles_in_bvh);
/// Meshes, and, with `rectangles_in_bvh`, rectangles.
void flatten_meshes(Flattening &work, bool rectangles_in_bvh);

/// The shape's entry among the shape infos, with the frame that spheres need for their (u, v).
uint append_shape(const Shape &shape, Flattening &work);
/// The shape of a sphere without a radius, or a rectangle without a normal, which no ray meets.
void append_no_shape(FlatScene &flat);
/// The shape of a lane-wise primitive.
const Shape &shape_of_primitive(const Flattening &work, std::size_t primitive);

/// True where the normal points the other way than the shape's own.
bool is_inverted(const Shape &shape);
/// PrimitiveRecord::frame of a rectangle or disk.
void store_frame(clr_real (&out)[8], const Shape &shape, const Placement &placement);
/// A vector as numbers of the flat scene's precision.
void store(clr_real (&out)[3], const glm::dvec3 &v);

} // namespace clrender::inline CLR_PRECISION
