#include "triangle_split.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace clrender::inline CLR_PRECISION {

namespace {

/// Edges may be so much longer than their distance from the origin, or than the unit of length.
constexpr double longest_edge = 32;
/// More halvings than lie between the largest coordinate that is traced and the unit.
constexpr int most_levels = 64;

double distance_to_segment(const glm::dvec3 &a, const glm::dvec3 &b) {
    const glm::dvec3 along = b - a;
    const double length2 = glm::dot(along, along);
    const double t = length2 > 0 ? std::clamp(-glm::dot(a, along) / length2, 0.0, 1.0) : 0;
    return glm::length(a + along * t);
}

bool is_long(double length, double distance) {
    return length > longest_edge * std::max(distance, 1.0);
}

bool edge_is_long(glm::dvec3 a, glm::dvec3 b) {
    // The order of the ends, which the two triangles at an edge see either way, must not show.
    if (std::tie(b.x, b.y, b.z) < std::tie(a.x, a.y, a.z))
        std::swap(a, b);
    return is_long(glm::length(b - a), distance_to_segment(a, b));
}

SplitVertex between(const SplitVertex &a, const SplitVertex &b) {
    return {(a.position + b.position) * 0.5, (a.weights + b.weights) * 0.5};
}

/// The point of the triangle's plane that is nearest to the origin, if it lies inside: its weights.
bool nearest_inside(const SplitTriangle &t, glm::dvec3 &weights) {
    const glm::dvec3 e1 = t[1].position - t[0].position;
    const glm::dvec3 e2 = t[2].position - t[0].position;
    const glm::dvec3 n = glm::cross(e1, e2);
    const double n2 = glm::dot(n, n);
    if (!(n2 > 0))
        return false;
    const glm::dvec3 from = -t[0].position;
    weights.y = glm::dot(glm::cross(from, e2), n) / n2;
    weights.z = glm::dot(glm::cross(e1, from), n) / n2;
    weights.x = 1 - weights.y - weights.z;
    return weights.x > 0 && weights.y > 0 && weights.z > 0;
}

void split(const SplitTriangle &t, int level, std::vector<SplitTriangle> &out);

/// Splits the triangle at a point inside, where it is too near to the origin for its size though no
/// edge is.
bool split_inside(const SplitTriangle &t, int level, std::vector<SplitTriangle> &out) {
    glm::dvec3 w;
    if (!nearest_inside(t, w))
        return false;
    SplitVertex middle;
    for (int c = 0; c < 3; ++c) {
        const SplitVertex &corner = t[static_cast<std::size_t>(c)];
        middle.position += corner.position * w[c];
        middle.weights += corner.weights * w[c];
    }
    double longest = 0;
    for (std::size_t c = 0; c < 3; ++c)
        longest = std::max(longest, glm::length(t[(c + 1) % 3].position - t[c].position));
    if (!is_long(longest, glm::length(middle.position)))
        return false;
    for (std::size_t c = 0; c < 3; ++c)
        split({middle, t[c], t[(c + 1) % 3]}, level + 1, out);
    return true;
}

/// Cuts the long edges in two, as many as there are.
void split(const SplitTriangle &t, int level, std::vector<SplitTriangle> &out) {
    std::array<bool, 3> cut{}; // the edge from corner c to the next
    int cuts = 0;
    for (std::size_t c = 0; c < 3 && level < most_levels; ++c) {
        cut[c] = edge_is_long(t[c].position, t[(c + 1) % 3].position);
        cuts += cut[c] ? 1 : 0;
    }
    if (cuts == 0) {
        if (level >= most_levels || !split_inside(t, level, out))
            out.push_back(t);
        return;
    }
    const SplitVertex ab = between(t[0], t[1]), bc = between(t[1], t[2]), ca = between(t[2], t[0]);
    if (cuts == 3) {
        split({t[0], ab, ca}, level + 1, out);
        split({ab, t[1], bc}, level + 1, out);
        split({ca, bc, t[2]}, level + 1, out);
        split({ab, bc, ca}, level + 1, out);
        return;
    }
    // Turned so that the edge from a to b is cut, and that from c to a is not.
    std::size_t first = 0;
    while (!cut[first] || cut[(first + 2) % 3])
        ++first;
    const SplitVertex &a = t[first], &b = t[(first + 1) % 3], &c = t[(first + 2) % 3];
    const SplitVertex middle = between(a, b);
    split({a, middle, c}, level + 1, out);
    if (cuts == 1) {
        split({middle, b, c}, level + 1, out);
        return;
    }
    const SplitVertex other = between(b, c);
    split({middle, b, other}, level + 1, out);
    split({middle, other, c}, level + 1, out);
}

} // namespace

bool wants_split(const std::array<Vec3, 3> &corners) {
    clr_real longest2 = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const Vec3 edge = corners[(c + 1) % 3] - corners[c];
        longest2 = std::max(longest2, glm::dot(edge, edge));
    }
    return longest2 > static_cast<clr_real>(longest_edge * longest_edge);
}

std::vector<SplitTriangle> split_triangle(const std::array<glm::dvec3, 3> &corners) {
    SplitTriangle t;
    for (std::size_t c = 0; c < 3; ++c) {
        t[c].position = corners[c];
        t[c].weights[static_cast<int>(c)] = 1;
    }
    std::vector<SplitTriangle> out;
    split(t, 0, out);
    return out;
}

} // namespace clrender::inline CLR_PRECISION
