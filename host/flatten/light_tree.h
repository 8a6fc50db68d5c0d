#pragma once
/// The tree by which light sampling chooses among many lights (kernels/light_tree.clh walks it).

#include "shared/scene_data.h"

#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace clrender::inline CLR_PRECISION {

/// What the tree has to know of a light, in the renderer's coordinates.
struct LightExtent {
    glm::dvec3 lower{0.0}, upper{0.0}; ///< box around all points that emit; of a distant light the
                                       ///< unit vector towards it
    glm::dvec3 axis{0.0, 0.0, 1.0};    ///< of the cone that holds the normals
    double cosine = -1;                ///< of the cone's half angle; -1: shines all around
    double intensity = 0; ///< largest radiant intensity in any direction, luminance; of a distant
                          ///< light its irradiance
    bool is_beam = false; ///< shines within the cone alone
    bool is_distant = false; ///< infinitely far away
};

/// `trail[i]` leads to light i: bit k is the child taken at level k.
struct LightTree {
    std::vector<LightNode> nodes;
    std::vector<uint> trail;
};

/// A tree over at least two lights, split where the surface-area orientation heuristic says
/// (Conty Estevez and Kulla, "Importance sampling of many lights with adaptive tree splitting",
/// 2018, equation 2), at most CLR_LIGHT_TREE_LEVELS deep.
LightTree build_light_tree(std::span<const LightExtent> lights);

} // namespace clrender::inline CLR_PRECISION
