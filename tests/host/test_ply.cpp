#include "files.h"
#include "stderr_of.h"

#include "scene/mesh_io.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstring>

using namespace clrender;

namespace {

const std::string vertex_header = "element vertex 4\nproperty float x\nproperty float y\n"
                                  "property float z\n";
const std::string face_header = "element face 1\nproperty list uchar int vertex_indices\n";
const std::string places = "0 0 0\n1 0 0\n1 1 0\n0 1 1\n";

Mesh read_bytes(const std::string &bytes, const MeshReadOptions &options = {}) {
    const test::ScratchFolder folder;
    return read_ply_mesh(folder.file("mesh.ply", bytes), options);
}

/// Appends the bytes of a value in either order.
template <class T> void append(std::string &bytes, T value, bool big_endian) {
    std::string raw(sizeof(T), '\0');
    std::memcpy(raw.data(), &value, sizeof(T));
    if (big_endian)
        std::reverse(raw.begin(), raw.end());
    bytes += raw;
}

/// The quad of the tests with double places, a list and a colour to skip, and 16-bit indices.
std::string binary_quad(bool big_endian) {
    std::string bytes = std::string("ply\r\nformat binary_") + (big_endian ? "big" : "little") +
                        "_endian 1.0\r\ncomment made by hand\r\nelement vertex 4\r\n"
                        "property uchar red\r\nproperty double x\r\nproperty double y\r\n"
                        "property list uchar float weights\r\nproperty double z\r\n"
                        "element edge 2\r\nproperty int a\r\n"
                        "element face 1\r\nproperty list uint16 ushort vertex_index\r\n"
                        "property float quality\r\nend_header\r\n";
    const double xyz[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 1}};
    for (const auto &p : xyz) {
        append(bytes, std::uint8_t{200}, big_endian);
        append(bytes, p[0], big_endian);
        append(bytes, p[1], big_endian);
        append(bytes, std::uint8_t{1}, big_endian);
        append(bytes, 0.25F, big_endian);
        append(bytes, p[2], big_endian);
    }
    append(bytes, std::int32_t{7}, big_endian);
    append(bytes, std::int32_t{8}, big_endian);
    append(bytes, std::uint16_t{4}, big_endian);
    for (std::uint16_t i = 0; i < 4; ++i)
        append(bytes, i, big_endian);
    append(bytes, 1.0F, big_endian);
    return bytes;
}

} // namespace

TEST_CASE("PLY in text and in both byte orders", "[ply]") {
    const std::string text = "ply\nformat ascii 1.0\n" + vertex_header + face_header +
                             "end_header\n" + places + "4 0 1 2 3\n";
    for (const std::string &bytes : {text, binary_quad(false), binary_quad(true)}) {
        const Mesh mesh = read_bytes(bytes);
        REQUIRE(mesh.positions.size() == 4);
        CHECK(mesh.positions[3] == glm::dvec3(0, 1, 1));
        REQUIRE(mesh.triangles.size() == 2);
        CHECK(mesh.triangles[1] == std::array<std::uint32_t, 3>{0, 2, 3});

        // As Mitsuba 3.9.1 computes them for the two triangles.
        const glm::vec3 expected(0.370482773F, -0.370482773F, 0.851754069F);
        CHECK(glm::length(mesh.normals[0] - expected) < 1e-6F);
    }
}

TEST_CASE("PLY normals and coordinates under all their names", "[ply]") {
    for (const std::string &names :
         {std::string("u v"), std::string("s t"), std::string("texture_u texture_v"),
          std::string("texture_s texture_t")}) {
        const std::string first = names.substr(0, names.find(' '));
        const std::string second = names.substr(names.find(' ') + 1);
        const std::string bytes =
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
            "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
            "property float " +
            first + "\nproperty float " + second + "\n" + face_header +
            "end_header\n0 0 0 0 3 0 .25 .75\n1 0 0 0 3 0 0 0\n0 1 0 0 0 0 1 1\n3 0 1 2\n";
        const Mesh mesh = read_bytes(bytes);
        CHECK(mesh.normals[0] == glm::vec3(0, 1, 0));
        CHECK(mesh.normals[2] == glm::vec3(0, 0, 1)); // none stated: the smooth one
        CHECK(mesh.uvs[0] == glm::vec2(0.25F, 0.75F));
        CHECK(read_bytes(bytes, {.flip_tex_coords = true}).uvs[0] == glm::vec2(0.25F, 0.25F));
        CHECK(read_bytes(bytes, {.face_normals = true}).normals.empty());
    }
}

TEST_CASE("a PLY cut at any byte is an error", "[ply]") {
    const test::ScratchFolder folder;
    const std::string path = folder.file("cut.ply", binary_quad(false));
    for (auto length = std::filesystem::file_size(path); length-- > 0;) {
        std::filesystem::resize_file(path, length);
        INFO("length " << length);
        CHECK_THROWS_AS(read_ply_mesh(path, {}), InputError);
    }
}

TEST_CASE("PLY text with the line ends of every system", "[ply]") {
    const std::string text = "ply\nformat ascii 1.0\n" + vertex_header + face_header +
                             "end_header\n" + places + "4 0 1 2 3\n";
    for (const std::string &line_end :
         {std::string("\n"), std::string("\r\n"), std::string("\r")}) {
        const auto with_line_ends = [&](const std::string &lines) {
            std::string bytes;
            for (const char c : lines)
                bytes += c == '\n' ? line_end : std::string(1, c);
            return bytes;
        };
        CHECK(read_bytes(with_line_ends(text)).triangles.size() == 2);
        const std::string bad = test::error_of(
            [&] { read_bytes(with_line_ends(text.substr(0, text.size() - 2) + "9\n")); });
        CHECK(bad.find("mesh.ply:14: vertex index 9") != std::string::npos);
    }
}

TEST_CASE("a binary PLY behind a header of any line ends begins at the right byte", "[ply]") {
    for (const std::string &line_end :
         {std::string("\n"), std::string("\r\n"), std::string("\r")}) {
        std::string bytes;
        for (const char c : "ply\nformat binary_little_endian 1.0\nelement vertex 3\n"
                            "property uchar x\nproperty uchar y\nproperty uchar z\n" +
                                face_header + "end_header\n")
            bytes += c == '\n' ? line_end : std::string(1, c);

        // The first number of the data has the value of a line feed.
        for (const int byte :
             {10, 13, 0, 13, 10, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0})
            bytes += static_cast<char>(byte);
        const Mesh mesh = read_bytes(bytes);
        CHECK(mesh.positions[0] == glm::dvec3(10, 13, 0));
        CHECK(mesh.positions[1] == glm::dvec3(13, 10, 0));
        CHECK(mesh.triangles.at(0) == std::array<std::uint32_t, 3>{0, 1, 2});
    }
}

namespace {

/// Vertices in two rows of five, (0,0) (0,1) (1,0) (1,1) ..., and one strip list.
std::string strip_file(const std::string &type, const std::vector<std::int64_t> &indices) {
    std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex 10\n"
                        "property char x\nproperty char y\nproperty char z\nelement tristrips 1\n"
                        "property list int " +
                        type + " vertex_indices\nend_header\n";
    for (char i = 0; i < 10; ++i)
        bytes += {static_cast<char>(i / 2), static_cast<char>(i % 2), '\0'};
    append(bytes, static_cast<std::int32_t>(indices.size()), false);
    for (const std::int64_t i : indices) {
        if (type.ends_with("char"))
            append(bytes, static_cast<std::uint8_t>(i), false);
        else if (type.ends_with("short"))
            append(bytes, static_cast<std::uint16_t>(i), false);
        else
            append(bytes, static_cast<std::uint32_t>(i), false);
    }
    return bytes;
}

} // namespace

TEST_CASE("PLY triangle strips become triangles that all face the same way", "[ply]") {
    for (const char *type : {"int", "uint", "short", "ushort", "char", "uchar"}) {
        CAPTURE(type);
        // Two strips of four and three vertices, the second one with a repeated vertex in between.
        const Mesh mesh =
            read_bytes(strip_file(type, {0, 2, 1, 3, -1, 4, 6, 5, 7, 7, 8, 9, -1, -1}));
        double area = 0;
        for (const auto &t : mesh.triangles) {
            const double z = glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                        mesh.positions[t[2]] - mesh.positions[t[0]])
                                 .z;
            CHECK(std::abs(z) == 1);
            area += z / 2;
        }
        CHECK(mesh.triangles.size() == 5);
        CHECK(mesh.triangles[0] == std::array<std::uint32_t, 3>{0, 2, 1});
        CHECK(mesh.triangles[1] == std::array<std::uint32_t, 3>{1, 2, 3});
        CHECK(area == 2.5);
    }
    CHECK(test::error_of([&] {
              read_bytes(strip_file("int", {0, 1, 12}));
          }).find("vertex index 12, expected an integer from 0 to 9") != std::string::npos);
    CHECK(test::error_of([&] {
              read_bytes(strip_file("int", {0, 1, -1, 3}));
          }).find("no strip with three vertices") != std::string::npos);
    CHECK(test::error_of([&] {
              read_bytes(strip_file("int", {0, 1, -2}));
          }).find("vertex index -2") != std::string::npos);
}

TEST_CASE("PLY faces may stand before the vertices, polygons too", "[ply]") {
    const Mesh mesh = read_bytes("ply\nformat ascii 1.0\n" + face_header + vertex_header +
                                 "end_header\n4 0 1 2 3\n0 0 0\n2 1 0\n0 2 0\n.5 1 0\n");
    double area = 0;
    for (const auto &t : mesh.triangles)
        area += .5 * glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                mesh.positions[t[2]] - mesh.positions[t[0]])
                         .z;
    CHECK(area == Approx(1.5));
}

TEST_CASE("PLY normals and coordinates that are not read are said", "[ply]") {
    const auto messages = [](const std::string &properties, const std::string &values) {
        return test::stderr_of([&] {
            read_bytes("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                       "property float y\nproperty float z\n" +
                       properties + "element face 1\nproperty list uchar int vertex_indices\n" +
                       "property list uchar float texcoord\nend_header\n0 0 0" + values +
                       "\n1 0 0" + values + "\n0 1 0" + values + "\n3 0 1 2 6 0 0 1 0 0 1\n");
        });
    };
    const auto has = [](const std::string &text, const std::string &part) {
        return text.find(part) != std::string::npos;
    };
    const std::string none = messages("", "");
    CHECK(has(none, "mesh.ply:7: warning: the coordinates of the faces' corners"));
    CHECK_FALSE(has(none, "normals"));
    const std::string partial =
        messages("property float nx\nproperty float nz\nproperty float s\n", " 1 0 .5");
    CHECK(has(partial, "mesh.ply:3: warning: normals without all of nx, ny and nz"));
    CHECK(has(partial, "mesh.ply:3: warning: coordinates without both"));
}
