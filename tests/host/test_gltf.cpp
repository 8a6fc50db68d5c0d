/// What is made of glTF files: geometry, places, cameras, lights.

#include "scene/gltf_accessors.h"
#include "scene/gltf_uri.h"
#include "scene/load_scene.h"

#include "files.h"
#include "gltf_builder.h"
#include "stderr_of.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <numbers>

using namespace clrender;
using nlohmann::json;
using test::GltfBuilder;

namespace {

const test::ScratchFolder &folder() {
    static const test::ScratchFolder folder;
    return folder;
}

Scene load(const std::string &bytes, const LoadOptions &options = {}) {
    return load_scene(folder().file("m.gltf", bytes), options);
}

Scene load(const GltfBuilder &gltf, const LoadOptions &options = {}) {
    return load(gltf.text(), options);
}

bool is_near(const glm::dvec3 &a, const glm::dvec3 &b, double tolerance = 1e-6) {
    return glm::length(a - b) <= tolerance;
}

glm::dvec3 placed(const Shape &shape, const glm::dvec3 &p) {
    return {shape.to_world * glm::dvec4(p, 1)};
}

} // namespace

TEST_CASE("integers are normalised by the standard's formulas", "[gltf]") {
    using gltf::normalised;
    CHECK(normalised(-128, 5120) == -1.0F);
    CHECK(normalised(-127, 5120) == -1.0F);
    CHECK(normalised(64, 5120) == float(64.0 / 127));
    CHECK(normalised(51, 5121) == 0.2F);
    CHECK(normalised(-32768, 5122) == -1.0F);
    CHECK(normalised(16384, 5122) == float(16384.0 / 32767));
    CHECK(normalised(13107, 5123) == 0.2F);
    CHECK(normalised(0.3F, 5126) == 0.3F);
}

TEST_CASE("accessors of all component types, with strides and sparse values", "[gltf]") {
    GltfBuilder gltf;
    gltf.accessor<std::int8_t>({-127, 127, 0}, "VEC3", 1, {{"normalized", true}});
    gltf.accessor<std::uint16_t>({7, 65535}, "SCALAR", 2);
    // Two attributes in turns in one view: (x y z, u v) of two vertices.
    const int view = gltf.view(test::bytes_of<float>({1, 2, 3, .1F, .2F, 4, 5, 6, .3F, .4F}),
                               {{"byteStride", 20}});
    const json strided = {{"bufferView", view}, {"componentType", 5126}, {"count", 2}};
    json places = strided;
    places["type"] = "VEC3";
    gltf.add("accessors", places);
    json coordinates = strided;
    coordinates["type"] = "VEC2";
    coordinates["byteOffset"] = 12;
    gltf.add("accessors", coordinates);
    const json sparse = {{"count", 2},
                         {"indices",
                          {{"bufferView", gltf.view(test::bytes_of<std::uint16_t>({0, 2}))},
                           {"componentType", 5123}}},
                         {"values", {{"bufferView", gltf.view(test::bytes_of<float>({9, 8}))}}}};
    gltf.accessor<float>({1, 2, 3}, "SCALAR", 3, {{"sparse", sparse}});
    gltf.add("accessors",
             {{"componentType", 5126}, {"count", 4}, {"type", "SCALAR"}, {"sparse", sparse}});
    gltf.accessor<float>({1, std::numeric_limits<float>::quiet_NaN()}, "SCALAR", 2);
    const gltf::Document document = gltf::read_document(folder().file("a.gltf", gltf.text()));
    const auto numbers = [&](int index, int least, int most) {
        return gltf::read_numbers(document, index, least, most, "here").values;
    };
    using Values = std::vector<float>;
    CHECK(numbers(0, 3, 4) == Values{-1, 1, 0});
    CHECK(numbers(1, 1, 1) == Values{7, 65535});
    CHECK(gltf::read_indices(document, 1, 65536, "here") == std::vector<std::uint32_t>{7, 65535});
    CHECK(numbers(2, 3, 3) == Values{1, 2, 3, 4, 5, 6});
    CHECK(numbers(3, 2, 2) == Values{.1F, .2F, .3F, .4F});
    CHECK(numbers(4, 1, 1) == Values{9, 2, 8});
    CHECK(numbers(5, 1, 1) == Values{9, 0, 8, 0});
    CHECK_THROWS_WITH(numbers(6, 1, 1), Catch::EndsWith("element 1 is not finite"));
    std::string said = test::stderr_of(
        [&] { CHECK(gltf::read_numbers(document, 6, 1, 1, "here", true).values[1] == 0); });
    CHECK_THAT(said, Catch::Contains("accessors[6]: 1 values are not finite, 0 instead"));
    CHECK_THROWS_WITH(gltf::read_indices(document, 1, 65535, "here"),
                      Catch::Contains("accessors[1]: index 65535, of 65535 vertices"));
    CHECK_THROWS_WITH(numbers(2, 2, 2), Catch::Contains("wrong type"));
    CHECK_THROWS_WITH(numbers(7, 2, 2), Catch::Contains("names accessor 7, of 7"));
}

TEST_CASE("lists, strips and fans are triangles", "[gltf]") {
    using Triangles = std::vector<std::array<std::uint32_t, 3>>;
    const auto triangles = [](int mode) {
        GltfBuilder gltf;
        const int places =
            gltf.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, "VEC3", 5);
        const int indices = gltf.accessor<std::uint32_t>({0, 1, 2, 3, 4}, "SCALAR", 5);
        gltf.node({{"mesh", gltf.mesh({{"attributes", {{"POSITION", places}}},
                                       {"indices", indices},
                                       {"mode", mode}})}});
        return load(gltf).shapes.front().mesh;
    };
    CHECK(triangles(4)->triangles == Triangles{{0, 1, 2}});
    CHECK(triangles(5)->triangles == Triangles{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}});
    CHECK(triangles(6)->triangles == Triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}});
    CHECK(test::stderr_of([&] { (void)triangles(1); }).find("points and lines are ignored") !=
          std::string::npos);
    CHECK(triangles(4)->normals.empty());
}

TEST_CASE("nodes stand where their matrices and those of their parents say", "[gltf]") {
    GltfBuilder gltf;
    const int mesh = gltf.mesh(gltf.square(-1));
    const double s = std::sqrt(0.5);
    // A turn by 90 degrees about y, then a child by a matrix, column by column.
    const int child = gltf.add(
        "nodes", {{"mesh", mesh}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}}});
    gltf.node({{"translation", {1, 2, 3}},
               {"rotation", {0, 2 * s, 0, 2 * s}},
               {"scale", {2, 3, 4}},
               {"children", {child}}});
    gltf.node({{"mesh", mesh}, {"scale", {-1, 1, 1}}});
    const Scene scene = load(gltf);
    REQUIRE(scene.shapes.size() >= 2);
    CHECK(is_near(placed(scene.shapes[0], {0, 0, 0}), {1 + 4 * 7, 2 + 3 * 6, 3 - 2 * 5}));
    CHECK(is_near(placed(scene.shapes[0], {1, 0, 0}) - placed(scene.shapes[0], {0, 0, 0}),
                  {0, 0, -2}));
    CHECK(scene.shapes[0].mesh == scene.shapes[1].mesh);
    // The corners of a mirrored triangle are taken in the other order.
    CHECK_FALSE(scene.shapes[0].flip_normals);
    CHECK(scene.shapes[1].flip_normals);
}

TEST_CASE("meshes that many nodes show are instances where copies would be large", "[gltf]") {
    GltfBuilder gltf;
    std::vector<std::uint32_t> indices;
    for (std::uint32_t i = 0; i < 60000; ++i)
        indices.insert(indices.end(), {0, 1, 2});
    json square = gltf.square(-1);
    square["indices"] = gltf.accessor<std::uint32_t>(indices, "SCALAR", indices.size());
    const int mesh = gltf.mesh(square);
    gltf.node({{"mesh", mesh}});
    gltf.node({{"mesh", mesh}, {"translation", {3, 0, 0}}});
    Scene scene = load(gltf);
    CHECK(scene.groups.empty());
    gltf.node({{"mesh", mesh}, {"translation", {6, 0, 0}}});
    scene = load(gltf);
    REQUIRE(scene.groups.size() == 1);
    REQUIRE(scene.instances.size() == 3);
    CHECK(scene.instances[2].to_world[3] == glm::dvec3(6, 0, 0));
}

TEST_CASE("cameras of a glTF file look along -z", "[gltf]") {
    GltfBuilder gltf;
    gltf.node({{"mesh", gltf.mesh(gltf.square(-1))}});
    const Scene framed = load(gltf);
    CHECK(framed.sensor.to_world[3].z > 1);
    CHECK(framed.shapes.size() == 3); // the ground and a light

    gltf.node({{"camera",
                gltf.add("cameras",
                         {{"type", "perspective"},
                          {"perspective", {{"yfov", 0.5}, {"aspectRatio", 2}, {"znear", 0.1}}}})},
               {"translation", {1, 2, 3}},
               {"scale", {2, 2, 2}}});
    gltf.node({{"camera",
                gltf.add("cameras", {{"type", "orthographic"},
                                     {"orthographic",
                                      {{"xmag", 3}, {"ymag", 4}, {"znear", 0}, {"zfar", 100}}}})}});
    const Scene first = load(gltf);
    CHECK(first.sensor.fov_axis == FovAxis::y);
    CHECK(first.sensor.fov == Approx(0.5 * 180 / std::numbers::pi));
    CHECK(first.film.width == 2 * first.film.height);
    CHECK(first.film.crop_width == first.film.width);
    CHECK(first.sensor.near_clip == 0.1);
    CHECK_FALSE(first.sensor.far_clip);
    CHECK(is_near(first.sensor.to_world[0], {-1, 0, 0}));
    CHECK(is_near(first.sensor.to_world[2], {0, 0, -1}));
    CHECK(is_near(first.sensor.to_world[3], {1, 2, 3}));
    CHECK(first.shapes.size() == 2); // a light

    const Scene second = load(gltf, {.defines = {}, .sensor = 1});
    CHECK(second.sensor.kind == SensorKind::orthographic);
    CHECK(is_near(second.sensor.to_world[0], {-3, 0, 0}));
    CHECK(second.film.width * 4 == second.film.height * 3);
    CHECK_FALSE(second.sensor.near_clip);
    CHECK(second.sensor.far_clip == 100);
    CHECK_THROWS_WITH(load(gltf, {.defines = {}, .sensor = 2}),
                      Catch::Contains("--sensor 2: the file has 2 cameras"));
}

TEST_CASE("punctual lights have the standard's units", "[gltf]") {
    GltfBuilder gltf;
    gltf.node({{"mesh", gltf.mesh(gltf.square(-1))}});
    gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "point"}, {"intensity", 20}, {"color", {1, 0.5, 0}}},
        {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.25}, {"outerConeAngle", 0.5}}}},
        {{"type", "directional"}, {"intensity", 3}}};
    const auto light = [&](int index, json node) {
        node["extensions"]["KHR_lights_punctual"]["light"] = index;
        gltf.node(node);
    };
    light(0, {{"translation", {1, 2, 3}}});
    light(1, {{"translation", {0, 5, 0}}});
    const double s = std::sqrt(0.5);
    light(2, {{"rotation", {-s, 0, 0, s}}, {"scale", {3, 3, 3}}}); // -z turned to -y
    const Scene scene = load(gltf);
    REQUIRE(scene.emitters.size() == 3);
    CHECK(scene.emitters[0].kind == EmitterKind::point);
    CHECK(scene.emitters[0].intensity == Rgb(20, 10, 0));
    CHECK(scene.emitters[0].position == glm::dvec3(1, 2, 3));
    CHECK(scene.emitters[1].kind == EmitterKind::spot);
    CHECK(scene.emitters[1].intensity == Rgb(1));
    CHECK(scene.emitters[1].beam_width == Approx(0.25 * 180 / std::numbers::pi));
    CHECK(scene.emitters[1].cutoff_angle == Approx(0.5 * 180 / std::numbers::pi));
    CHECK(is_near(scene.emitters[1].to_world[2], {0, 0, -1}));
    CHECK(scene.emitters[2].kind == EmitterKind::directional);
    CHECK(scene.emitters[2].intensity == Rgb(3));
    CHECK(is_near(scene.emitters[2].direction, {0, -1, 0}));
}

TEST_CASE("URIs are data or escaped paths", "[gltf]") {
    CHECK(gltf::decode_data_uri("data:a/b;base64,QUJD").value() == "ABC");
    CHECK(gltf::decode_data_uri("data:a/b;base64,QUI=").value() == "AB");
    CHECK(gltf::decode_data_uri("data:;base64,QQ").value() == "A");
    CHECK(gltf::decode_data_uri("data:,a%20b").value() == "a b");
    for (const char *broken :
         {"data:a/b;base64,QU!D", "data:a/b;base64,QUJDR", "data:a/b", "data:,%2"})
        CHECK_FALSE(gltf::decode_data_uri(broken));
    CHECK(gltf::path_of_uri("a%20b%2Ec").value() == "a b.c");
    CHECK(gltf::path_of_uri("a+b.bin").value() == "a+b.bin");
    for (const char *other : {"https://x/y.bin", "file:///y.bin", "a%zz", "a%2"})
        CHECK_FALSE(gltf::path_of_uri(other));
}

TEST_CASE("binary files, and buffers in files of their own", "[gltf]") {
    GltfBuilder gltf;
    gltf.node({{"mesh", gltf.mesh(gltf.square(-1))}});
    CHECK(load(gltf.binary()).shapes.front().mesh->triangles.size() == 2);

    // Padding behind the buffer is no fault.
    (void)folder().file("my data.bin", gltf.buffer + "....");
    gltf.json["buffers"] = {{{"byteLength", gltf.buffer.size()}, {"uri", "my%20data.bin"}}};
    CHECK(load(gltf).shapes.front().mesh->positions.size() == 4);
    (void)folder().file("my data.bin", gltf.buffer.substr(1));
    CHECK_THROWS_WITH(load(gltf), Catch::Contains("buffers[0]: states"));
}

TEST_CASE("normals of a glTF file are unit vectors, and missing ones stay flat", "[gltf]") {
    GltfBuilder gltf;
    const int normals = gltf.accessor<float>({0, 0, 2, 0, 0, 0, 0, 3, 4, 0, 0, 1}, "VEC3", 4);
    gltf.node({{"mesh", gltf.mesh(gltf.square(-1, {{"NORMAL", normals}}))}});
    const auto mesh = load(gltf).shapes.front().mesh;
    REQUIRE(mesh->normals.size() == 4);
    CHECK(mesh->normals[0] == glm::vec3(0, 0, 1));
    CHECK(mesh->normals[1] == glm::vec3(0, 0, 1)); // that of its triangles
    CHECK(is_near(glm::dvec3(mesh->normals[2]), {0, .6, .8}));
}

TEST_CASE("a skin moves vertices with its joints, as the nodes stand", "[gltf]") {
    GltfBuilder gltf;
    // The first joint moves by (5, 0, 0), the second turns by 180 degrees about z and was bound at
    // (0, 1, 0): it takes p to -(p - (0, 1, 0)).
    const int first = gltf.node({{"translation", {5, 0, 0}}});
    const int second = gltf.node({{"rotation", {0, 0, 1, 0}}});
    const int bind = gltf.accessor<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,
                                           1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1},
                                          "MAT4", 2);
    gltf.add("skins", {{"joints", {first, second}}, {"inverseBindMatrices", bind}});
    const int joints =
        gltf.accessor<std::uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 9, 9}, "VEC4", 4);
    const int weights =
        gltf.accessor<float>({1, 0, 0, 0, 1, 0, 0, 0, .5F, .5F, 0, 0, .5F, .5F, 0, 0}, "VEC4", 4);
    json square = gltf.square(-1, {{"JOINTS_0", joints}, {"WEIGHTS_0", weights}});
    gltf.node({{"mesh", gltf.mesh(square)}, {"skin", 0}, {"translation", {100, 0, 0}}});
    const Scene scene = load(gltf);
    const Mesh &mesh = *scene.shapes.at(0).mesh;
    CHECK(scene.shapes[0].to_world == glm::dmat4(1));
    CHECK(is_near(mesh.positions[0], {4, -1, 0}));
    CHECK(is_near(mesh.positions[1], {-1, 2, 0}));
    CHECK(is_near(mesh.positions[2], {(6 - 1) / 2.0, (1 + 0) / 2.0, 0}));
    gltf.json["skins"][0]["joints"] = {first};
    CHECK_THROWS_WITH(load(gltf), Catch::Contains("joint 1, of 1"));
    gltf.json["skins"][0]["joints"] = {first, 77};
    CHECK_THROWS_WITH(load(gltf), Catch::Contains("node 77 is no part of the scene"));
}

TEST_CASE("what is not shown of a glTF file is said", "[gltf]") {
    GltfBuilder gltf;
    json square = gltf.square(gltf.add("materials", {{"occlusionTexture", {{"index", 0}}}}));
    gltf.add("textures", {{"source", 0}});
    gltf.add("images", {{"uri", "missing.png"}});
    square["targets"] = {{{"POSITION", 0}}};
    gltf.node({{"mesh", gltf.mesh(square)}});
    gltf.json["animations"] = {json::object()};
    gltf.json["extensionsUsed"] = {"EXT_of_tomorrow", "KHR_materials_ior"};
    const std::string said = test::stderr_of([&] { (void)load(gltf); });
    for (const char *what : {"occlusionTexture is ignored", "morph targets are ignored",
                             "animations: are ignored", "EXT_of_tomorrow is not supported"})
        CHECK_THAT(said, Catch::Contains(what));
    CHECK_THAT(said, !Catch::Contains("KHR_materials_ior"));
}
