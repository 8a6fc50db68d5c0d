#include "mesh_normals.h"

#include <algorithm>
#include <cmath>

namespace clrender {

namespace {

/// The angle between two vectors in [0, pi], accurate also near 0 and pi; 0 for a zero vector.
double angle_between(const glm::dvec3 &a, const glm::dvec3 &b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

} // namespace

std::vector<glm::vec3> smooth_normals(const Mesh &mesh) {
    std::vector<glm::dvec3> sums(mesh.positions.size(), glm::dvec3(0.0));
    for (const auto &triangle : mesh.triangles) {
        // Scaled to the longest side, so that neither tiny nor huge meshes leave the range.
        const glm::dvec3 &p0 = mesh.positions[triangle[0]];
        glm::dvec3 side1 = mesh.positions[triangle[1]] - p0;
        glm::dvec3 side2 = mesh.positions[triangle[2]] - p0;
        const double extent = std::max({std::abs(side1.x), std::abs(side1.y), std::abs(side1.z),
                                        std::abs(side2.x), std::abs(side2.y), std::abs(side2.z)});
        if (!(extent > 0))
            continue;
        side1 /= extent;
        side2 /= extent;
        const glm::dvec3 scaled_normal = glm::cross(side1, side2);
        const double length = glm::length(scaled_normal);
        if (!(length > 0))
            continue;

        // Each corner's share is its angle.
        const glm::dvec3 normal = scaled_normal / length;
        const glm::dvec3 side3 = side2 - side1;
        sums[triangle[0]] += normal * angle_between(side1, side2);
        sums[triangle[1]] += normal * angle_between(side3, -side1);
        sums[triangle[2]] += normal * angle_between(-side2, -side3);
    }

    std::vector<glm::vec3> normals(sums.size());
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const double length = glm::length(sums[i]);
        normals[i] = length > 0 ? glm::vec3(sums[i] / length) : glm::vec3(1, 0, 0);
    }
    return normals;
}

void complete_normals(Mesh &mesh) {
    const auto is_missing = [](const glm::vec3 &n) { return n == glm::vec3(0.0F); };
    if (std::all_of(mesh.normals.begin(), mesh.normals.end(), is_missing)) {
        mesh.normals = smooth_normals(mesh);
        mesh.has_computed_normals = true;
        return;
    }
    if (std::none_of(mesh.normals.begin(), mesh.normals.end(), is_missing))
        return;
    const std::vector<glm::vec3> smooth = smooth_normals(mesh);
    for (std::size_t i = 0; i < smooth.size(); ++i)
        if (is_missing(mesh.normals[i]))
            mesh.normals[i] = smooth[i];
}

void set_normals(Mesh &mesh, bool face_normals) {
    if (face_normals)
        mesh.normals.clear();
    else
        complete_normals(mesh);
}

} // namespace clrender
