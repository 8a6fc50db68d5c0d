#pragma once
/// Skins of glTF meshes, in the pose that the nodes of the file have.

#include "gltf_nodes.h"
#include "gltf_primitives.h"

#include <map>

namespace clrender::gltf {

/// Moves the vertices of a primitive with its joints, to where they are in the world; the place of
/// the mesh's own node does not count (glTF 2.0, section 3.7.3.1). `nodes` are the places of all
/// nodes of the scene. Throws InputError.
void apply_skin(const Document &document, int skin, const std::map<int, glm::dmat4> &nodes,
                Primitive &primitive);

} // namespace clrender::gltf
