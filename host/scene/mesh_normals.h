#pragma once
/// Smooth vertex normals for meshes that come without.

#include "scene.h"

namespace clrender {

/// Unit vertex normals: the sum of the unit normals of the adjacent triangles, each weighted by
/// its angle at the vertex (Thürmer and Wüthrich 1998, "Computing Vertex Normals from Polygonal
/// Facets"), over the mesh's own indices: vertices that share a place but not an index are not
/// joined. Triangles without area add nothing; a vertex without a normal gets (1, 0, 0).
std::vector<glm::vec3> smooth_normals(const Mesh &mesh);

/// Gives `mesh` the normals that Mitsuba gives it. Where `normals` is empty, or has a zero vector
/// (the file states none or one without a direction), the smooth ones are filled in; the mesh notes
/// whether it has no others.
void complete_normals(Mesh &mesh);

/// As complete_normals, or takes all normals away where the shape asks for flat faces.
void set_normals(Mesh &mesh, bool face_normals);

} // namespace clrender
