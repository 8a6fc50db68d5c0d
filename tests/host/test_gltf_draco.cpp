/// Compressed primitives of glTF files.

#include "scene/load_scene.h"

#include "files.h"
#include "gltf_builder.h"

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>

#include <catch2/catch.hpp>

#include <algorithm>

using namespace clrender;
using test::GltfBuilder;

namespace {

/// The square [-1, 1]^2 in z = 0 with (u, v), compressed.
std::string compressed_square(draco::MeshEncoderMethod method) {
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(2);
    const int place =
        builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    const int uv = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
    const float p[4][3] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    const float t[4][2] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    const int corners[2][3] = {{0, 1, 2}, {0, 2, 3}};
    for (std::uint32_t f = 0; f < 2; ++f) {
        const auto &c = corners[f];
        const draco::FaceIndex face(f);
        builder.SetAttributeValuesForFace(place, face, p[c[0]], p[c[1]], p[c[2]]);
        builder.SetAttributeValuesForFace(uv, face, t[c[0]], t[c[1]], t[c[2]]);
    }
    const auto mesh = builder.Finalize();
    draco::Encoder encoder;
    encoder.SetEncodingMethod(method);
    draco::EncoderBuffer buffer;
    REQUIRE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
    return {buffer.data(), buffer.size()};
}

GltfBuilder with_data(const std::string &data) {
    GltfBuilder gltf;
    const nlohmann::json bare = {{"componentType", 5126}, {"count", 4}};
    nlohmann::json place = bare;
    place["type"] = "VEC3";
    nlohmann::json uv = bare;
    uv["type"] = "VEC2";
    const int indices =
        gltf.add("accessors", {{"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}});
    gltf.add("images", {{"bufferView", gltf.view(test::bitmap_file(1, 1, {9, 9, 9}))}});
    gltf.add("textures", {{"source", 0}});
    gltf.add("materials", {{"emissiveTexture", {{"index", 0}}}, {"emissiveFactor", {1, 1, 1}}});
    nlohmann::json primitive = {
        {"attributes",
         {{"POSITION", gltf.add("accessors", place)}, {"TEXCOORD_0", gltf.add("accessors", uv)}}},
        {"indices", indices},
        {"material", 0}};
    primitive["extensions"]["KHR_draco_mesh_compression"] = {
        {"bufferView", gltf.view(data)}, {"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}};
    gltf.node({{"mesh", gltf.mesh(primitive)}});
    gltf.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    return gltf;
}

} // namespace

TEST_CASE("Draco's meshes of both kinds are decompressed", "[gltf]") {
    const test::ScratchFolder folder;
    for (const auto method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
        const Scene scene =
            load_scene(folder.file("m.gltf", with_data(compressed_square(method)).text()));
        const Mesh &mesh = *scene.shapes.at(0).mesh;
        REQUIRE(mesh.triangles.size() == 2);
        REQUIRE(mesh.positions.size() == 4);
        double area = 0;
        for (const auto &t : mesh.triangles)
            area += glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                               mesh.positions[t[2]] - mesh.positions[t[0]])
                        .z /
                    2;
        CHECK(area == Approx(4));
        for (std::size_t i = 0; i < 4; ++i) {
            CHECK(mesh.uvs.at(i).x == Approx((mesh.positions[i].x + 1) / 2));
            CHECK(mesh.uvs.at(i).y == Approx((1 - mesh.positions[i].y) / 2));
        }
    }
}

TEST_CASE("Draco data with one wrong byte are read or refused", "[gltf]") {
    const test::ScratchFolder folder;
    for (const auto method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
        const std::string sound = compressed_square(method);
        for (std::size_t at = 0; at < sound.size(); ++at)
            for (const char change : {'\x01', '\x40', '\x7f'}) {
                std::string data = sound;
                data[at] = static_cast<char>(data[at] ^ change);
                INFO("byte " << at << " changed by " << int{change});
                const std::string path = folder.file("m.gltf", with_data(data).text());
                const std::string fault = test::error_of([&] { (void)load_scene(path); });
                CHECK((fault.empty() || fault.starts_with(path + ": ")));
            }
    }
}

TEST_CASE("broken Draco data is refused", "[gltf]") {
    const test::ScratchFolder folder;
    const std::string sound = compressed_square(draco::MESH_EDGEBREAKER_ENCODING);
    const auto fault = [&](const std::string &data) {
        return test::error_of(
            [&] { (void)load_scene(folder.file("m.gltf", with_data(data).text())); });
    };
    CHECK(fault(sound).empty());
    for (std::size_t length = 1; length < sound.size(); ++length)
        CHECK_THAT(fault(sound.substr(0, length)), Catch::Contains("Draco"));
    CHECK_THAT(fault("DRACO\1\2" + sound.substr(7)), Catch::Contains("bitstream 2.2"));
    // 2^35 triangles, and a number of 7 bits a byte that never ends.
    CHECK_THAT(fault(sound.substr(0, 12) + "\x04\x80\x80\x80\x80\x80\x01"),
               Catch::Contains("triangles and 4 vertices in"));
    CHECK_THAT(fault(sound.substr(0, 12) + std::string(40, '\xff')),
               Catch::Contains("bitstream 2.2"));
}
