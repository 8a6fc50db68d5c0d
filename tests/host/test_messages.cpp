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
    CHECK_FALSE(has(error_of_text("<integrator type='volpath'/>"), "did you mean"));
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
         {std::string("sample_border"), std::string("high_quality_edges")}) {
        const auto film = [&](const char *value) {
            return "<sensor type='perspective'><film type='hdrfilm'><boolean name='" + name +
                   "' value='" + value + "'/></film></sensor>";
        };
        CHECK(has(error_of_text(film("true")),
                  "\"" + name + "\" is not supported, expected \"false\""));
        CHECK(error_of_text(film("false")).empty());
    }
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
<integrator type="volpath"/>
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

TEST_CASE("a version before 2 is told for what it is", "[messages]") {
    const test::ScratchFolder folder;
    for (const char *version : {"0.6.0", "1.0.0"}) {
        const std::string path =
            folder.file("s.xml", std::string("<scene version=\"") + version + "\"/>");
        const std::string error = test::error_of([&] { test::load(path); });
        CHECK(has(error, std::string("version \"") + version + "\" is older than Mitsuba 2"));
        CHECK_FALSE(has(error, "0.6,"));
    }
}
