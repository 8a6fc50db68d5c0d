/// glTF files that are wrong: each is refused in one line.

#include "scene/load_scene.h"

#include "files.h"
#include "gltf_builder.h"

#include <catch2/catch.hpp>

#include <functional>

using namespace clrender;
using nlohmann::json;
using test::GltfBuilder;

namespace {

std::string fault_of(const std::string &bytes) {
    const test::ScratchFolder folder;
    const std::string path = folder.file("m.gltf", bytes);
    std::string fault = test::error_of([&] { (void)load_scene(path); });
    const bool is_one_line = fault.starts_with(path) && fault.find('\n') == std::string::npos;
    CHECK((fault.empty() || is_one_line));
    return is_one_line ? fault.substr(path.size()) : fault;
}

/// A square with a textured material, a camera and a light.
GltfBuilder sound() {
    GltfBuilder gltf;
    gltf.add("images", {{"bufferView", gltf.view(test::bitmap_file(1, 1, {255, 0, 0}))},
                        {"mimeType", "image/bmp"}});
    gltf.add("samplers", json::object());
    gltf.add("textures", {{"source", 0}, {"sampler", 0}});
    gltf.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    gltf.node({{"mesh", gltf.mesh(gltf.square(0, {{"TEXCOORD_0", gltf.square_uvs()}}))}});
    gltf.node({{"camera", gltf.add("cameras", {{"type", "perspective"},
                                               {"perspective", {{"yfov", 1}, {"znear", 0.1}}}})}});
    gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    gltf.node({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    return gltf;
}

} // namespace

TEST_CASE("wrong glTF files are refused with what is wrong", "[gltf]") {
    CHECK(fault_of(sound().text()).empty());
    CHECK(fault_of(sound().binary()).empty());
    struct Change {
        const char *pointer;
        json value;
        const char *fault;
    };
    const std::vector<Change> changes = {
        {"/asset/version", "1.0", "version 1.0 of glTF, expected 2.0"},
        {"/asset/version", 2, "has no version"},
        {"/asset/minVersion", "2.1", "version 2.1"},
        {"/extensionsRequired", {"EXT_meshopt_compression"}, "needs EXT_meshopt_compression"},
        {"/scene", 4, "names scene 4, of 1"},
        {"/scenes/0/nodes/0", 9, "names node 9, of 3"},
        {"/scenes/0/nodes/0", -1, "names node -1"},
        {"/nodes/0/children", {0}, "nodes[0]: is reached twice"},
        {"/nodes/0/children", {1}, "nodes[1]: is reached twice"},
        {"/nodes/0/mesh", 7, "names mesh 7, of 1"},
        {"/nodes/0/mesh", "0",
         "nodes[0]: its \"mesh\" is \"0\", expected a whole number from 0 on"},
        {"/nodes/0/mesh", 0.5, "its \"mesh\" is 0.5"},
        {"/nodes/0/mesh", -1, "its \"mesh\" is -1"},
        {"/nodes/0/mesh", 4294967296ULL, "its \"mesh\" is 4294967296"},
        {"/nodes/0/translation", {1, 2}, "its \"translation\" is [1,2], expected an array of 3"},
        {"/nodes/0/scale", "x", "expected an array of 3 numbers"},
        {"/nodes/1", json::array(), "its \"nodes\" is array, expected an array of objects"},
        {"/scene", "x", "its \"scene\" is \"x\""},
        {"/scenes/0/nodes/0", 0.5, "scenes[0]: its \"nodes\" is [0.5,1,2]"},
        {"/scenes", json::object(), "its \"scenes\" is {}, expected an array of objects"},
        {"/materials/0/doubleSided", 1, "its \"doubleSided\" is 1, expected true or false"},
        {"/meshes/0/primitives/0/attributes/NORMAL", -1, "primitives[0]: its \"NORMAL\" is -1"},
        {"/meshes/0/primitives/0/material", true, "meshes[0].primitives[0]: its \"material\""},
        {"/nodes/0/matrix", {1, 2, 3}, "matrix has 3 numbers, expected 16"},
        {"/nodes/0/rotation", {0, 0, 0, 0}, "rotation has no length"},
        {"/nodes/0/translation", {1e300, 0, 0}, "its place is not finite"},
        {"/nodes/1/camera", 1, "names camera 1, of 1"},
        {"/nodes/2/extensions/KHR_lights_punctual/light", 1, "names light 1, of 1"},
        {"/meshes/0/primitives/0/mode", 7, "mode 7, expected a number from 0 to 6"},
        {"/meshes/0/primitives/0/material", 3, "names material 3, of 1"},
        {"/meshes/0/primitives/0/indices", 0, "holds no indices"},
        {"/meshes/0/primitives/0/indices", 30, "primitive indices accessor out of bounds"},
        {"/meshes/0/primitives/0/attributes/POSITION", 30, "names accessor 30, of 3"},
        {"/meshes/0/primitives/0/attributes/POSITION", 2, "wrong type"},
        {"/meshes/0/primitives/0/attributes/NORMAL", 2, "wrong type"},
        {"/accessors/1/count", 5, "5 elements of 12 bytes from byte 0 on do not fit"},
        {"/accessors/1/count", 3, "index 3, of 3 vertices"},
        {"/accessors/1/count", 18446744073709551615ULL, "do not fit"},
        {"/accessors/1/byteOffset", 18446744073709551612ULL, "do not fit"},
        {"/accessors/1/byteOffset", 4, "do not fit"},
        {"/accessors/1/componentType", 5124, "component type 5124"},
        {"/accessors/1/bufferView", 30, "names bufferView 30"},
        {"/bufferViews/2/byteOffset", 100000, "bufferViews[2]:"},
        {"/bufferViews/2/byteLength", 18446744073709551615ULL, "bufferViews[2]:"},
        {"/bufferViews/2/byteStride", 8, "a stride of 8 bytes, expected at least 12"},
        {"/bufferViews/2/buffer", 1, "names buffer 1, of 1"},
        {"/buffers",
         {{{"byteLength", 5}, {"uri", "data:;base64,AAAA"}}},
         "states 5 bytes, but its URI has 3"},
        {"/buffers", {{{"byteLength", 5}, {"uri", "data:;base64,A?AA"}}}, "broken data URI"},
        {"/buffers", {{{"byteLength", 5}, {"uri", "https://x/y"}}}, "names no file"},
        {"/buffers", {{{"byteLength", 5}, {"uri", "none.bin"}}}, "none.bin"},
        {"/buffers", {{{"byteLength", 5}}}, "has no URI"},
        {"/buffers", {{{"uri", "data:;base64,AAAA"}}}, "has no byteLength"},
        {"/images/0", {{"name", "x"}}, "neither a URI nor a bufferView"},
        {"/images/0/bufferView", 40, "names bufferView 40"},
        {"/textures/0/source", 2, "names image 2, of 1"},
        {"/textures/0/sampler", 2, "names sampler 2, of 1"},
        {"/materials/0/pbrMetallicRoughness/baseColorTexture/index", 4, "names texture 4, of 1"},
        {"/materials/0/pbrMetallicRoughness/baseColorTexture/texCoord", -2, "texCoord is -2"},
        {"/materials/0/pbrMetallicRoughness/roughnessFactor", 2, "roughnessFactor is 2"},
        {"/materials/0/pbrMetallicRoughness/baseColorFactor", {1, 1, 1}, "baseColorFactor"},
        {"/materials/0/alphaMode", "GLOW", "alphaMode GLOW, expected OPAQUE"},
        {"/materials/0/emissiveFactor", {0, -1, 0}, "emissiveFactor is -1"},
        {"/materials/0/extensions/KHR_materials_ior/ior", 0.5, "ior is 0.5"},
        {"/materials/0/extensions/KHR_materials_transmission/transmissionFactor", "x",
         "transmissionFactor is no number"},
        {"/materials/0/extensions/KHR_materials_transmission/transmissionTexture",
         {{"texCoord", 0}},
         "has no index"},
        {"/materials/0/extensions/KHR_materials_sheen/sheenColorFactor",
         {1, 2, 0},
         "sheenColorFactor is 2"},
        {"/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/"
         "scale",
         {1},
         "scale is no array of two numbers"},
        {"/cameras/0/perspective/yfov", 4, "yfov is 4"},
        {"/cameras/0/perspective/yfov", 0, "yfov is 0"},
        {"/cameras/0/perspective/znear", -1, "znear is -1"},
        {"/cameras/0/perspective/zfar", 0.01, "zfar is not beyond znear"},
        {"/cameras/0/type", "fisheye", "fisheye"},
        {"/extensions/KHR_lights_punctual/lights/0/type", "area", "type area"},
        {"/extensions/KHR_lights_punctual/lights/0/intensity", -1, "color times intensity is -1"},
    };
    for (const Change &change : changes) {
        GltfBuilder gltf = sound();
        gltf.json[json::json_pointer(change.pointer)] = change.value;
        INFO(change.pointer << " = " << change.value);
        CHECK_THAT(fault_of(gltf.text()), Catch::Contains(change.fault));
    }
}

TEST_CASE("wrong JSON and wrong chunks are refused", "[gltf]") {
    CHECK_THAT(fault_of(""), Catch::Contains("the file is empty"));
    CHECK_THAT(fault_of("{\n\"asset\": {\"version\": \"2.0\"},\n\"nodes\": [1,]}"),
               Catch::StartsWith(":3: JSON: "));
    CHECK_THAT(fault_of("[]"), Catch::Contains("no object"));
    CHECK_THAT(fault_of("{\"a\": 1e999}"), Catch::StartsWith(":1: JSON: "));
    CHECK_THAT(fault_of("{\"a\": \"\xff\"}"), Catch::StartsWith(":1: JSON: "));
    CHECK_THAT(fault_of(std::string(100000, '[')), Catch::Contains("within each other"));
    const std::string binary = sound().binary();
    const auto changed = [&](std::size_t at, char value) {
        std::string bytes = binary;
        bytes[at] = value;
        return fault_of(bytes);
    };
    CHECK_THAT(changed(4, 1), Catch::Contains("GLB: version 1, expected 2"));
    CHECK_THAT(changed(11, 1), Catch::Contains("the header promises"));
    CHECK_THAT(changed(15, 1), Catch::Contains("a chunk of"));
    CHECK_THAT(changed(16, 'X'), Catch::Contains("the first chunk is not JSON"));
    for (std::size_t length = 0; length < binary.size(); length += 7)
        CHECK_FALSE(fault_of(binary.substr(0, length)).empty());
}
