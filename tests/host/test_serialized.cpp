#include "files.h"
#include "stderr_of.h"

#include "error.h"
#include "scene/mesh_attributes.h"

#include <catch2/catch.hpp>
#include <zlib.h>

#include <cmath>
#include <cstring>

using namespace clrender;

namespace {

constexpr std::uint32_t normals = 1, uvs = 2, colors = 8, face_normals = 0x10, in_double = 0x2000;

template <class T> std::string bytes_of(T value) {
    std::string bytes(sizeof(T), '\0');
    std::memcpy(bytes.data(), &value, sizeof(T));
    return bytes;
}

std::string numbers(std::uint32_t flags, const std::vector<double> &values) {
    std::string bytes;
    for (const double value : values)
        bytes += (flags & in_double) != 0 ? bytes_of(value) : bytes_of(static_cast<float>(value));
    return bytes;
}

/// What a mesh's header is followed by, before it is compressed.
struct Parts {
    std::uint32_t flags = 0;
    std::uint16_t version = 4;
    std::uint64_t vertices = 3, triangles = 1;
    std::vector<double> places{0, 0, 0, 2, 0, 0, 0, 2, 0};
    std::vector<std::uint32_t> indices{0, 1, 2};

    [[nodiscard]] std::string plain() const {
        std::string bytes = bytes_of(flags);
        if (version == 4)
            bytes += std::string("name\0", 5);
        bytes += bytes_of(vertices) + bytes_of(triangles) + numbers(flags, places);
        if ((flags & normals) != 0)
            bytes += numbers(flags, {0, 0, 5, 0, 0, 5, 0, 0, 5});
        if ((flags & uvs) != 0)
            bytes += numbers(flags, {0, .25, 1, .25, 0, 1});
        if ((flags & colors) != 0)
            bytes += numbers(flags, {.5, 0, 0, 0, .5, 0, 0, 0, .5});
        for (const std::uint32_t index : indices)
            bytes += bytes_of(index);
        return bytes;
    }

    [[nodiscard]] std::string compressed() const {
        const std::string from = plain();
        uLongf size = compressBound(static_cast<uLong>(from.size()));
        std::string to(size, '\0');
        REQUIRE(compress(reinterpret_cast<Bytef *>(to.data()), &size,
                         reinterpret_cast<const Bytef *>(from.data()),
                         static_cast<uLong>(from.size())) == Z_OK);
        to.resize(size);
        return bytes_of(std::uint16_t{0x041c}) + bytes_of(version) + to;
    }
};

std::string file_of(const std::vector<Parts> &meshes) {
    std::string bytes, dictionary;
    for (const Parts &mesh : meshes) {
        dictionary += mesh.version == 4 ? bytes_of(std::uint64_t{bytes.size()})
                                        : bytes_of(static_cast<std::uint32_t>(bytes.size()));
        bytes += mesh.compressed();
    }
    return bytes + dictionary + bytes_of(static_cast<std::uint32_t>(meshes.size()));
}

Mesh read(const std::string &bytes, const MeshReadOptions &options = {}) {
    const test::ScratchFolder folder;
    return read_serialized_mesh(folder.file("mesh.serialized", bytes), options);
}

std::string error(const std::string &bytes, int shape_index = 0) {
    return test::error_of([&] { read(bytes, {.shape_index = shape_index}); });
}

} // namespace

TEST_CASE("serialized meshes of both versions and precisions", "[serialized]") {
    for (const std::uint16_t version : {std::uint16_t{3}, std::uint16_t{4}})
        for (const std::uint32_t precision : {0U, 0x1000U, in_double}) {
            Parts second{precision | normals | uvs | colors, version};
            second.places[3] = 3;
            const std::string file = file_of({{precision, version}, second});
            const Mesh plain = read(file);
            CHECK(plain.positions[1] == glm::dvec3(2, 0, 0));
            CHECK(plain.has_computed_normals);
            CHECK(plain.uvs.empty());
            const Mesh full = read(file, {.shape_index = 1, .attributes = {"vertex_color"}});
            CHECK(full.positions[1] == glm::dvec3(3, 0, 0));
            CHECK(full.normals[2] == glm::vec3(0, 0, 1));
            CHECK_FALSE(full.has_computed_normals);
            CHECK(full.uvs[1] == glm::vec2(1, .25F));
            CHECK(full.triangles == std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}});
            REQUIRE(full.attributes.size() == 1);
            CHECK(full.attributes[0].values[4] == .5F);
            CHECK(read(file, {.face_normals = true, .shape_index = 1}).normals.empty());
        }
}

TEST_CASE("the flag of face normals is warned of", "[serialized]") {
    CHECK_THAT(test::stderr_of([] { read(file_of({{face_normals}})); }),
               Catch::Contains("face normals is ignored"));
}

TEST_CASE("what is wrong with a serialized mesh is told", "[serialized]") {
    const auto broken = [](auto change) {
        Parts parts;
        change(parts);
        return error(file_of({parts}));
    };
    CHECK_THAT(error(""), Catch::Contains("not a .serialized file"));
    CHECK_THAT(error("ply\nformat"), Catch::Contains("not a .serialized file"));
    CHECK_THAT(broken([](Parts &p) { p.version = 5; }), Catch::Contains("version 5"));
    CHECK_THAT(error(bytes_of(0x0004041cU) + std::string(60, 'x')), Catch::Contains("damaged"));
    CHECK_THAT(broken([](Parts &p) { p.indices[1] = 3; }),
               Catch::Contains("triangle 0 has the vertex 3, expected a number from 0 to 2"));
    CHECK_THAT(broken([](Parts &p) { p.places[4] = NAN; }), Catch::Contains("place of vertex 1"));
    CHECK_THAT(broken([](Parts &p) {
                   p.flags = normals | in_double;
                   p.places[8] = INFINITY;
               }),
               Catch::Contains("finite"));
    CHECK_THAT(broken([](Parts &p) { p.vertices = 0; }), Catch::Contains("0 vertices"));
    CHECK_THAT(broken([](Parts &p) { p.triangles = 0; }), Catch::Contains("0 triangles"));
    CHECK_THAT(broken([](Parts &p) { p.vertices = ~std::uint64_t{0}; }),
               Catch::Contains("expected from 1"));
    CHECK_THAT(broken([](Parts &p) { p.vertices = 0x7fffffff; }), Catch::Contains("promised"));
    CHECK_THAT(broken([](Parts &p) { p.triangles = 0x7fffffff; }), Catch::Contains("promised"));
    CHECK_THAT(broken([](Parts &p) { p.triangles = 2; }), Catch::Contains("ends before all"));
}

TEST_CASE("the dictionary of serialized meshes is checked", "[serialized]") {
    const std::string good = file_of({{}, {}});
    CHECK(error(good, 1).empty());
    CHECK_THAT(error(good, 2), Catch::Contains("\"shape_index\" is 2, but ") &&
                                   Catch::Contains(" has 2 meshes, expected a number from 0 to 1"));
    // The line of the scene that asks for it.
    const test::ScratchFolder folder;
    const std::string file = folder.file("two.serialized", good);
    CHECK(test::error_of([&] {
              (void)read_serialized_mesh(file, {.shape_index = 2}, {"scene.xml", 7});
          }).starts_with("scene.xml:7: \"shape_index\" is 2, but "));
    const auto with_count = [&](std::uint32_t count) {
        return good.substr(0, good.size() - 4) + bytes_of(count);
    };
    CHECK_THAT(error(with_count(0), 1), Catch::Contains("dictionary of 0 meshes"));
    CHECK_THAT(error(with_count(0xffffffff), 1), Catch::Contains("too short"));
    const auto with_offset = [&](std::uint64_t offset) {
        return good.substr(0, good.size() - 12) + bytes_of(offset) + good.substr(good.size() - 4);
    };
    for (const std::uint64_t offset : {~std::uint64_t{0}, std::uint64_t{good.size() - 21}})
        CHECK_THAT(error(with_offset(offset), 1), Catch::Contains("is said to begin at byte"));
    CHECK_THAT(error(with_offset(1), 1), Catch::Contains("not a .serialized file"));
}

TEST_CASE("a serialized file cut off at any byte is refused or has its mesh", "[serialized]") {
    const std::string whole = Parts{normals | uvs | colors}.compressed();
    int loaded = 0;
    for (std::size_t length = 0; length < whole.size(); ++length)
        loaded += error(whole.substr(0, length)).empty() ? 1 : 0;
    // zlib's check sum of four bytes ends the file.
    CHECK(loaded <= 5);
}
