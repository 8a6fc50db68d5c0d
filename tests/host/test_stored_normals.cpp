/// Which way the normals of a mesh point under a `to_world` that mirrors: stated ones keep to their
/// side (they go through the inverse transpose), others follow the order of the transformed
/// vertices, inwards. Mitsuba 3.9.1 renders all of these so.

#include "mitsuba_text_scene.h"
#include "stderr_of.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

using namespace clrender;

namespace {

/// The tetrahedron of four corners of the cube, each face with vertices of its own, outside first.
struct Tetrahedron {
    std::vector<glm::dvec3> positions, normals;
};

Tetrahedron tetrahedron(bool is_smooth) {
    const glm::dvec3 c[4] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    Tetrahedron all;
    for (const auto &face : {glm::ivec3(0, 1, 2), {0, 3, 1}, {0, 2, 3}, {1, 3, 2}})
        for (int i = 0; i < 3; ++i) {
            const glm::dvec3 middle = c[face[0]] + c[face[1]] + c[face[2]];
            all.positions.push_back(c[face[i]]);
            all.normals.push_back(is_smooth ? c[face[i]] : middle);
        }
    return all;
}

/// The lines of the normals are there in any case; whether the faces name them is another matter.
std::string as_obj(const Tetrahedron &mesh, bool with_normals) {
    std::string text;
    for (std::size_t i = 0; i < 12; ++i) {
        const glm::dvec3 &p = mesh.positions[i];
        const glm::dvec3 &n = mesh.normals[i];
        text += fmt::format("v {} {} {}\nvn {} {} {}\n", p.x, p.y, p.z, n.x, n.y, n.z);
    }
    for (int i = 1; i < 12; i += 3)
        text += with_normals ? fmt::format("f {0}//{0} {1}//{1} {2}//{2}\n", i, i + 1, i + 2)
                             : fmt::format("f {} {} {}\n", i, i + 1, i + 2);
    return text;
}

std::string as_ply(const Tetrahedron &mesh, const std::string &normal_type) {
    std::string text = "ply\nformat ascii 1.0\nelement vertex 12\nproperty float x\n"
                       "property float y\nproperty float z\n";
    for (const char *name : {"nx", "ny", "nz"})
        if (!normal_type.empty())
            text += "property " + normal_type + " " + name + "\n";
    text += "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
    for (std::size_t i = 0; i < 12; ++i) {
        const glm::dvec3 &p = mesh.positions[i];
        const glm::dvec3 &n = mesh.normals[i];
        text += fmt::format("{} {} {}", p.x, p.y, p.z);
        text += normal_type.empty() ? "\n" : fmt::format(" {} {} {}\n", n.x, n.y, n.z);
    }
    return text + "3 0 1 2\n3 3 4 5\n3 6 7 8\n3 9 10 11\n";
}

/// 1 if all world normals point away from the middle, -1 if all point towards it, else 0.
int side_of_normals(const Shape &shape) {
    const glm::dmat3 linear(shape.to_world);
    const glm::dmat3 to_normal = glm::transpose(glm::inverse(linear));
    const Mesh &mesh = *shape.mesh;
    int outward = 0;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        outward +=
            glm::dot(to_normal * glm::dvec3(mesh.normals.at(i)), linear * mesh.positions[i]) > 0
                ? 1
                : 0;
    return outward == 12 ? 1 : outward == 0 ? -1 : 0;
}

Shape load_placed(const std::string &type, const std::string &bytes, const std::string &scale,
                  const std::string &more = "") {
    const test::ScratchFolder folder;
    (void)folder.file("m." + type, bytes);
    const std::string scene =
        folder.file("s.xml", "<scene version=\"3.0.0\"><shape type=\"" + type +
                                 "\"><string name=\"filename\" value=\"m." + type + "\"/>" + more +
                                 "<transform name=\"to_world\"><scale " + scale +
                                 "/></transform></shape></scene>");
    Shape shape;
    test::stderr_of([&] { shape = test::load(scene).shapes.at(0); });
    return shape;
}

} // namespace

TEST_CASE("stated normals keep their side under a mirror, computed ones do not", "[normals]") {
    for (const bool is_smooth : {false, true}) {
        const Tetrahedron mesh = tetrahedron(is_smooth);
        for (const char *scale :
             {"x='1'", "x='-1'", "x='-1' y='2'", "value='-3'", "y='3' z='-.5'"}) {
            CAPTURE(is_smooth, scale);
            const bool is_mirrored = std::string(scale).find('-') != std::string::npos;
            CHECK(side_of_normals(load_placed("obj", as_obj(mesh, true), scale)) == 1);
            for (const char *type : {"float", "double", "char", "int"})
                CHECK(side_of_normals(load_placed("ply", as_ply(mesh, type), scale)) == 1);
            const int computed = is_mirrored ? -1 : 1;
            CHECK(side_of_normals(load_placed("obj", as_obj(mesh, false), scale)) == computed);
            CHECK(side_of_normals(load_placed("ply", as_ply(mesh, ""), scale)) == computed);
        }
    }
}

TEST_CASE("face_normals drops stated normals, so that the mesh turns with its vertices",
          "[normals]") {
    const Tetrahedron mesh = tetrahedron(false);
    const std::string flag = "<boolean name=\"face_normals\" value=\"true\"/>";
    CHECK(load_placed("obj", as_obj(mesh, true), "x='-1'", flag).mesh->normals.empty());
    CHECK(load_placed("ply", as_ply(mesh, "float"), "x='-1'", flag).mesh->normals.empty());
}
