#pragma once
/// The meshes that bench_traversal traces.

#include <array>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace clrender::bench {

using Triangles = std::vector<std::array<glm::vec3, 3>>;

/// `name` is an OBJ file, or SHAPE:COUNT for about COUNT triangles of one of the shapes of
/// scenes/generator. Moved and scaled into [-1, 1]^3, as the renderer does. Throws
/// std::runtime_error or std::invalid_argument.
Triangles load_mesh(const std::string &name);

} // namespace clrender::bench
