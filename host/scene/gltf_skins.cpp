#include "gltf_skins.h"

#include <fmt/format.h>

#include <string>
#include <vector>

namespace clrender::gltf {

namespace {

/// Where each joint takes a vertex of the mesh.
std::vector<glm::dmat4> joint_matrices(const Document &document, int index,
                                       const std::map<int, glm::dmat4> &nodes) {
    const std::string place = place_of("skins", index);
    const tinygltf::Skin &skin = element(document, document.model.skins, index, "skin", "nodes");
    Numbers inverse;
    if (skin.inverseBindMatrices >= 0)
        inverse = read_numbers(document, skin.inverseBindMatrices, 16, 16, place);
    if (!inverse.values.empty() && inverse.count() < skin.joints.size())
        throw document.error(place, fmt::format("{} inverse bind matrices for {} joints",
                                                inverse.count(), skin.joints.size()));
    std::vector<glm::dmat4> matrices;
    for (std::size_t i = 0; i < skin.joints.size(); ++i) {
        const auto node = nodes.find(skin.joints[i]);
        if (node == nodes.end())
            throw document.error(place, fmt::format("node {} is no part of the scene, expected a "
                                                    "joint",
                                                    skin.joints[i]));
        glm::dmat4 bind(1.0);
        if (!inverse.values.empty())
            for (int column = 0; column < 4; ++column)
                for (int row = 0; row < 4; ++row)
                    bind[column][row] =
                        inverse.values[16 * i + static_cast<std::size_t>(4 * column + row)];
        matrices.push_back(node->second * bind);
    }
    return matrices;
}

} // namespace

void apply_skin(const Document &document, int skin, const std::map<int, glm::dmat4> &nodes,
                Primitive &primitive) {
    const std::vector<glm::dmat4> matrices = joint_matrices(document, skin, nodes);
    Mesh &mesh = primitive.mesh;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        glm::dmat4 sum(0.0);
        double weights = 0;
        for (std::size_t set = 0; set < primitive.joints.size(); ++set)
            for (std::size_t k = 4 * i; k < 4 * i + 4; ++k) {
                const double weight = primitive.weights[set].values[k];
                const float joint = primitive.joints[set].values[k];
                if (weight == 0)
                    continue;
                if (!(joint >= 0 && joint < static_cast<float>(matrices.size())))
                    throw document.error(primitive.place,
                                         fmt::format("joint {:g}, of {}", joint, matrices.size()));
                sum += weight * matrices[static_cast<std::size_t>(joint)];
                weights += weight;
            }
        if (!(weights > 0))
            throw document.error(primitive.place,
                                 fmt::format("vertex {} has no weight, expected joints that move "
                                             "it",
                                             i));
        sum /= weights;
        mesh.positions[i] = glm::dvec3(sum * glm::dvec4(mesh.positions[i], 1));
        if (!(glm::length(mesh.positions[i]) <= 1e30))
            throw document.error(primitive.place,
                                 fmt::format("joints take vertex {} to infinity", i));
        if (mesh.normals.empty())
            continue;
        // Cofactors: the inverse transpose times the determinant, also where there is no inverse.
        const glm::dmat3 m(sum);
        const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]),
                                   glm::cross(m[0], m[1]));
        const glm::dvec3 normal = cofactors * glm::dvec3(mesh.normals[i]);
        const double length = glm::length(normal);
        if (length > 0)
            mesh.normals[i] = glm::vec3(normal / length);
    }
}

} // namespace clrender::gltf
