/// Scene files as other versions of Mitsuba have them: each rule of the table, against what the
/// same scene gives that is written with the names of today.

#include "mitsuba_text_scene.h"
#include "stderr_of.h"

#include <catch2/catch.hpp>

using namespace clrender;

namespace {

bool has(const std::string &text, const std::string &part) {
    return text.find(part) != std::string::npos;
}

/// The scene of a file of this version ("" for none), and what is said about it.
struct Loaded {
    Scene scene;
    std::string said;
};

Loaded load_version(const std::string &version, const std::string &content) {
    const test::ScratchFolder folder;
    const std::string path =
        folder.file("scene.xml", "<scene" + (version.empty() ? "" : " version='" + version + "'") +
                                     ">\n" + content + "\n</scene>\n");
    Loaded loaded;
    loaded.said = test::stderr_of([&] { loaded.scene = test::load(path); });
    return loaded;
}

Scene load_old(const std::string &content) {
    return load_version("0.6.0", content).scene;
}

std::string error_of_version(const std::string &version, const std::string &content) {
    return test::error_of([&] { load_version(version, content); });
}

const Texture &texture_of(const Scene &scene, int index) {
    return scene.textures.at(static_cast<std::size_t>(index));
}

template <class Model> const Model &model_of(const Scene &scene) {
    return std::get<Model>(scene.bsdfs.at(static_cast<std::size_t>(scene.shapes.at(0).bsdf)).model);
}

Rgb reflectance_of(const std::string &version, const std::string &colour) {
    const Loaded loaded = load_version(version, "<shape type='sphere'><bsdf type='diffuse'>" +
                                                    colour + "</bsdf></shape>");
    return texture_of(loaded.scene, model_of<DiffuseBsdf>(loaded.scene).reflectance).value;
}

void check_near(const Rgb &a, const Rgb &b, double tolerance = 1e-12) {
    CAPTURE(a.r, a.g, a.b, b.r, b.g, b.b);
    CHECK(glm::all(glm::lessThanEqual(glm::abs(a - b), Rgb(tolerance))));
}

std::string sensor(const std::string &content, const std::string &tag = "sensor") {
    return "<" + tag + " type='perspective'>" + content + "</" + tag + ">";
}

std::string textured(const std::string &content, const std::string &type = "checkerboard") {
    return "<shape type='sphere'><bsdf type='diffuse'><texture name='reflectance' type='" + type +
           "'>" + content + "</texture></bsdf></shape>";
}

const Texture &texture_in(const Scene &scene) {
    return texture_of(scene, model_of<DiffuseBsdf>(scene).reflectance);
}

} // namespace

TEST_CASE("names in camelCase are those in snake case", "[dialect]") {
    const Scene scene = load_old(R"(
<integrator type="path"><integer name="maxDepth" value="7"/><integer name="rrDepth" value="3"/>
  <boolean name="hideEmitters" value="true"/><boolean name="strictNormals" value="false"/></integrator>
<sensor type="thinlens"><string name="focalLength" value="35mm"/><float name="apertureRadius" value=".1"/>
  <float name="focusDistance" value="3"/><float name="nearClip" value=".5"/><float name="farClip" value="50"/>
  <transform name="toWorld"><lookAt origin="0,1,4" target="0,.4,0" up="0,1,0"/></transform>
  <sampler type="halton"><integer name="sampleCount" value="77"/><integer name="scramble" value="-1"/></sampler>
  <film type="hdrfilm"><integer name="width" value="40"/><integer name="height" value="30"/>
    <integer name="cropOffsetX" value="4"/><integer name="cropOffsetY" value="5"/>
    <integer name="cropWidth" value="20"/><integer name="cropHeight" value="10"/>
    <string name="pixelFormat" value="luminanceAlpha"/><boolean name="highQualityEdges" value="true"/>
    <boolean name="attachLog" value="false"/><boolean name="banner" value="false"/></film></sensor>
<shape type="sphere"><boolean name="flipNormals" value="true"/>
  <bsdf type="roughplastic"><string name="distribution" value="ggx"/><float name="alpha" value=".05"/>
    <string name="intIOR" value="bk7"/><float name="extIOR" value="1.1"/>
    <rgb name="diffuseReflectance" value="1,.5,.25"/></bsdf></shape>)");
    CHECK(scene.integrator.max_depth == 7);
    CHECK(scene.integrator.rr_depth == 3);
    CHECK(scene.integrator.hide_emitters);
    CHECK(scene.sensor.aperture_radius == 0.1);
    CHECK(scene.sensor.focus_distance == 3);
    CHECK(scene.sensor.near_clip == 0.5);
    CHECK(scene.sensor.far_clip == 50.0);
    CHECK(scene.sensor.fov_axis == FovAxis::diagonal);
    CHECK(scene.sensor.to_world[3] == glm::dvec4(0, 1, 4, 1));
    CHECK(scene.sample_count == 77);
    CHECK(scene.film.crop_x == 4);
    CHECK(scene.film.crop_y == 5);
    CHECK(scene.film.crop_width == 20);
    CHECK(scene.film.crop_height == 10);
    CHECK(scene.film.sample_border);
    CHECK(scene.film.pixel_format == PixelFormat::luminance_alpha);
    CHECK(scene.shapes.at(0).flip_normals);
    const PlasticBsdf &plastic = model_of<RoughPlasticBsdf>(scene).plastic;
    check_near(texture_of(scene, plastic.diffuse_reflectance).value, Rgb(1, .5, .25));
    CHECK(plastic.ior.interior == 1.5046);
    CHECK(plastic.ior.exterior == 1.1);
}

TEST_CASE("a file of any version below 2, or of none, may have names of both kinds", "[dialect]") {
    const std::string both = "<integrator type='path'><integer name='max_depth' value='7'/>"
                             "<integer name='rrDepth' value='3'/></integrator>";
    for (const char *version : {"", "0.4.0", "0.5.0", "0.6.0", "0.6", "1.0.0"}) {
        CAPTURE(version);
        const Loaded loaded = load_version(version, both);
        CHECK(loaded.scene.integrator.max_depth == 7);
        CHECK(loaded.scene.integrator.rr_depth == 3);
        CHECK(has(loaded.said, "has no version") == std::string(version).empty());
    }
    for (const char *version : {"2.0.0", "2.2.1", "3.0.0"})
        CHECK(has(error_of_version(version, both),
                  "scene.xml:2: integrator \"path\" has the unknown property \"rrDepth\", did you "
                  "mean \"rr_depth\"?"));
    for (const char *version : {"4.0.0", "x", "0.6a", "-1"})
        CHECK(has(error_of_version(version, both), "scene.xml:1: version is "));
}

TEST_CASE("up to version 0.6 the last of two values holds, and types have any case", "[dialect]") {
    const std::string twice = "<integrator type='path'><integer name='maxDepth' value='7'/>\n"
                              "<integer name='max_depth' value='3'/></integrator>";
    const std::string capitals = "<integrator type='Path'/><shape type='Sphere'><bsdf "
                                 "type='Lambertian'><rgb name='reflectance' value='.25'/></bsdf>"
                                 "</shape>";
    for (const char *version : {"", "0.5.0", "0.6.0", "1.0.0"}) {
        CAPTURE(version);
        const Loaded loaded = load_version(version, twice);
        CHECK(loaded.scene.integrator.max_depth == 3);
        CHECK(has(loaded.said, "scene.xml:3: warning: \"max_depth\" is already set in line 2: this "
                               "value holds"));
        const Scene scene = load_version(version, capitals).scene;
        CHECK(scene.shapes.size() == 1);
        check_near(texture_in(scene).value, Rgb(.25));
    }
    const std::string today = "<integrator type='path'><integer name='max_depth' value='7'/>\n"
                              "<integer name='max_depth' value='3'/></integrator>";
    for (const char *version : {"2.0.0", "3.0.0"}) {
        CHECK(has(error_of_version(version, today), "3: \"max_depth\" is already set in line 2, "
                                                    "expected it once"));
        CHECK(
            has(error_of_version(version, capitals), "\"Sphere\" is not supported, did you mean"));
    }
}

TEST_CASE("every version of the names may be in an included file", "[dialect]") {
    const test::ScratchFolder folder;
    (void)folder.file("old.xml", "<scene version='0.5.0'>\n<integrator type='path'>"
                                 "<integer name='maxDepth' value='5'/></integrator></scene>");
    const std::string newer =
        folder.file("new.xml", "<scene version='3.0.0'><include filename='old.xml'/></scene>");
    CHECK(test::load(newer).integrator.max_depth == 5);
    (void)folder.file("wrong.xml", "<scene version='3.0.0'>\n<integrator type='path'>"
                                   "<integer name='maxDepth' value='5'/></integrator></scene>");
    const std::string older =
        folder.file("older.xml", "<scene version='0.6.0'><include filename='wrong.xml'/></scene>");
    CHECK(has(test::error_of([&] { test::load(older); }), "wrong.xml:2: "));
}

TEST_CASE("an object's type and values may be parameters", "[dialect]") {
    const Loaded loaded =
        load_version("0.5.0", "<default name='maxDepth' value='9'/><default name='kind' "
                              "value='diffuse'/><default name='tint' value='#ffffff'/>"
                              "<integrator type='path'><integer name='maxDepth' "
                              "value='$maxDepth'/></integrator><shape type='sphere'><bsdf "
                              "type='$kind'><srgb name='diffuseReflectance' value='$tint'/></bsdf>"
                              "</shape>");
    CHECK(loaded.scene.integrator.max_depth == 9);
    check_near(texture_in(loaded.scene).value, Rgb(1));
}

TEST_CASE("colours of the old forms", "[dialect]") {
    // IEC 61966-2-1: ((v + .055) / 1.055)^2.4, or v / 12.92 up to .04045.
    for (const char *version : {"0.6.0", "3.0.0"}) {
        CAPTURE(version);
        const Rgb decoded(std::pow((0xcc / 255.0 + .055) / 1.055, 2.4),
                          std::pow((0x88 / 255.0 + .055) / 1.055, 2.4), 0x08 / 255.0 / 12.92);
        check_near(reflectance_of(version, "<srgb name='reflectance' value='#cc8808'/>"), decoded);
        check_near(reflectance_of(version, "<srgb name='reflectance' value='#CC8808'/>"), decoded);
        check_near(reflectance_of(version, "<srgb name='reflectance' value='.2, .3,.04'/>"),
                   Rgb(std::pow(.255 / 1.055, 2.4), std::pow(.355 / 1.055, 2.4), .04 / 12.92));
        check_near(reflectance_of(version, "<srgb name='reflectance' value='.5'/>"),
                   Rgb(std::pow(.555 / 1.055, 2.4)));
        const Rgb bytes(0x10 / 255.0, 0x80 / 255.0, 1);
        check_near(reflectance_of(version, "<rgb name='reflectance' value='#1080ff'/>"), bytes);
        check_near(reflectance_of(version, "<spectrum name='reflectance' value='#1080ff'/>"),
                   bytes);
        check_near(reflectance_of(version, "<spectrum name='reflectance' value='.1, .2 .3'/>"),
                   Rgb(.1, .2, .3));
        check_near(reflectance_of(version, "<rgb name='reflectance' intent='reflectance' "
                                           "value='.1 .2 .3'/>"),
                   Rgb(.1, .2, .3));
    }
    CHECK(has(load_version("3.0.0", "<shape type='sphere'><bsdf type='diffuse'>\n<rgb "
                                    "name='reflectance' value='#102030'/></bsdf></shape>")
                  .said,
              "scene.xml:3: warning: the colour #102030 is taken as linear"));
    for (const char *wrong :
         {"#12345", "#1234567", "#12345g", "1,2", "", "red", "# 12345", "1,2,x"})
        CHECK(has(error_of_version("0.6.0", "<shape type='sphere'><bsdf type='diffuse'>\n<srgb "
                                            "name='reflectance' value='" +
                                                std::string(wrong) + "'/></bsdf></shape>"),
                  "scene.xml:3: "));
}

TEST_CASE("u and v are scaled, then moved", "[dialect]") {
    const Scene scene = load_old(textured("<float name='uscale' value='8'/><float name='vscale' "
                                          "value='4'/><float name='uoffset' value='.25'/><float "
                                          "name='voffset' value='.5'/>"));
    CHECK(texture_in(scene).to_uv * glm::dvec3(1, 1, 1) == glm::dvec3(8.25, 4.5, 1));
    const Scene one = load_old(textured("<float name='voffset' value='.5'/>"));
    CHECK(texture_in(one).to_uv * glm::dvec3(1, 1, 1) == glm::dvec3(1, 1.5, 1));
    const Scene scaled = load_old("<default name='times' value='3'/>" +
                                  textured("<float name='uscale' value='$times'/>"));
    CHECK(texture_in(scaled).to_uv * glm::dvec3(1, 1, 1) == glm::dvec3(3, 1, 1));
    CHECK(has(error_of_version("0.6.0", textured("\n<float name='uscale' value='many'/>")),
              "scene.xml:3: <scale> x is \"many\""));
    CHECK(has(error_of_version("3.0.0", textured("\n<float name='uscale' value='8'/>")),
              "scene.xml:3: texture \"checkerboard\" has the unknown property \"uscale\""));
}

TEST_CASE("filters and wrap modes of old bitmaps", "[dialect]") {
    const test::ScratchFolder folder;
    const std::string image = folder.file("a.pfm", "PF\n1 1\n-1.0\n" + std::string(12, '\0'));
    const auto bitmap = [&](const std::string &values) {
        return textured("<string name='filename' value='" + image + "'/>" + values, "bitmap");
    };
    for (const char *version : {"0.6.0", "3.0.0"})
        for (const char *filter : {"ewa", "trilinear", "EWA"}) {
            const std::string name = version[0] == '0' ? "filterType" : "filter_type";
            const Loaded loaded = load_version(
                version, bitmap("\n<string name='" + name + "' value='" + filter + "'/>"));
            CHECK(texture_in(loaded.scene).filter == TextureFilter::bilinear);
            CHECK(has(loaded.said, "scene.xml:3: warning: the texture is filtered bilinearly"));
        }
    const Scene same = load_old(bitmap("<string name='wrapModeU' value='clamp'/><string "
                                       "name='wrapModeV' value='clamp'/><float name='gamma' "
                                       "value='1'/><float name='maxAnisotropy' value='8'/>"
                                       "<boolean name='cache' value='true'/>"));
    CHECK(texture_in(same).wrap == TextureWrap::clamp);
    CHECK(texture_in(same).format.raw);
    CHECK(texture_in(load_old(bitmap("<string name='wrapMode' value='mirror'/>"))).wrap ==
          TextureWrap::mirror);
    CHECK(
        has(error_of_version("0.6.0", bitmap("\n<string name='wrapModeU' value='clamp'/>\n<string "
                                             "name='wrapModeV' value='repeat'/>")),
            "scene.xml:4: \"wrap_mode_v\" is \"repeat\", \"wrap_mode_u\" \"clamp\", expected one "
            "wrap mode for both"));
    CHECK(has(error_of_version("0.6.0", bitmap("\n<string name='wrapModeV' value='clamp'/>")),
              "scene.xml:3: \"wrap_mode_v\" is \"clamp\", \"wrap_mode_u\" \"repeat\""));
    CHECK(has(load_version("0.6.0", bitmap("<float name='gamma' value='1.8'/>")).said,
              "\"gamma\" is left out"));
    CHECK(load_version("0.6.0", bitmap("<float name='gamma' value='-1'/>")).said.find("gamma") ==
          std::string::npos);
}

TEST_CASE("an old film is one of today", "[dialect]") {
    const auto film = [](const std::string &type, const std::string &values) {
        return load_version("0.6.0", sensor("<film type='" + type + "'>" + values + "</film>"));
    };
    const Loaded ldr = film("ldrfilm", "<string name='fileFormat' value='png'/><string "
                                       "name='tonemapMethod' value='gamma'/><float name='gamma' "
                                       "value='-1'/><boolean name='banner' value='false'/>"
                                       "<string name='pixelFormat' value='rgba'/>");
    CHECK(ldr.scene.film.pixel_format == PixelFormat::rgba);
    CHECK(has(ldr.said, "scene.xml:2: warning: the film is read as \"hdrfilm\""));
    CHECK_FALSE(has(ldr.said, "left out"));
    CHECK(has(film("ldrfilm", "<float name='exposure' value='2'/>").said,
              "\"exposure\" is left out"));
    CHECK(has(film("ldrfilm", "<string name='tonemapMethod' value='reinhard'/>").said,
              "\"tonemap_method\" is left out"));
    CHECK_FALSE(has(film("hdrfilm", "").said, "read as"));
    CHECK(film("exrfilm", "<boolean name='alpha' value='true'/>").scene.film.pixel_format ==
          PixelFormat::rgba);
    CHECK(film("pngfilm", "<boolean name='alpha' value='false'/>").scene.film.pixel_format ==
          PixelFormat::rgb);
}

TEST_CASE("cameras and lights before version 0.4", "[dialect]") {
    const std::string placed =
        "<transform name='toWorld'><matrix value='1 0 0 1  0 1 0 2  0 0 1 3  0 0 0 1'/></transform>"
        "<film type='hdrfilm'><integer name='width' value='64'/></film>";
    const Scene scene = load_version("0.3.0", sensor(placed, "camera")).scene;
    CHECK(scene.sensor.to_world * glm::dvec4(1, 1, 1, 1) == glm::dvec4(0, 3, 4, 1));
    CHECK(scene.sensor.fov_axis == FovAxis::diagonal); // that of the lens of 50 mm
    const std::string fov = "<float name='fov' value='30'/>";
    CHECK(load_version("0.3.0", sensor(fov, "camera")).scene.sensor.fov_axis == FovAxis::smaller);
    CHECK(load_version("0.3.0",
                       sensor(fov + "<boolean name='mapSmallerSide' value='false'/>", "camera"))
              .scene.sensor.fov_axis == FovAxis::larger);
    CHECK(load_old(sensor(fov)).sensor.fov_axis == FovAxis::x);

    const Scene lit = load_version("0.3.0", "<shape type='sphere'><luminaire type='area'>"
                                            "<rgb name='intensity' value='3'/></luminaire></shape>"
                                            "<luminaire type='constant'><rgb name='intensity' "
                                            "value='5'/></luminaire><luminaire type='point'><rgb "
                                            "name='intensity' value='7'/></luminaire>")
                          .scene;
    REQUIRE(lit.emitters.size() == 3);
    check_near(texture_of(lit, lit.emitters.at(0).radiance).value, Rgb(3));
    check_near(texture_of(lit, lit.emitters.at(1).radiance).value, Rgb(5));
    check_near(lit.emitters.at(2).intensity, Rgb(7));
}

TEST_CASE("old names of materials", "[dialect]") {
    const auto shape = [](const std::string &bsdf) {
        return "<shape type='sphere'>" + bsdf + "</shape>";
    };
    const Scene lambertian =
        load_old(shape("<bsdf type='lambertian'><rgb name='reflectance' value='.25'/></bsdf>"));
    check_near(texture_in(lambertian).value, Rgb(.25));
    const Scene mirror = load_old(shape("<bsdf type='mirror'/>"));
    const Scene chrome =
        load_old(shape("<bsdf type='conductor'><string name='material' value='Cr'/></bsdf>"));
    CHECK(model_of<ConductorBsdf>(mirror).eta == model_of<ConductorBsdf>(chrome).eta);
    const Scene rough = load_old(shape("<bsdf type='roughglass'><float name='alphaB' value='.3'/>"
                                       "<float name='intIOR' value='1.7'/></bsdf>"));
    CHECK(model_of<RoughDielectricBsdf>(rough).ior.interior == 1.7);
    check_near(texture_of(rough, model_of<RoughDielectricBsdf>(rough).microfacets.alpha_u).value,
               Rgb(.3));
    const Scene squares = load_old(textured("<rgb name='brightColor' value='.7'/><rgb "
                                            "name='darkColor' value='.1'/>"));
    check_near(texture_in(squares).color0, Rgb(.7));
    check_near(texture_in(squares).color1, Rgb(.1));

    // Mitsuba 0.6 took copper for a metal without a name.
    CHECK(has(load_version("0.6.0", shape("<bsdf type='conductor'/>")).said, "copper"));
    CHECK_FALSE(has(load_version("3.0.0", shape("<bsdf type='conductor'/>")).said, "copper"));
}

TEST_CASE("faults are told at the lines of the file", "[dialect]") {
    CHECK(has(error_of_version("0.6.0", "<camera type='perspective'>\n<transform "
                                        "name='toWorld'>\n<lookAt origin='1 2'/></transform>"
                                        "</camera>"),
              "scene.xml:4: <lookat> has no attribute \"target\""));
    CHECK(has(error_of_version("0.4.0", "\n<camera type='perspective'>\n<float name='fov' "
                                        "value='0'/></camera>"),
              "scene.xml:4: sensor \"perspective\": \"fov\" is out of range"));
    CHECK(has(error_of_version("0.4.0", "\n<luminaire type='laser'/>"),
              "scene.xml:3: emitter of type \"laser\" is not supported"));
    CHECK(has(error_of_version("0.6.0", "<shape type='sphere'>\n<srgb name='radius' "
                                        "value='#ffffff'/></shape>"),
              "scene.xml:3: shape \"sphere\": \"radius\" is an rgb, expected a float"));
}
