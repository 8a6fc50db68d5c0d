#include "files.h"

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
         {std::string("u v"), std::string("s t"), std::string("texture_u texture_v")}) {
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
