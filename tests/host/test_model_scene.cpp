#include "scene/model_scene.h"

#include "files.h"
#include "stderr_of.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>
#include <limits>

using namespace clrender;

namespace {

const std::string data = std::string(CLRENDER_TEST_DIR) + "/host/data/";

} // namespace

TEST_CASE("a bare model becomes a scene with a floor, two lights and a camera", "[model]") {
    const Scene scene = load_model(data + "quad.obj");
    CHECK(scene.name == "quad");
    CHECK(scene.film.width == 768);
    CHECK(scene.film.crop_height == 576);
    CHECK(scene.sample_count == 64);
    CHECK(scene.integrator.max_depth == 8);
    REQUIRE(scene.shapes.size() == 3);
    REQUIRE(scene.emitters.size() == 2);
    CHECK(scene.shapes[2].emitter == 0);
    CHECK(scene.emitters[0].shape == 2);
    for (const Shape &shape : scene.shapes)
        CHECK(static_cast<std::size_t>(shape.bsdf) < scene.bsdfs.size());
}

TEST_CASE("the camera frames every vertex", "[model]") {
    const Scene scene = load_model(data + "quad.obj");
    const glm::dmat4 to_camera = glm::inverse(scene.sensor.to_world);
    const double half_width = std::tan(glm::radians(0.5 * scene.sensor.fov));
    for (const glm::dvec3 &p : scene.shapes[0].mesh->positions) {
        const glm::dvec4 seen = to_camera * glm::dvec4(p, 1);
        CHECK(seen.z > 0);
        CHECK(std::abs(seen.x / seen.z) < half_width);
        CHECK(std::abs(seen.y / seen.z) < half_width * 0.75);
    }
    CHECK(glm::determinant(scene.sensor.to_world) == Approx(1));
    CHECK(scene.sensor.to_world[1].y > 0);
}

TEST_CASE("MTL materials become BSDFs and lights", "[model]") {
    const Scene scene = load_model(data + "materials.obj");
    REQUIRE(scene.shapes.size() == 5);
    const auto &clay =
        std::get<TwosidedBsdf>(scene.bsdfs[static_cast<std::size_t>(scene.shapes[1].bsdf)].model);
    const auto &front =
        std::get<DiffuseBsdf>(scene.bsdfs[static_cast<std::size_t>(clay.front)].model);
    CHECK(scene.textures[static_cast<std::size_t>(front.reflectance)].value == Rgb(0.8, 0.1, 0.1));
    REQUIRE(scene.shapes[2].emitter == 0);
    const auto radiance = static_cast<std::size_t>(scene.emitters[0].radiance);
    CHECK(scene.textures[radiance].value == Rgb(4));
}

TEST_CASE("glass and mirrors from an MTL", "[model]") {
    const Scene scene = load_model(data + "glass.obj");
    const auto &glass =
        std::get<DielectricBsdf>(scene.bsdfs[static_cast<std::size_t>(scene.shapes[0].bsdf)].model);
    CHECK(glass.ior.interior == 1.33);
    const auto &mirror =
        std::get<ConductorBsdf>(scene.bsdfs[static_cast<std::size_t>(scene.shapes[1].bsdf)].model);
    CHECK(mirror.perfect_mirror);
}

TEST_CASE("MTL gloss, roughness, holes and maps become BSDFs around each other", "[model]") {
    const test::ScratchFolder folder;
    std::string bytes(3 * sizeof(float), '\0');
    (void)folder.file("t.pfm", "PF\n1 1\n-1\n" + bytes);
    const std::string model =
        folder.file("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
    Scene scene;
    const auto load = [&](const std::string &statements) {
        (void)folder.file("m.mtl", "newmtl a\n" + statements);
        scene = load_model(model);
        return scene.bsdfs[static_cast<std::size_t>(scene.shapes[0].bsdf)].model;
    };
    const auto nested = [&](int bsdf) { return scene.bsdfs[static_cast<std::size_t>(bsdf)].model; };
    const auto number = [&](int texture) {
        return scene.textures[static_cast<std::size_t>(texture)].value.x;
    };
    const auto front = [&](const BsdfModel &both) {
        return nested(std::get<TwosidedBsdf>(both).front);
    };

    const std::string held =
        test::stderr_of([&] { (void)load("Kd 1.5 .5 -1\nKs .2 .2 .2\nNs 98\n"); });
    CHECK(held.find("material \"a\": its colour 1.5 0.5 -1 is held to 0 to 1") !=
          std::string::npos);
    const std::string fine =
        test::stderr_of([&] { (void)load("Kd 1 .5 0\nKs .2 .2 .2\nNs 98\n"); });
    CHECK(fine.find("is held to") == std::string::npos);

    const auto gloss = std::get<RoughPlasticBsdf>(front(load("Kd .5 .5 .5\nKs .5 .5 .5\nNs 98\n")));
    CHECK(gloss.alpha == Approx(std::sqrt(0.02)));
    const double eta = gloss.plastic.ior.interior;
    CHECK((eta - 1) * (eta - 1) / ((eta + 1) * (eta + 1)) == Approx(0.04));

    const auto metal = std::get<RoughConductorBsdf>(front(load("Ks .9 .8 .6\nNs 6\n")));
    CHECK(number(metal.microfacets.alpha_u) == Approx(0.5));
    CHECK(std::holds_alternative<ConductorBsdf>(load("Ks .9 .8 .6\n")));

    const auto physical = std::get<PrincipledBsdf>(
        front(load("Kd .5 .5 .5\nPr .3\nPm 1\nPc .5\nPcr .2\naniso .4\nmap_Ps t.pfm\n")));
    CHECK(number(physical.roughness) == 0.3);
    CHECK(number(physical.metallic) == 1);
    CHECK(number(physical.clearcoat_gloss) == 0.8);
    CHECK(number(physical.anisotropic) == 0.4);
    CHECK(scene.textures[static_cast<std::size_t>(physical.sheen)].is_number);

    const auto holes = std::get<MaskBsdf>(load("Kd .5 .5 .5\nmap_d t.pfm\nnorm t.pfm\n"));
    const auto bent = std::get<NormalMapBsdf>(front(nested(holes.nested)));
    CHECK(std::holds_alternative<DiffuseBsdf>(nested(bent.nested)));
    CHECK(number(std::get<MaskBsdf>(load("Kd .5 .5 .5\nd .25\n")).opacity) == 0.25);
    const auto bumps = std::get<BumpMapBsdf>(front(load("Kd .5 .5 .5\nbump -bm 2 t.pfm\n")));
    CHECK(bumps.scale == 2);
}

TEST_CASE("textures of a model are read once, and checked", "[model]") {
    const test::ScratchFolder folder;
    const std::string model = folder.file("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
                                                   "usemtl a\nf 1 2 3\nusemtl b\nf 3 2 1\n");
    const std::string materials =
        folder.file("m.mtl", "newmtl a\nmap_Kd t.pfm\nnewmtl b\nmap_Kd t.pfm\n");
    CAPTURE(materials);
    const auto write_texture = [&](float value) {
        std::string bytes(3 * sizeof(float), '\0');
        for (std::size_t i = 0; i < 3; ++i)
            std::memcpy(&bytes[i * sizeof(float)], &value, sizeof(float));
        (void)folder.file("t.pfm", "PF\n1 1\n-1\n" + bytes);
    };

    write_texture(0.5F);
    const Scene scene = load_model(model);
    std::vector<std::shared_ptr<const Image>> bitmaps;
    for (const Texture &texture : scene.textures)
        if (texture.bitmap)
            bitmaps.push_back(texture.bitmap);
    REQUIRE(bitmaps.size() == 2);
    CHECK(bitmaps[0] == bitmaps[1]);
    CHECK(bitmaps[0]->f32.at(0) == 0.5F);

    write_texture(std::numeric_limits<float>::quiet_NaN());
    CHECK(test::stderr_of([&] { load_model(model); }).find("3 values are not a number") !=
          std::string::npos);
}
