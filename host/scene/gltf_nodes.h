#pragma once
/// The nodes of a glTF scene in their places.

#include "gltf_document.h"

#include <glm/glm.hpp>

#include <vector>

namespace clrender::gltf {

/// A node that shows something, and its place in the world.
struct PlacedNode {
    const tinygltf::Node *node = nullptr;
    int index = -1;
    glm::dmat4 to_world{1.0};
};

/// The nodes of the default scene, else of the first, else all, each before its children.
/// Animations are warned of. Throws InputError where the nodes are no trees.
std::vector<PlacedNode> placed_nodes(const Document &document);

} // namespace clrender::gltf
