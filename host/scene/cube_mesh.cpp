#include "cube_mesh.h"

namespace clrender {

namespace {

/// A face: its corner at (u, v) = (0, 0) and the edges along u and v.
struct Face {
    glm::dvec3 corner, u, v;
};

Mesh make_cube() {
    const std::array<Face, 6> faces{{
        {{-1, -1, -1}, {0, 0, 2}, {2, 0, 0}}, // -y
        {{1, 1, 1}, {-2, 0, 0}, {0, 0, -2}},  // +y
        {{1, -1, 1}, {0, 2, 0}, {0, 0, -2}},  // +x
        {{-1, -1, 1}, {0, 2, 0}, {2, 0, 0}},  // +z
        {{-1, -1, -1}, {0, 2, 0}, {0, 0, 2}}, // -x
        {{-1, 1, -1}, {0, -2, 0}, {2, 0, 0}}, // -z
    }};

    // The corners of each face in the order (0,1) (1,1) (1,0) (0,0) of their (u, v).
    Mesh mesh;
    for (const Face &face : faces) {
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        const glm::vec3 normal(glm::normalize(glm::cross(face.v, face.u)));
        for (const glm::vec2 uv :
             {glm::vec2(0, 1), glm::vec2(1, 1), glm::vec2(1, 0), glm::vec2(0, 0)}) {
            mesh.positions.push_back(face.corner + static_cast<double>(uv.x) * face.u +
                                     static_cast<double>(uv.y) * face.v);
            mesh.normals.push_back(normal);
            mesh.uvs.push_back(uv);
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first + 3, first, first + 2});
    }
    return mesh;
}

} // namespace

std::shared_ptr<const Mesh> cube_mesh() {
    static const auto mesh = std::make_shared<const Mesh>(make_cube());
    return mesh;
}

} // namespace clrender
