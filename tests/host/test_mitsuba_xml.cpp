/// What the reader of scene files makes of every kind of element. The expected numbers are those of
/// Mitsuba 3.9.1, scalar_rgb.

#include "image/image.h"
#include "mitsuba_text_scene.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>

using namespace clrender;
using namespace test;

namespace {

void check_rgb(const Rgb &actual, const Rgb &expected) {
    CHECK(actual.r == Approx(expected.r).epsilon(1e-4).margin(1e-7));
    CHECK(actual.g == Approx(expected.g).epsilon(1e-4).margin(1e-7));
    CHECK(actual.b == Approx(expected.b).epsilon(1e-4).margin(1e-7));
}

void check_matrix(const glm::dmat4 &actual, const std::array<double, 16> &rows) {
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column)
            CHECK(actual[column][row] ==
                  Approx(rows.at(static_cast<std::size_t>(4 * row + column))).margin(2e-6));
}

Rgb reflectance(const std::string &value) {
    const Scene scene =
        load_text(R"(<shape type="sphere"><bsdf type="diffuse">)" + value + "</bsdf></shape>");
    const auto &diffuse = std::get<DiffuseBsdf>(scene.bsdfs.at(0).model);
    return scene.textures.at(static_cast<std::size_t>(diffuse.reflectance)).value;
}

Rgb intensity(const std::string &value) {
    return load_text(R"(<emitter type="point">)" + value + "</emitter>").emitters.at(0).intensity;
}

template <typename Model> Model bsdf(const std::string &type, const std::string &content) {
    return std::get<Model>(load_text(R"(<shape type="sphere"><bsdf type=")" + type + "\">" +
                                     content + "</bsdf></shape>")
                               .bsdfs.at(0)
                               .model);
}

glm::dmat4 transform(const std::string &steps) {
    return load_text(R"(<shape type="rectangle"><transform name="to_world">)" + steps +
                     "</transform></shape>")
        .shapes.at(0)
        .to_world;
}

Sensor sensor(const std::string &content, const std::string &type = "perspective") {
    return load_text("<sensor type=\"" + type + "\">" + content + "</sensor>").sensor;
}

} // namespace

TEST_CASE("colours of reflectances") {
    check_rgb(reflectance(""), Rgb(.5));
    check_rgb(reflectance(R"(<rgb name="reflectance" value=".1, .2 .3"/>)"), {.1, .2, .3});
    check_rgb(reflectance(R"(<rgb name="reflectance" value=" +.4 "/>)"), Rgb(.4));
    check_rgb(reflectance(R"(<float name="reflectance" value="0.3"/>)"), Rgb(.3));
    check_rgb(reflectance(R"(<spectrum name="reflectance" value=".7"/>)"), Rgb(.7));
    check_rgb(reflectance(R"(<spectrum name="reflectance" value="360:1, 830:1"/>)"),
              {.998985, .998874, .998802});
    check_rgb(
        reflectance(R"(<spectrum name="reflectance" value="400:0.1, 500:0.5 600:.9, 700:.2"/>)"),
        {.833826, .689122, .265243});
    check_rgb(reflectance(R"(<spectrum name="reflectance" value="400:.1 430:.5 600:.9 700:.2"/>)"),
              {.796836, .782257, .512216});
    check_rgb(reflectance(R"(<spectrum name="reflectance" value="500:1 510:1"/>)"),
              {0, .0781108, .0146232});
    check_rgb(reflectance(R"(<spectrum name="reflectance" value="400:10 500:5 600:9 700:2"/>)"),
              Rgb(1));
}

TEST_CASE("colours of lights") {
    check_rgb(intensity(""), Rgb(1));
    check_rgb(intensity(R"(<rgb name="intensity" value="2 3 4"/>)"), {2, 3, 4});
    check_rgb(intensity(R"(<float name="intensity" value="2"/>)"), Rgb(2));
    check_rgb(intensity(R"(<spectrum name="intensity" value="0.7"/>)"),
              {.843356, .663804, .636241});
    check_rgb(intensity(R"(<spectrum name="intensity" value="360:1, 830:1"/>)"),
              {1.20488, .948228, .909267});
    check_rgb(intensity(R"(<spectrum name="intensity" value="400:10, 500:5, 600:9, 700:2"/>)"),
              {10.0209, 6.26511, 6.69116});
    check_rgb(intensity(R"(<spectrum name="intensity" value="500:1, 510:1"/>)"),
              {0, .0712441, .0133142});
    check_rgb(
        intensity(
            R"(<spectrum name="intensity" type="d65"><float name="scale" value="3"/></spectrum>)"),
        Rgb(3));
}

TEST_CASE("conductors") {
    const auto mirror = bsdf<ConductorBsdf>("conductor", "");
    CHECK(mirror.perfect_mirror);
    const auto gold = bsdf<ConductorBsdf>("conductor", R"(<string name="material" value="Au"/>)");
    CHECK_FALSE(gold.perfect_mirror);
    check_rgb(gold.eta, {.143036, .375307, 1.442045});
    check_rgb(gold.k, {3.982997, 2.385557, 1.603359});
    const auto stated =
        bsdf<ConductorBsdf>("conductor", R"(<spectrum name="eta" value="400:10 500:5 600:9 700:2"/>
                                             <rgb name="k" value="1 2 3"/>)");
    check_rgb(stated.eta, {8.59416, 6.54435, 7.29033});
    check_rgb(stated.k, {1, 2, 3});
}

TEST_CASE("dielectrics") {
    const IndicesOfRefraction glass = bsdf<DielectricBsdf>("dielectric", "").ior;
    CHECK(glass.interior == 1.5046);
    CHECK(glass.exterior == 1.000277);
    const auto named =
        bsdf<DielectricBsdf>("dielectric", R"(<string name="int_ior" value="Diamond"/>
                                             <float name="ext_ior" value="1.3"/>)");
    CHECK(named.ior.interior == 2.419);
    CHECK(named.ior.exterior == 1.3);
}

TEST_CASE("rough conductors") {
    const Scene scene = load_text(R"(<shape type="sphere"><bsdf type="roughconductor">
        <string name="material" value="Au"/><string name="distribution" value="ggx"/>
        <rgb name="alpha_u" value=".1 .2 .6"/><float name="alpha_v" value=".4"/>
        <boolean name="sample_visible" value="false"/></bsdf></shape>)");
    const auto &rough = std::get<RoughConductorBsdf>(scene.bsdfs.at(0).model);
    const auto value = [&](int texture) {
        return scene.textures.at(static_cast<std::size_t>(texture)).value;
    };
    CHECK(rough.microfacets.kind == MicrofacetKind::ggx);
    check_rgb(value(rough.microfacets.alpha_u), Rgb(.3));
    check_rgb(value(rough.microfacets.alpha_v), Rgb(.4));
    check_rgb(value(rough.eta), {.143036, .375307, 1.442045});
    const auto plain = bsdf<RoughConductorBsdf>("roughconductor", "");
    CHECK(plain.microfacets.kind == MicrofacetKind::beckmann);
    CHECK(plain.microfacets.alpha_u == plain.microfacets.alpha_v);
    const auto error = [](const std::string &type, const std::string &content) {
        return error_of_text("<shape type='sphere'><bsdf type='" + type + "'>" + content +
                             "</bsdf></shape>");
    };
    CHECK_THAT(error("roughconductor", "<float name='alpha_u' value='.1'/>"),
               Catch::Contains("expected both alpha_u and alpha_v"));
    CHECK_THAT(error("roughconductor", "<float name='alpha_u' value='.1'/><float name='alpha_v' "
                                       "value='.1'/><float name='alpha' value='.1'/>"),
               Catch::Contains("expected only one of them"));
    CHECK_THAT(error("roughdielectric", "<float name='int_ior' value='1.5'/><float name='ext_ior' "
                                        "value='1.5'/>"),
               Catch::Contains("expected two different indices"));
    CHECK_THAT(error("mask", ""), Catch::Contains("has 0 nested BSDFs, expected one"));
    CHECK_THAT(error("blendbsdf", "<bsdf type='diffuse'/><bsdf type='diffuse'/>"),
               Catch::Contains("\"weight\" is missing"));
    CHECK_THAT(error("normalmap", "<bsdf type='diffuse'/>"),
               Catch::Contains("\"normalmap\" is missing"));
    CHECK_THAT(error("bumpmap", "<texture type='checkerboard'/><bsdf type='mask'>"
                                "<bsdf type='normalmap'><rgb name='normalmap' value='.5 .5 1'/>"
                                "<bsdf type='diffuse'/></bsdf></bsdf>"),
               Catch::Contains("nests another normal or bump map"));
    CHECK_THAT(error("bumpmap", "<bsdf type='diffuse'/>"),
               Catch::Contains("has 0 nested textures, expected one"));
    CHECK_THAT(error("twosided", "<bsdf type='mask'><bsdf type='diffuse'/></bsdf>"),
               Catch::Contains("contains a mask, expected a BSDF that lets no light through"));
}

TEST_CASE("twosided takes one or two BSDFs, also by reference") {
    const Scene scene = load_text(R"(<bsdf type="diffuse" id="a"/>
        <shape type="sphere"><bsdf type="twosided"><ref id="b"/><ref id="a"/></bsdf></shape>
        <shape type="sphere"><bsdf type="twosided"><ref id="a"/></bsdf></shape>
        <bsdf type="conductor" id="b"/>)");
    const auto &two = std::get<TwosidedBsdf>(
        scene.bsdfs.at(static_cast<std::size_t>(scene.shapes.at(0).bsdf)).model);
    CHECK(scene.bsdfs.at(static_cast<std::size_t>(two.front)).id == "b");
    CHECK(scene.bsdfs.at(static_cast<std::size_t>(two.back)).id == "a");
    const auto &one = std::get<TwosidedBsdf>(
        scene.bsdfs.at(static_cast<std::size_t>(scene.shapes.at(1).bsdf)).model);
    CHECK(one.front == one.back);
    CHECK(one.front == two.back);
}

TEST_CASE("steps of a transformation apply one after the other") {
    check_matrix(transform(R"(<translate x="1"/><scale value="2"/>)"),
                 {2, 0, 0, 2, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1});
    check_matrix(transform(R"(<rotate value="0 1 0" angle="90"/><translate z="1"/>)"),
                 {0, 0, 1, 0, 0, 1, 0, 0, -1, 0, 0, 1, 0, 0, 0, 1});
    check_matrix(transform(R"(<matrix value="1 2 0 0 1 1 0 0 4"/>)"),
                 {1, 2, 0, 0, 0, 1, 1, 0, 0, 0, 4, 0, 0, 0, 0, 1});
    check_matrix(transform(R"(<lookat origin="1 2 3" target="1 2 8" up="0 3 1"/>)"),
                 {1, 0, 0, 1, 0, 1, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1});

    // Mitsuba 3 takes the axis as it is, even where the result is no rotation.
    check_matrix(transform(R"(<rotate x="1" y="2" angle="33"/>)"),
                 {1, .32265887, 1.0892781, 0, .32265887, 1.4839883, -.54463905, 0, -1.0892781,
                  .54463905, .83867055, 0, 0, 0, 0, 1});
}

TEST_CASE("spheres fold centre and radius into their transformation") {
    const Scene scene = load_text(R"(<shape type="sphere">
        <transform name="to_world"><scale value="2"/></transform>
        <point name="center" x="1" y="2" z="3"/><float name="radius" value="5"/></shape>)");
    check_matrix(scene.shapes.at(0).to_world, {10, 0, 0, 2, 0, 10, 0, 4, 0, 0, 10, 6, 0, 0, 0, 1});
    CHECK_FALSE(scene.shapes.at(0).flip_normals);
}

TEST_CASE("the cube is a mesh of six faces") {
    const Scene scene = load_text(R"(<shape type="cube"/>)");
    const Mesh &cube = *scene.shapes.at(0).mesh;
    REQUIRE(cube.positions.size() == 24);
    REQUIRE(cube.triangles.size() == 12);
    for (const auto &[a, b, c] : cube.triangles) {
        const glm::dvec3 normal =
            glm::normalize(glm::cross(cube.positions.at(b) - cube.positions.at(a),
                                      cube.positions.at(c) - cube.positions.at(a)));
        CHECK(glm::distance(glm::dvec3(cube.normals.at(a)), normal) < 1e-6);
        CHECK(glm::dot(normal, cube.positions.at(a)) == Approx(1));
    }
    CHECK(cube.positions.at(0) == glm::dvec3(1, -1, -1));
    CHECK(cube.uvs.at(0) == glm::vec2(0, 1));
}

TEST_CASE("shapes without a BSDF are grey, lights black") {
    const Scene scene = load_text(R"(<shape type="disk"/>
        <shape type="rectangle"><emitter type="area"/></shape>)");
    const auto albedo = [&](std::size_t shape) {
        const auto &surface = std::get<DiffuseBsdf>(
            scene.bsdfs.at(static_cast<std::size_t>(scene.shapes.at(shape).bsdf)).model);
        return scene.textures.at(static_cast<std::size_t>(surface.reflectance)).value;
    };
    CHECK(albedo(0) == Rgb(.5));
    CHECK(albedo(1) == Rgb(0));
    CHECK(scene.shapes.at(1).emitter == 0);
    CHECK(scene.emitters.at(0).shape == 1);
}

TEST_CASE("cameras") {
    const Sensor lens = sensor("");
    CHECK(lens.fov == Approx(46.7930)); // 50 mm
    CHECK(lens.fov_axis == FovAxis::diagonal);
    CHECK_FALSE(lens.near_clip);
    CHECK(sensor(R"(<string name="focal_length" value="21.6333mm"/>)").fov == Approx(90));

    const Sensor wide = sensor(R"(<float name="fov" value="60"/>
        <string name="fov_axis" value="smaller"/><float name="near_clip" value=".5"/>
        <float name="principal_point_offset_y" value=".25"/>)");
    CHECK(wide.fov == 60);
    CHECK(wide.fov_axis == FovAxis::smaller);
    CHECK(wide.near_clip == .5);
    CHECK_FALSE(wide.far_clip);
    CHECK(wide.principal_point_offset == glm::dvec2(0, .25));

    const Sensor thin = sensor(R"(<float name="aperture_radius" value=".1"/>
        <float name="focus_distance" value="7"/>)",
                               "thinlens");
    CHECK(thin.kind == SensorKind::thinlens);
    CHECK(thin.aperture_radius == .1);
    CHECK(thin.focus_distance == 7);
}

TEST_CASE("films and filters") {
    const Scene plain = load_text(R"(<sensor type="perspective"/>)");
    CHECK(plain.sample_count == 4);
    CHECK(plain.film.crop_width == 768);
    CHECK(plain.film.filter.kind == FilterKind::gaussian);

    const Scene scene = load_text(R"(<sensor type="perspective"><film type="hdrfilm">
        <integer name="width" value="100"/><integer name="height" value="50"/>
        <integer name="crop_offset_x" value="10"/><integer name="crop_width" value="20"/>
        <string name="pixel_format" value="RGBA"/>
        <string name="component_format" value="float32"/>
        <rfilter type="mitchell"><float name="B" value=".25"/></rfilter></film>
        <sampler type="whatever"><integer name="sample_count" value="64"/>
        <integer name="seed" value="7"/></sampler></sensor>)");
    CHECK(scene.film.width == 100);
    CHECK(scene.film.crop_x == 10);
    CHECK(scene.film.crop_width == 20);
    CHECK(scene.film.crop_height == 50);
    CHECK(scene.film.pixel_format == PixelFormat::rgba);
    CHECK(scene.film.filter.kind == FilterKind::mitchell);
    CHECK(scene.film.filter.b == .25);
    CHECK(scene.film.filter.c == Approx(1. / 3));
    CHECK(scene.sample_count == 64);
}

TEST_CASE("integrators") {
    const auto integrator = [](const std::string &xml) { return load_text(xml).integrator; };
    CHECK(integrator("").max_depth == -1);
    CHECK_FALSE(integrator("").rr_depth.has_value());
    const Integrator path = integrator(R"(<integrator type="path">
        <integer name="max_depth" value="7"/><integer name="rr_depth" value="9"/>
        <boolean name="hide_emitters" value="TRUE"/><integer name="samples_per_pass" value="1"/>
        </integrator>)");
    CHECK(path.max_depth == 7);
    CHECK(path.rr_depth == 9);
    CHECK(path.hide_emitters);
    const Integrator direct = integrator(R"(<integrator type="moment"><integrator type="direct">
        <integer name="emitter_samples" value="3"/><integer name="bsdf_samples" value="0"/>
        </integrator></integrator>)");
    CHECK(direct.kind == IntegratorKind::direct);
    CHECK(direct.emitter_samples == 3);
    CHECK(direct.bsdf_samples == 0);
    CHECK(integrator(R"(<integrator type="depth"/>)").kind == IntegratorKind::depth);
}

TEST_CASE("textures") {
    const Scene scene = load_text(R"(<shape type="sphere"><bsdf type="diffuse">
        <texture type="checkerboard" name="reflectance"><rgb name="color0" value=".1 .2 .3"/>
        <transform name="to_uv"><scale x="2" y="3"/><translate x=".1"/></transform></texture>
        </bsdf></shape>)");
    const auto &diffuse = std::get<DiffuseBsdf>(scene.bsdfs.at(0).model);
    const Texture &board = scene.textures.at(static_cast<std::size_t>(diffuse.reflectance));
    CHECK(board.kind == TextureKind::checkerboard);
    check_rgb(board.color0, {.1, .2, .3});
    check_rgb(board.color1, Rgb(.2));
    const glm::dvec3 uv = board.to_uv * glm::dvec3(1, 1, 1);
    CHECK(uv.x == Approx(2.1));
    CHECK(uv.y == Approx(3));
}

TEST_CASE("pictures of scenes hold finite values, and none below zero") {
    const ScratchFolder folder;
    const auto pfm = [&](float value) {
        const float pixels[12] = {1, 2, 3, 4, 5, value, 7, 8, 9, 10, 11, 12};
        return folder.file("map.pfm",
                           "Pf\n3 4\n-1\n" +
                               std::string(reinterpret_cast<const char *>(pixels), sizeof(pixels)));
    };
    const auto load = [&](float value) {
        return load_text(R"(<emitter type="envmap"><string name="filename" value=")" + pfm(value) +
                         R"("/></emitter>)");
    };
    for (const auto &[value, instead] : {std::pair{std::numeric_limits<float>::quiet_NaN(), 0.0F},
                                         {std::numeric_limits<float>::infinity(), 12.0F},
                                         {-6.0F, 0.0F}}) {
        const Scene scene = load(value);
        CHECK(scene.emitters.at(0).bitmap->f32.at(8) == instead); // PFM: the bottom row comes first
    }
}
