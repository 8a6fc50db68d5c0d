/// What is said about scenes that are wrong: the right thing, at full length, once.

#include "flatten/flat_scene.h"
#include "mitsuba_text_scene.h"
#include "stderr_of.h"

#include <catch2/catch.hpp>

using namespace clrender;
using test::error_of_text;

namespace {

bool has(const std::string &text, const std::string &part) {
    return text.find(part) != std::string::npos;
}

std::size_t count(const std::string &text, const std::string &part) {
    std::size_t found = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
        ++found;
    return found;
}

std::string error_of_bsdf(const std::string &type) {
    return error_of_text("<shape type='sphere'><bsdf type='" + type + "'/></shape>");
}

} // namespace

TEST_CASE("another word is suggested only for a misspelling", "[messages]") {
    for (const char *type : {"velvet", "subsurface", "carpaint"}) {
        CAPTURE(type);
        CHECK(has(error_of_bsdf(type), "expected one of: "));
        CHECK_FALSE(has(error_of_bsdf(type), "did you mean"));
    }
    for (const auto &[type, meant] : {std::pair{"conducter", "conductor"},
                                      {"difuse", "diffuse"},
                                      {"Diffuse", "diffuse"},
                                      {"dieletcric", "dielectric"},
                                      {"two_sided", "twosided"},
                                      {"conductors", "conductor"}}) {
        CAPTURE(type);
        CHECK(has(error_of_bsdf(type), "did you mean \"" + std::string(meant) + "\"?"));
    }
    for (const char *type : {"cylinder", "instance", "serialized", "hair", "shapegroup"})
        CHECK_FALSE(
            has(error_of_text("<shape type='" + std::string(type) + "'/>"), "did you mean"));
    CHECK(has(error_of_text("<sensor type='perspective'><transform name='toWorld'/></sensor>"),
              "did you mean \"to_world\"?"));
    CHECK_FALSE(has(error_of_text("<integrator type='volume'/>"), "did you mean"));
    CHECK_FALSE(has(error_of_text("<emitter type='spot'/>"), "did you mean"));
}

TEST_CASE("BSDFs that are not built are named with the nearest that is", "[messages]") {
    for (const char *type : {"phong", "ward", "coating", "roughdiffuse", "hair", "measured",
                             "pplastic", "polarizer", "circular", "retarder"}) {
        CAPTURE(type);
        CHECK(has(error_of_bsdf(type),
                  "bsdf \"" + std::string(type) + "\" is not supported, the nearest that is: "));
    }
}

TEST_CASE("a <ref> to nothing says what there is", "[messages]") {
    const std::string shape = "<shape type='sphere'><ref id='light'/></shape>";
    CHECK(error_of_text(shape) ==
          "2: <ref> to the unknown id \"light\", but no object of the scene has an id");
    std::string many;
    for (int i = 0; i < 100; ++i)
        many += "<bsdf type='diffuse' id='material" + std::to_string(i) + "'/>";
    const std::string error = error_of_text(many + shape);
    CHECK(has(error, "expected one of: material0, "));
    CHECK(has(error, ", ... (100 in all)"));
}

TEST_CASE("paths are told at their full length", "[messages]") {
    std::string folders;
    for (int i = 0; i < 20; ++i)
        folders += "a_long_name_of_a_folder_" + std::to_string(i) + "/";
    for (const char *shape : {"obj", "ply"})
        CHECK(has(error_of_text("<shape type='" + std::string(shape) +
                                "'><string name='filename' value='" + folders + "mesh'/></shape>"),
                  "the file \"" + folders + "mesh\" does not exist"));
    CHECK(has(error_of_text("<path value='" + folders + "'/>"),
              "<path> \"" + folders + "\" not found"));
    CHECK(has(error_of_text("<include filename='" + folders + "a.xml'/>"),
              folders + "a.xml\" does not exist"));
}

TEST_CASE("a scene without light is told once", "[messages]") {
    const std::string messages = test::stderr_of([] {
        const Scene scene = test::load_text("<shape type='sphere'/>");
        (void)flatten(scene, {});
    });
    CHECK(count(messages, "no light") == 1);
}

TEST_CASE("the older name of an option is treated like the newer one", "[messages]") {
    for (const std::string &name :
         {std::string("sample_border"), std::string("high_quality_edges")})
        for (const bool value : {true, false}) {
            const Scene scene = test::load_text(
                "<sensor type='perspective'><film type='hdrfilm'><boolean name='" + name +
                "' value='" + (value ? "true" : "false") + "'/></film></sensor>");
            CHECK(scene.film.sample_border == value);
        }
}

TEST_CASE("what is not built is named with the nearest thing that is", "[messages]") {
    const auto nearest = [](const std::string &tag, const std::string &type,
                            const std::string &inside = "") {
        const std::string error =
            error_of_text("\n<" + tag + " type='" + type + "'>" + inside + "</" + tag + ">");
        CHECK(error.rfind("3: " + tag + " \"" + type + "\" is not supported, the nearest", 0) == 0);
        CHECK(count(error, "\n") == 0);
    };
    for (const char *type :
         {"sdfgrid", "bsplinecurve", "linearcurve", "ellipsoids", "hair", "heightfield"})
        nearest("shape", type);
    for (const char *type : {"radiancemeter", "irradiancemeter", "distant", "spherical",
                             "perspective_rdist", "telecentric"})
        nearest("sensor", type);
    for (const char *type : {"stokes", "ao", "field", "vpl"})
        nearest("integrator", type);
    nearest("integrator", "stokes", "<integrator type='path'/>");

    const std::string medium = "<medium type='homogeneous' name='interior'/>";
    CHECK(has(error_of_text("<shape type='sphere'>\n" + medium + "</shape>"),
              "3: medium \"homogeneous\" named \"interior\" in shape \"sphere\" is not supported, "
              "the nearest that is: "));
    CHECK(has(error_of_text("<sensor type='perspective'>\n" + medium + "</sensor>"),
              "3: medium \"homogeneous\""));
    CHECK(error_of_text("<medium type='homogeneous' id='unused'/>").empty());
}

TEST_CASE("all faults of a scene can be asked for", "[messages]") {
    const test::ScratchFolder folder;
    const std::string path = folder.file("s.xml", R"(<scene version="3.0.0">
<shape type="obj"><string name="filename" value="gone.obj"/></shape>
<shape type="sphere"><float name="radius" value="-1"/></shape>
<bsdf type="phong" id="shared"/>
<shape type="sphere"><ref id="shared"/></shape>
<shape type="disk"><ref id="shared"/></shape>
<shape type="ply"><string name="filename" value="bad.ply"/></shape>
<shape type="obj"><string name="filename" value="bad.obj"/></shape>
<emitter type="collimated"/>
<sensor type="perspective"><float name="fov" value="200"/></sensor>
<integrator type="stokes"/>
</scene>
)");
    (void)folder.file("bad.ply", "no ply");
    (void)folder.file("bad.obj", "v 0 0\n");
    LoadOptions options;
    const std::string first = test::error_of([&] { load_scene(path, options); });
    CHECK(count(first, "\n") == 0);
    CHECK(has(first, "gone.obj"));
    options.all_faults = true;
    const std::string all = test::error_of([&] { load_scene(path, options); });
    for (const char *part : {"s.xml:2: ", "s.xml:3: ", "s.xml:4: ", "bad.ply:1: ", "bad.obj:1: ",
                             "s.xml:9: ", "s.xml:10: ", "s.xml:11: "}) {
        CAPTURE(part);
        CHECK(count(all, part) == 1);
    }
    CHECK(count(all, "\n") == 7);
}

TEST_CASE("all faults of one object, and of the document itself, are told", "[messages]") {
    const test::ScratchFolder folder;
    const std::string path = folder.file("s.xml", R"(<scene version="3.0.0">
<shape type="sphere"><float name="radius" value="many"/>
<float name="a" value="1"/>
<float name="b" value="1"/>
<ref id="nobody"/>
<bsdf type="phong"/></shape>
<shape type="hair">
<bsdf type="ward"/>
<emitter type="spot"/></shape>
<lamp type="bulb"/>
<sensor type="fisheye"><film type="specfilm"/>
<sampler type="any"><integer name="sample_count" value="0"/></sampler></sensor>
<shape type="disk"><bsdf type="twosided"><bsdf type="diffuse">
<texture name="reflectance" type="wood"/></bsdf>
</bsdf><bsdf type="conductor"><string name="material" value="mithril"/></bsdf></shape>
</scene>
)");
    LoadOptions options;
    const std::string first = test::error_of([&] { load_scene(path, options); });
    CHECK(count(first, "\n") == 0);
    CHECK(has(first, "s.xml:2: \"radius\" is \"many\""));
    options.all_faults = true;
    const std::string all = test::error_of([&] { load_scene(path, options); });
    CAPTURE(all);
    for (const char *part :
         {"s.xml:2: ", "s.xml:3: ", "s.xml:4: ", "s.xml:5: ", "s.xml:6: ", "s.xml:7: ", "s.xml:8: ",
          "s.xml:9: ", "s.xml:10: ", "s.xml:11: sensor", "s.xml:11: film",
          "s.xml:12: ", "s.xml:14: ", "s.xml:15: shape", "s.xml:15: bsdf"}) {
        CAPTURE(part);
        CHECK(count(all, part) == 1);
    }
    CHECK(count(all, "\n") == 14);
}

TEST_CASE("what does not change the picture is told where all is asked for", "[messages]") {
    const test::ScratchFolder folder;
    const std::string path = folder.file("s.xml", "<scene version='3.0.0'>\n<integrator "
                                                  "type='path'>\n<integer name='block_size' "
                                                  "value='8'/></integrator></scene>");
    for (const bool all : {false, true}) {
        LoadOptions options;
        options.all_faults = all;
        const std::string said = test::stderr_of([&] { load_scene(path, options); });
        CHECK(has(said, "s.xml:3: \"block_size\" of integrator \"path\"") == all);
    }
}

TEST_CASE("what a scene has beside what is rendered is told with its line", "[messages]") {
    const auto said = [](const std::string &content) {
        return test::stderr_of([&] { (void)test::load_text(content); });
    };
    CHECK(has(said("<bsdf type='hair' id='unused'/>"),
              "scene.xml:2: warning: bsdf \"hair\" is not supported"));
    CHECK(has(said("<bsdf type='hair' id='unused'/>"), "(no shape uses it)"));
    CHECK_FALSE(has(said("<bsdf type='hair' id='unused'/>"), "clrender: warning: "));
    CHECK(has(said("<medium type='homogeneous' id='fog'/>"),
              "scene.xml:2: warning: medium \"homogeneous\" is ignored: nothing uses it"));

    const test::ScratchFolder folder;
    const std::string path =
        folder.file("scene.xml", "<scene version='3.0.0'>\n<sensor type='perspective'/>\n"
                                 "<sensor type='irradiancemeter'/>\n<sensor type='thinlens'>\n"
                                 "<float name='apertur' value='1'/></sensor>\n</scene>\n");
    const std::string all =
        test::error_of([&] { (void)load_scene(path, {.defines = {}, .all_faults = true}); });
    CHECK(has(all, "scene.xml:3: sensor \"irradiancemeter\" is not supported"));
    CHECK(has(all, "scene.xml:4: sensor \"thinlens\""));
    CHECK(test::error_of([&] { (void)load_scene(path); }).empty());
}

TEST_CASE("elements without what they need are told what that is", "[messages]") {
    CHECK(error_of_text("<shape type='sphere'><bsdf type='diffuse'>\n<srgb name='reflectance'/>"
                        "</bsdf></shape>") ==
          "3: <srgb> has no value, expected \"#rrggbb\" or 3 numbers or 1");
    CHECK(has(error_of_text("<shape type='sphere'>\n<subsurface type='dipole'/></shape>"),
              "subsurface \"dipole\" in shape \"sphere\" is not supported"));
}
