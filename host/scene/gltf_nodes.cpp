#include "gltf_nodes.h"

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

namespace clrender::gltf {

namespace {

/// The numbers of a property of `count`, or none where it is absent.
const double *numbers(const Document &document, const std::vector<double> &values,
                      std::size_t count, const char *name, const std::string &place) {
    if (values.empty())
        return nullptr;
    if (values.size() != count)
        throw document.error(place, std::string(name) + " has " + std::to_string(values.size()) +
                                        " numbers, expected " + std::to_string(count));
    return values.data();
}

glm::dmat4 own_matrix(const Document &document, const tinygltf::Node &node,
                      const std::string &place) {
    if (const double *m = numbers(document, node.matrix, 16, "matrix", place)) {
        glm::dmat4 matrix(1.0);
        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 4; ++row)
                matrix[column][row] = m[4 * column + row];
        if (matrix[0][3] != 0 || matrix[1][3] != 0 || matrix[2][3] != 0 || matrix[3][3] != 1)
            throw document.error(place, "the last row of its matrix is not 0 0 0 1");
        return matrix;
    }
    glm::dmat4 matrix(1.0);
    if (const double *t = numbers(document, node.translation, 3, "translation", place))
        matrix = glm::translate(matrix, glm::dvec3(t[0], t[1], t[2]));
    if (const double *r = numbers(document, node.rotation, 4, "rotation", place)) {
        const double length = std::hypot(std::hypot(r[0], r[1]), std::hypot(r[2], r[3]));
        if (!(length > 0 && std::isfinite(length)))
            throw document.error(place, "rotation has no length, expected a unit quaternion");
        matrix *=
            glm::mat4_cast(glm::dquat(r[3] / length, r[0] / length, r[1] / length, r[2] / length));
    }
    if (const double *s = numbers(document, node.scale, 3, "scale", place))
        matrix = glm::scale(matrix, glm::dvec3(s[0], s[1], s[2]));
    return matrix;
}

bool is_finite(const glm::dmat4 &m) {
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            if (!(std::abs(m[column][row]) <= 1e30))
                return false;
    return true;
}

std::vector<int> roots_of(const Document &document) {
    const tinygltf::Model &model = document.model;
    if (!model.scenes.empty())
        return element(document, model.scenes, std::max(model.defaultScene, 0), "scene", "scene")
            .nodes;
    std::vector<bool> is_child(model.nodes.size(), false);
    for (const tinygltf::Node &node : model.nodes)
        for (const int child : node.children)
            if (child >= 0 && static_cast<std::size_t>(child) < is_child.size())
                is_child[static_cast<std::size_t>(child)] = true;
    std::vector<int> roots;
    for (std::size_t i = 0; i < is_child.size(); ++i)
        if (!is_child[i])
            roots.push_back(static_cast<int>(i));
    return roots;
}

} // namespace

std::vector<PlacedNode> placed_nodes(const Document &document) {
    struct Open {
        int node;
        glm::dmat4 parent;
    };
    std::vector<Open> open;
    const auto open_all = [&open](const std::vector<int> &nodes, const glm::dmat4 &parent) {
        std::transform(nodes.rbegin(), nodes.rend(), std::back_inserter(open), [&](int node) {
            return Open{node, parent};
        });
    };
    open_all(roots_of(document), glm::dmat4(1.0));
    std::vector<PlacedNode> placed;
    std::vector<bool> seen(document.model.nodes.size(), false);
    while (!open.empty()) {
        const Open at = open.back();
        open.pop_back();
        const std::string place = place_of("nodes", at.node);
        const tinygltf::Node &node =
            element(document, document.model.nodes, at.node, "node", "scene");
        if (seen[static_cast<std::size_t>(at.node)])
            throw document.error(place, "is reached twice, expected nodes that are trees");
        seen[static_cast<std::size_t>(at.node)] = true;
        const PlacedNode here{&node, at.node, at.parent * own_matrix(document, node, place)};
        if (!is_finite(here.to_world))
            throw document.error(place, "its place is not finite, expected numbers up to 1e+30");
        open_all(node.children, here.to_world);
        placed.push_back(here);
    }
    if (document.has_animations)
        document.warn("animations", "are ignored");
    return placed;
}

} // namespace clrender::gltf
