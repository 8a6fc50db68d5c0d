/// Pictures of glTF models whose values are known.

#include "render_adapter.h"

#include "gltf_builder.h"
#include "host/files.h"
#include "image/image.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace clrender;
using namespace clrender::test;
using nlohmann::json;
using ::test::GltfBuilder;

namespace {

/// The scene of the file, 16 x 8 pixels with a box filter.
Scene small(const GltfBuilder &gltf) {
    const ::test::ScratchFolder folder;
    Scene scene = load_scene(folder.file("m.gltf", gltf.text()));
    scene.film.width = scene.film.crop_width = 16;
    scene.film.height = scene.film.crop_height = 8;
    scene.film.filter.kind = FilterKind::box;
    return scene;
}

/// [-2, 2] x [-1, 1] seen along -z.
void add_camera(GltfBuilder &gltf) {
    gltf.node({{"camera",
                gltf.add("cameras", {{"type", "orthographic"},
                                     {"orthographic",
                                      {{"xmag", 2}, {"ymag", 1}, {"znear", 0.1}, {"zfar", 10}}}})},
               {"translation", {0, 0, 3}}});
}

int add_texture(GltfBuilder &gltf, const std::vector<std::uint8_t> &rgb) {
    const int image =
        gltf.add("images", {{"bufferView", gltf.view(::test::bitmap_file(1, 1, rgb))}});
    return gltf.add("textures", {{"source", image}});
}

/// A colour that grows from 0 to 1 along x, with alpha as well.
int ramp(GltfBuilder &gltf) {
    return gltf.accessor<float>({0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0}, "VEC4", 4);
}

} // namespace

TEST_CASE("Factors, textures and vertex colours of a glTF model multiply, and alpha is cut",
          "[gltf]") {
    GltfBuilder gltf;
    add_camera(gltf);
    // Left: (u, v) of the base colour are an attribute, since the normal map has the first ones.
    const json unlit = {{"KHR_materials_unlit", json::object()}};
    const int picture = add_texture(gltf, {255, 128, 0});
    const int shown =
        gltf.add("materials", {{"extensions", unlit},
                               {"normalTexture", {{"index", picture}}},
                               {"pbrMetallicRoughness",
                                {{"baseColorFactor", {.5, 1, 1, 1}},
                                 {"baseColorTexture", {{"index", picture}, {"texCoord", 1}}}}}});
    const int uvs = gltf.square_uvs();
    gltf.node(
        {{"mesh", gltf.mesh(gltf.square(
                      shown, {{"TEXCOORD_0", uvs}, {"TEXCOORD_1", uvs}, {"COLOR_0", ramp(gltf)}}))},
         {"translation", {-1, 0, 0}}});
    // Right: black from alpha .625 on, before what shines with 2.
    const int cut =
        gltf.add("materials", {{"extensions", unlit},
                               {"alphaMode", "MASK"},
                               {"alphaCutoff", .625},
                               {"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 0, 1}}}}});
    gltf.node({{"mesh", gltf.mesh(gltf.square(cut, {{"COLOR_0", ramp(gltf)}}))},
               {"translation", {1, 0, 0.5}}});
    json bright = {{"emissiveFactor", {1, 1, 1}},
                   {"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 0, 1}}}}};
    bright["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = 2;
    gltf.node({{"mesh", gltf.mesh(gltf.square(gltf.add("materials", bright)))},
               {"translation", {1, 0, 0}}});
    Scene scene = small(gltf);
    scene.integrator.max_depth = 1; // what shines, and nothing that it lights
    const Image image = render_measured(scene, {.spp = 4, .pixel_centers = true}).mean;
    for (int x = 0; x < 8; ++x) {
        const double share = (x + 0.5) / 8;
        INFO("column " << x);
        CHECK(value_at(image, x, 3, 0) == Approx(.5 * share).epsilon(1e-5));
        CHECK(value_at(image, x, 3, 1) == Approx(srgb_decode(128 / 255.0) * share).epsilon(1e-5));
        CHECK(value_at(image, x, 3, 2) == 0);
        CHECK(value_at(image, x + 8, 3) == (share < .625 ? 2 : 0));
    }
}

TEST_CASE("Metal and roughness come from the blue and green of their texture", "[gltf]") {
    const auto render = [](bool is_textured) {
        GltfBuilder gltf;
        add_camera(gltf);
        json pbr = {{"baseColorFactor", {.8, .4, .2, 1}},
                    {"roughnessFactor", is_textured ? .5 : .5 * 64 / 255},
                    {"metallicFactor", is_textured ? .5 : .5 * 191 / 255}};
        if (is_textured)
            pbr["metallicRoughnessTexture"] = {{"index", add_texture(gltf, {9, 64, 191})}};
        gltf.node(
            {{"mesh", gltf.mesh(gltf.square(gltf.add("materials", {{"pbrMetallicRoughness", pbr}}),
                                            {{"TEXCOORD_0", gltf.square_uvs()}}))},
             {"rotation", {std::sin(-.3), 0, 0, std::cos(-.3)}},
             {"scale", {2, 2, 1}}});
        return render_measured(small(gltf), {.spp = 16}).mean;
    };
    const Image textured = render(true);
    const Image plain = render(false);
    for (int channel = 0; channel < 3; ++channel) {
        CHECK(channel_mean(textured, channel) > .05);
        CHECK(channel_mean(textured, channel) ==
              Approx(channel_mean(plain, channel)).epsilon(1e-3));
    }
}
