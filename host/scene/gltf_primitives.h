#pragma once
/// Primitives of glTF meshes: triangles with what their vertices have.

#include "gltf_accessors.h"
#include "gltf_surfaces.h"

#include <map>
#include <string>
#include <vector>

namespace clrender::gltf {

/// The triangles of a primitive, before its material is known.
struct Primitive {
    int material = -1;
    Mesh mesh;                            ///< positions, normals and triangles
    std::map<int, Numbers> coordinates;   ///< TEXCOORD_<n>
    Numbers colors;                       ///< COLOR_0: three or four, or none
    std::vector<Numbers> joints, weights; ///< JOINTS_<n>, WEIGHTS_<n>, of skinned ones
    std::string place;
};

/// Reads a primitive; one without triangles (points, lines, no POSITION) is warned of. Throws
/// InputError.
Primitive read_primitive(const Document &document, const tinygltf::Primitive &source,
                         const std::string &place, bool is_skinned = false);

/// A mesh and its surface.
struct SurfacedMesh {
    std::shared_ptr<const Mesh> mesh;
    Surface surface;
};

/// Gives a primitive its surface: the vertices get what that asks for. Where it has a normal map,
/// triangles whose (u, v) are mirrored are a mesh of their own.
std::vector<SurfacedMesh> surfaced(const Document &document, Primitive primitive,
                                   SurfaceMaker &surfaces);

} // namespace clrender::gltf
