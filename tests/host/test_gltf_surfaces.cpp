/// What glTF materials become.

#include "scene/load_scene.h"
#include "scene/mesh_attributes.h"

#include "files.h"
#include "gltf_builder.h"
#include "stderr_of.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace clrender;
using nlohmann::json;
using test::GltfBuilder;

namespace {

/// A square with one material, and what has become of it.
struct Example {
    GltfBuilder gltf;
    json attributes = json::object();
    Scene scene;
    std::string said;

    /// A texture of one pixel a colour; rows are `width` wide.
    int texture(int width, const std::vector<std::uint8_t> &rgb, const json &sampler = {}) {
        const int height = static_cast<int>(rgb.size()) / 3 / width;
        const int image =
            gltf.add("images", {{"bufferView", gltf.view(test::bitmap_file(width, height, rgb))},
                                {"mimeType", "image/bmp"}});
        json texture = {{"source", image}};
        if (!sampler.is_null())
            texture["sampler"] = gltf.add("samplers", sampler);
        return gltf.add("textures", texture);
    }
    /// Reads the file with the material; returns the model of its BSDF.
    const BsdfModel &load(const json &material) {
        const test::ScratchFolder folder;
        gltf.add("materials", material);
        gltf.node({{"mesh", gltf.mesh(gltf.square(0, attributes))}});
        const std::string path = folder.file("m.gltf", gltf.text());
        said = test::stderr_of([&] { scene = load_scene(path); });
        return bsdf(shape().bsdf);
    }
    [[nodiscard]] const Shape &shape() const { return scene.shapes.at(0); }
    [[nodiscard]] const BsdfModel &bsdf(int index) const {
        return scene.bsdfs.at(static_cast<std::size_t>(index)).model;
    }
    [[nodiscard]] const BsdfModel &front(const BsdfModel &model) const {
        return bsdf(std::get<TwosidedBsdf>(model).front);
    }
    [[nodiscard]] const Texture &texture_at(int index) const {
        return scene.textures.at(static_cast<std::size_t>(index));
    }
    [[nodiscard]] double number(int index) const {
        CHECK(texture_at(index).kind == TextureKind::constant);
        return texture_at(index).value.r;
    }
};

json pbr(const json &object) {
    return {{"pbrMetallicRoughness", object}};
}

} // namespace

TEST_CASE("metallic-roughness materials are principled BSDFs, alike on both sides", "[gltf]") {
    Example e;
    const auto &bsdf =
        std::get<PrincipledBsdf>(e.front(e.load(pbr({{"baseColorFactor", {1, .5, .25, .1}},
                                                     {"metallicFactor", .75},
                                                     {"roughnessFactor", .5}}))));
    CHECK(e.texture_at(bsdf.base_color).value == Rgb(1, .5, .25));
    CHECK(e.number(bsdf.metallic) == .75);
    CHECK(e.number(bsdf.roughness) == .5);
    CHECK(bsdf.eta == 1.5);
    CHECK(bsdf.spec_trans == none);
    CHECK(e.shape().emitter == none);
}

TEST_CASE("the standard's default material is a rough white metal", "[gltf]") {
    Example e;
    const auto &bsdf = std::get<PrincipledBsdf>(e.front(e.load(json::object())));
    CHECK(e.texture_at(bsdf.base_color).value == Rgb(1));
    CHECK(e.number(bsdf.metallic) == 1);
    CHECK(e.number(bsdf.roughness) == 1);
}

TEST_CASE("textures of a glTF material have its factors, channels, wrap modes and transforms",
          "[gltf]") {
    Example e;
    e.attributes["TEXCOORD_0"] = e.gltf.square_uvs();
    const int color = e.texture(2, {255, 0, 0, 0, 255, 0},
                                {{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}});
    const int rough = e.texture(1, {0, 64, 255});
    json base = {{"index", color}};
    base["extensions"]["KHR_texture_transform"] = {
        {"offset", {.1, .2}}, {"rotation", 1}, {"scale", {2, 3}}};
    const auto &bsdf = std::get<PrincipledBsdf>(
        e.front(e.load(pbr({{"baseColorTexture", base},
                            {"baseColorFactor", {1, .5, .25, 1}},
                            {"roughnessFactor", .5},
                            {"metallicFactor", .75},
                            {"metallicRoughnessTexture", {{"index", rough}}}}))));
    const Texture &t = e.texture_at(bsdf.base_color);
    CHECK(t.kind == TextureKind::bitmap);
    CHECK_FALSE(t.format.raw);
    CHECK(t.scale == Rgb(1, .5, .25));
    CHECK(t.wrap == TextureWrap::clamp);
    CHECK(t.wrap_v == TextureWrap::mirror);
    CHECK(t.filter == TextureFilter::nearest);
    CHECK(t.bitmap->u8 == std::vector<std::uint8_t>{255, 0, 0, 0, 255, 0});
    // Scaled, turned counter-clockwise as a picture with v downwards shows it, moved.
    const glm::dvec3 uv = t.to_uv * glm::dvec3(.3, .4, 1);
    CHECK(uv.x == Approx(std::cos(1) * .6 + std::sin(1) * 1.2 + .1));
    CHECK(uv.y == Approx(-std::sin(1) * .6 + std::cos(1) * 1.2 + .2));

    const Texture &roughness = e.texture_at(bsdf.roughness);
    const Texture &metallic = e.texture_at(bsdf.metallic);
    CHECK(roughness.format.raw);
    CHECK(roughness.is_number);
    CHECK(roughness.channel == 1);
    CHECK(roughness.scale == Rgb(.5));
    CHECK(roughness.wrap == TextureWrap::repeat);
    CHECK(roughness.filter == TextureFilter::bilinear);
    CHECK(metallic.channel == 2);
    CHECK(metallic.scale == Rgb(.75));
    CHECK(metallic.bitmap == roughness.bitmap);
    REQUIRE(e.shape().mesh->uvs.size() == 4);
    CHECK(e.shape().mesh->uvs[1] == glm::vec2(1, 1));
}

TEST_CASE("textures of other coordinates, and vertex colours, are attributes", "[gltf]") {
    Example e;
    e.attributes["TEXCOORD_0"] = e.gltf.square_uvs();
    e.attributes["TEXCOORD_1"] = e.gltf.accessor<std::uint8_t>({0, 51, 255, 0, 0, 0, 0, 0}, "VEC2",
                                                               4, {{"normalized", true}});
    e.attributes["COLOR_0"] =
        e.gltf.accessor<std::uint16_t>({65535, 0, 13107, 65535, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0},
                                       "VEC4", 4, {{"normalized", true}});
    const int color = e.texture(1, {255, 0, 0});
    const auto &mask = std::get<MaskBsdf>(
        e.load({{"alphaMode", "BLEND"},
                {"emissiveFactor", {.5, .5, .5}},
                {"emissiveTexture", {{"index", color}, {"texCoord", 1}}},
                {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}},
                {"pbrMetallicRoughness",
                 {{"baseColorTexture", {{"index", color}}}, {"baseColorFactor", {1, 1, 1, .5}}}}}));
    const auto &bsdf = std::get<PrincipledBsdf>(e.front(e.bsdf(mask.nested)));
    CHECK(e.texture_at(bsdf.base_color).product == "vertex_color");
    CHECK(e.texture_at(bsdf.base_color).coordinates.empty());
    const Texture &opacity = e.texture_at(mask.opacity);
    CHECK(opacity.kind == TextureKind::attribute);
    CHECK(opacity.attribute == "vertex_alpha");
    CHECK(opacity.scale == Rgb(.5));
    CHECK_FALSE(opacity.cutoff);
    REQUIRE(e.shape().emitter != none);
    const Texture &emission = e.texture_at(e.scene.emitters.at(0).radiance);
    CHECK(emission.coordinates == "vertex_texcoord_1");
    CHECK(emission.scale == Rgb(2));
    CHECK(e.shape().attribute_textures.size() == 3);
    const Mesh &mesh = *e.shape().mesh;
    CHECK(find_attribute(mesh, "vertex_texcoord_1")->values.at(1) == .2F);
    CHECK(find_attribute(mesh, "vertex_texcoord_1")->values.at(3) == 1);
    CHECK(find_attribute(mesh, "vertex_color")->values.at(2) == .2F);
    CHECK(find_attribute(mesh, "vertex_alpha")->values.at(0) == 1);
}

TEST_CASE("alpha is cut or blended where the material says so", "[gltf]") {
    const auto opacity = [](const char *mode, double alpha) {
        Example e;
        const BsdfModel &model =
            e.load({{"alphaMode", mode},
                    {"alphaCutoff", .3},
                    {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, alpha}}}}});
        const auto *mask = std::get_if<MaskBsdf>(&model);
        return mask == nullptr ? 1 : e.number(mask->opacity);
    };
    CHECK(opacity("OPAQUE", .2) == 1);
    CHECK(opacity("BLEND", .2) == .2);
    CHECK(opacity("BLEND", 1) == 1);
    CHECK(opacity("MASK", .2) == 0);
    CHECK(opacity("MASK", .3) == 1);
}

TEST_CASE("glass of a glTF material is thin, or a volume where it has a thickness", "[gltf]") {
    const auto material = [](double roughness, const json &volume = {}) {
        json m = {
            {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", roughness}}}};
        m["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = 1;
        m["extensions"]["KHR_materials_ior"]["ior"] = 1.25;
        if (!volume.is_null())
            m["extensions"]["KHR_materials_volume"] = volume;
        return m;
    };
    Example sheet;
    CHECK(std::get<ThinDielectricBsdf>(sheet.load(material(0))).ior.interior == 1.25);
    Example frosted;
    const auto &thin = std::get<PrincipledThinBsdf>(frosted.load(material(.5)));
    CHECK(frosted.number(thin.spec_trans) == 1);
    CHECK(frosted.number(thin.roughness) == .5);
    CHECK(frosted.number(thin.eta) == 1.25);

    const json volume = {
        {"thicknessFactor", 2}, {"attenuationDistance", 1}, {"attenuationColor", {1, .5, .25}}};
    Example solid;
    const auto &glass = std::get<DielectricBsdf>(solid.load(material(0, volume)));
    CHECK(glass.ior.interior == 1.25);
    // Half of what a way of 2 absorbs, where light enters and where it leaves.
    CHECK(solid.texture_at(glass.specular_transmittance).value == Rgb(1, .5, .25));
    CHECK_THAT(solid.said, Catch::Contains("taken at its surface"));
    Example rough;
    const auto &ground = std::get<RoughDielectricBsdf>(rough.load(material(.5, volume)));
    CHECK(ground.microfacets.kind == MicrofacetKind::ggx);
    CHECK(rough.number(ground.microfacets.alpha_u) == .25);

    // Half metal: what transmits and what does not, mixed.
    Example mixed;
    json half = material(0);
    half["pbrMetallicRoughness"]["metallicFactor"] = .5;
    const auto &blend = std::get<BlendBsdf>(mixed.load(half));
    CHECK(mixed.number(blend.weight) == .5);
    CHECK(std::holds_alternative<ThinDielectricBsdf>(mixed.bsdf(blend.first)));
}

TEST_CASE("coats, sheen and specular of a glTF material are those of principled", "[gltf]") {
    Example e;
    json m = pbr({{"metallicFactor", 0}});
    m["extensions"]["KHR_materials_clearcoat"] = {{"clearcoatFactor", .5},
                                                  {"clearcoatRoughnessFactor", .2}};
    m["extensions"]["KHR_materials_sheen"] = {{"sheenColorFactor", {.3, .3, .3}}};
    m["extensions"]["KHR_materials_specular"] = {{"specularFactor", .5}};
    const auto &bsdf = std::get<PrincipledBsdf>(e.front(e.load(m)));
    CHECK(e.number(bsdf.clearcoat) == .5);
    // alpha = .1 + gloss (.001 - .1) is .2^2
    CHECK(e.number(bsdf.clearcoat_gloss) == Approx(.06 / .099));
    CHECK(e.number(bsdf.sheen) == .3);
    const double root = (bsdf.eta - 1) / (bsdf.eta + 1);
    CHECK(root * root == Approx(.02));
}

TEST_CASE("unlit surfaces shine with their colour and reflect nothing", "[gltf]") {
    Example e;
    json m = pbr({{"baseColorFactor", {.5, .25, .125, 1}}});
    m["extensions"]["KHR_materials_unlit"] = json::object();
    const auto &bsdf = std::get<DiffuseBsdf>(e.front(e.load(m)));
    CHECK(e.texture_at(bsdf.reflectance).value == Rgb(0));
    REQUIRE(e.shape().emitter != none);
    CHECK(e.texture_at(e.scene.emitters.at(0).radiance).value == Rgb(.5, .25, .125));
}

TEST_CASE("normal maps follow mirrored coordinates, and their scale", "[gltf]") {
    Example e;
    // Upright on one triangle, mirrored on the other.
    e.attributes["TEXCOORD_0"] = e.gltf.accessor<float>({0, 1, 1, 1, 1, 0, 1, 1}, "VEC2", 4);
    const int map = e.texture(1, {255, 192, 128});
    e.load({{"normalTexture", {{"index", map}}}});
    std::vector<std::vector<std::uint8_t>> maps;
    for (const Shape &shape : e.scene.shapes)
        if (const auto *both = std::get_if<TwosidedBsdf>(&e.bsdf(shape.bsdf)))
            if (const auto *turned = std::get_if<NormalMapBsdf>(&e.bsdf(both->front)))
                maps.push_back(e.texture_at(turned->normalmap).bitmap->u8);
    using Bytes = std::vector<std::uint8_t>;
    CHECK(maps == std::vector<Bytes>{Bytes{255, 63, 128}, Bytes{255, 192, 128}});

    Example scaled;
    scaled.attributes["TEXCOORD_0"] = scaled.gltf.square_uvs();
    const int other = scaled.texture(1, {255, 0, 255});
    const auto &turned = std::get<NormalMapBsdf>(
        scaled.front(scaled.load({{"normalTexture", {{"index", other}, {"scale", .5}}}})));
    CHECK(scaled.texture_at(turned.normalmap).bitmap->f32 == std::vector<float>{.75F, .25F, 1});
}

TEST_CASE("a texture without coordinates or without a picture leaves its factor", "[gltf]") {
    Example e;
    const int color = e.texture(1, {255, 0, 0});
    (void)e.load(pbr({{"baseColorTexture", {{"index", color}, {"texCoord", 3}}}}));
    CHECK_THAT(e.said, Catch::Contains("has no TEXCOORD_3"));
    CHECK(e.shape().mesh->uvs == std::vector<glm::vec2>(4, glm::vec2(0)));

    Example missing;
    missing.gltf.add("images", {{"uri", "none.png"}});
    missing.gltf.add("textures", {{"source", 0}});
    const auto &bsdf = std::get<PrincipledBsdf>(missing.front(missing.load(
        pbr({{"baseColorTexture", {{"index", 0}}}, {"baseColorFactor", {.5, 1, 1, 1}}}))));
    CHECK(missing.texture_at(bsdf.base_color).value == Rgb(.5, 1, 1));
    CHECK_THAT(missing.said, Catch::Contains("none.png"));
}
