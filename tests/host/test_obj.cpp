#include "files.h"

#include "scene/mesh_io.h"

#include <catch2/catch.hpp>

#include <chrono>

using namespace clrender;

namespace {

const std::string data = std::string(CLRENDER_TEST_DIR) + "/host/data/";

Mesh read_text(const std::string &text, const MeshReadOptions &options = {}) {
    const test::ScratchFolder folder;
    return read_obj_mesh(folder.file("mesh.obj", text), options);
}

double distance(const glm::vec3 &a, const glm::vec3 &b) {
    return glm::length(glm::dvec3(a - b));
}

} // namespace

TEST_CASE("an OBJ polygon becomes a fan, unused vertices vanish", "[obj]") {
    const Mesh mesh = read_obj_mesh(data + "quad.obj", {});
    REQUIRE(mesh.positions.size() == 4);
    REQUIRE(mesh.triangles.size() == 2);
    CHECK(mesh.triangles[0] == std::array<std::uint32_t, 3>{0, 1, 2});
    CHECK(mesh.triangles[1] == std::array<std::uint32_t, 3>{0, 2, 3});
    CHECK(mesh.uvs.empty());
}

TEST_CASE("smooth OBJ normals are those of Mitsuba", "[obj]") {
    // Values from Mitsuba 3.9.1 (scalar_rgb) for the same file: the two triangles' normals are
    // (0,0,1) and (1,-1,1)/sqrt(3); at corners 0 and 2 they meet with angles 45 and 60 degrees.
    const Mesh mesh = read_obj_mesh(data + "quad.obj", {});
    CHECK(distance(mesh.normals[0], {0.370482773F, -0.370482773F, 0.851754069F}) < 1e-6);
    CHECK(distance(mesh.normals[1], {0, 0, 1}) < 1e-6);
    CHECK(distance(mesh.normals[3], {0.577350259F, -0.577350259F, 0.577350259F}) < 1e-6);
    CHECK(read_obj_mesh(data + "quad.obj", {.face_normals = true}).normals.empty());
}

TEST_CASE("OBJ corners with different coordinates are different vertices", "[obj]") {
    // Vertex 3 is used with two coordinates: its smooth normals are not joined (as in Mitsuba).
    const std::string text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 1\nvt 0 0\nvt 1 0\nvt .25 .75\n"
                             "f 1/1 2/2 3/3\nf 1/1 3/2 4/1\n";
    const Mesh mesh = read_text(text);
    REQUIRE(mesh.positions.size() == 5);
    CHECK(distance(mesh.normals[2], {0, 0, 1}) < 1e-6);
    CHECK(distance(mesh.normals[3], {0.577350259F, -0.577350259F, 0.577350259F}) < 1e-6);
    CHECK(mesh.uvs[2] == glm::vec2(0.25F, 0.75F));
    CHECK(read_text(text, {.flip_tex_coords = true}).uvs[2] == glm::vec2(0.25F, 0.25F));
}

TEST_CASE("stated OBJ normals are kept, missing ones filled in", "[obj]") {
    const Mesh mesh = read_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 1\nvn 0 2 0\nvn 0 0 0\n"
                                "f 1//1 2//1 3//2\nf 1 3 4\n");
    REQUIRE(mesh.positions.size() == 6);
    CHECK(distance(mesh.normals[0], {0, 1, 0}) < 1e-6);
    CHECK(distance(mesh.normals[2], {0, 0, 1}) < 1e-6);
    CHECK(distance(mesh.normals[5], {0.577350259F, -0.577350259F, 0.577350259F}) < 1e-6);
}

TEST_CASE("OBJ text in all its legal forms", "[obj]") {
    const std::string plain = "v 0 0 0\nv 1 0 0\nv 0.5 10 0\nf 1 2 3\n";
    const Mesh expected = read_text(plain);
    for (const std::string &text :
         {std::string("v 0 0 0\r\nv 1 0 0\r\nv 0.5 10 0\r\nf 1 2 3\r\n"),
          std::string("\xEF\xBB\xBFv 0 0 0\nv 1 0 0\nv .5 1e1 -0\nf -3 -2 -1"),
          std::string("# x\n\n v\t+0 0. 0 1 # one\n  v 1 0 0 1 0.5 0.5 0.5\nv 5e-1 1E+1 1e-400\n"
                      "g a b\no c\ns off\nl 1 2\nf 1 2 3\n")}) {
        const Mesh mesh = read_text(text);
        CHECK(mesh.positions == expected.positions);
        CHECK(mesh.triangles == expected.triangles);
    }
}

TEST_CASE("degenerate OBJ triangles are kept", "[obj]") {
    const Mesh mesh = read_text("v 0 0 0\nv 1 0 0\nf 1 2 2\nf 1 1 1\n");
    CHECK(mesh.triangles.size() == 2);
    CHECK(mesh.normals[0] == glm::vec3(1, 0, 0));
}

TEST_CASE("an OBJ file splits by material", "[obj]") {
    const ObjFile file = read_obj_file(data + "materials.obj");
    REQUIRE(file.parts.size() == 3);
    CHECK(file.parts[0].material.empty());
    CHECK(file.parts[1].material == "red clay");
    CHECK(file.parts[1].mesh.triangles.size() == 2);
    CHECK(file.parts[2].mesh.positions.size() == 3);
    REQUIRE(file.materials.size() == 5);
    CHECK(file.materials[0].name == "red clay");
    CHECK(file.materials[0].diffuse == Rgb(0.8, 0.1, 0.1));
    CHECK(file.materials[1].dissolve == 0.2);
    CHECK(file.materials[1].ior == 1.33);
    CHECK(file.materials[2].emission == Rgb(4, 4, 4));
    CHECK(file.materials[3].illum == 5);
    CHECK(file.materials[4].diffuse == Rgb(0.5));
    CHECK(!file.materials[4].diffuse_map.is_there());
}

TEST_CASE("MTL errors name the MTL's line", "[obj]") {
    const test::ScratchFolder folder;
    const std::string obj =
        folder.file("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    (void)folder.file("m.mtl", "newmtl a\nKd 1 nan 0\n");
    CHECK(test::error_of([&] { read_obj_file(obj); }).find("m.mtl:2: 'nan'") != std::string::npos);
}

TEST_CASE("an OBJ of a million triangles takes seconds", "[obj]") {
    // A flat grid of 708 x 708 cells with coordinates, about 60 MB.
    constexpr int cells = 708;
    std::string text;
    for (int y = 0; y <= cells; ++y)
        for (int x = 0; x <= cells; ++x)
            text += "v " + std::to_string(x * 0.0137) + " " + std::to_string(y * 0.0137) + " 0\n";
    for (int y = 0; y < cells; ++y) {
        for (int x = 0; x < cells; ++x) {
            const std::string a = std::to_string(y * (cells + 1) + x + 1);
            const std::string b = std::to_string(y * (cells + 1) + x + 2);
            const std::string c = std::to_string((y + 1) * (cells + 1) + x + 2);
            const std::string d = std::to_string((y + 1) * (cells + 1) + x + 1);
            text += "f " + a + " " + b + " " + c + "\nf " + a + " " + c + " " + d + "\n";
        }
    }
    const auto start = std::chrono::steady_clock::now();
    const Mesh mesh = read_text(text);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    CHECK(mesh.triangles.size() == 2 * cells * cells);
    CHECK(seconds.count() < 60); // about 1 s on an idle core, without sanitizers
}

TEST_CASE("a polygon with very many corners is one or an error, at once", "[obj]") {
    std::string face = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf";
    for (int i = 0; i < 100'000; ++i)
        face += " " + std::to_string(i % 3 + 1);
    CHECK(read_text(face + "\n").triangles.size() == 99'998);
    for (int i = 0; i < 900'000; ++i)
        face += " 1";
    CHECK(test::error_of([&] { read_text(face + "\n"); }).find("mesh.obj:4: line longer") !=
          std::string::npos);
}

TEST_CASE("a line without end stops after a mebibyte", "[obj]") {
    // A sparse file of 1 GB of zero bytes.
    const test::ScratchFolder folder;
    const std::string path = folder.file("zeros.obj", "v 0 0 0\n");
    std::filesystem::resize_file(path, 1'000'000'000);
    const auto start = std::chrono::steady_clock::now();
    CHECK(test::error_of([&] { read_obj_mesh(path, {}); }).find("zeros.obj:2: line longer") !=
          std::string::npos);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    CHECK(seconds.count() < 1);
}

TEST_CASE("a mesh file that is none names who asked for it", "[obj]") {
    const test::ScratchFolder folder;
    const SourceLocation scene{"scene.xml", 7};
    const auto error = [&](const std::string &name) {
        return test::error_of([&] { read_obj_mesh(folder.path(name), {}, scene); });
    };
    CHECK(error("missing.obj").find("scene.xml:7: ") == 0);
    CHECK(error("").find("is a folder") != std::string::npos);
}
