/// Parameters, includes, references and the files around a scene.

#include "mitsuba_text_scene.h"

#include <catch2/catch.hpp>

#include <sys/stat.h>

using namespace clrender;
using namespace test;
using Catch::Contains;
using Catch::StartsWith;

namespace {

double radius_of(const Scene &scene, std::size_t shape = 0) {
    return glm::length(glm::dvec3(scene.shapes.at(shape).to_world[0]));
}

std::string sphere(const std::string &radius) {
    return R"(<shape type="sphere"><float name="radius" value=")" + radius + "\"/></shape>";
}

void write(const ScratchFolder &folder, const std::string &name, const std::string &text) {
    static_cast<void>(folder.file(name, text));
}

std::string whole(const std::string &content) {
    return "<scene version=\"3.0.0\">\n" + content + "\n</scene>\n";
}

} // namespace

TEST_CASE("defaults, defines and their order") {
    const std::string scene = R"(<default name="r" value="2"/>
        <default name="radius" value="${r}"/>)";
    CHECK_THAT(error_of_text(scene), StartsWith("3: ") && Contains("nothing defines"));

    // The longest name that fits is taken; a default may use those before it.
    const std::string nested =
        R"(<default name="r" value="2"/><default name="radius" value="$r.5"/>)" + sphere("$radius");
    CHECK(radius_of(load_text(nested)) == 2.5);
    CHECK(radius_of(load_text(nested, {{"r", "3"}})) == 3.5);
    CHECK(radius_of(load_text(nested, {{"radius", "7"}, {"unknown", "1"}})) == 7);
    CHECK(radius_of(load_text(sphere("$size"), {{"size", "4"}})) == 4);
    CHECK_THAT(error_of_text(sphere("$size")),
               StartsWith("2: ") && Contains("\"$size\"") && Contains("-D name=value"));
    CHECK_THAT(error_of_text(sphere("\\$size")), StartsWith("2: ") && Contains("\"$size\""));
}

TEST_CASE("parameters that double their length are stopped") {
    std::string content = R"(<default name="p0" value="xxxxxxxxxx"/>)";
    for (int i = 1; i < 60; ++i)
        content += "<default name=\"p" + std::to_string(i) + "\" value=\"$p" +
                   std::to_string(i - 1) + " $p" + std::to_string(i - 1) + "\"/>\n";
    CHECK_THAT(error_of_text(content), Contains("grows too long"));
}

TEST_CASE("references reach forwards, backwards, into other objects and through aliases") {
    const Scene scene = load_text(R"(<shape type="sphere"><ref id="later"/></shape>
        <shape type="sphere"><bsdf type="conductor" id="inside"/></shape>
        <shape type="sphere"><ref id="inside"/></shape>
        <bsdf type="dielectric" id="later"/><alias id="later" as="glass"/>
        <shape type="sphere"><ref id="glass" name="any"/></shape>)");
    const auto id = [&](std::size_t shape) {
        return scene.bsdfs.at(static_cast<std::size_t>(scene.shapes.at(shape).bsdf)).id;
    };
    CHECK(id(0) == "later");
    CHECK(id(1) == "inside");
    CHECK(id(2) == "inside");
    CHECK(id(3) == "later");
    CHECK(scene.bsdfs.size() == 2);
}

TEST_CASE("includes share parameters and ids, and look beside themselves first") {
    const ScratchFolder folder;
    std::filesystem::create_directories(folder.path("parts/deeper"));
    write(folder, "parts/first.xml", whole(sphere("$r") + R"(<include filename="deeper/ball.xml"/>
        <include filename="beside_the_scene.xml"/>)"));
    write(folder, "parts/deeper/ball.xml",
          R"(<shape version="3.0.0" type="sphere"><ref id="white"/></shape>)");
    write(folder, "beside_the_scene.xml", whole(R"(<bsdf type="diffuse" id="white"/>)"));
    const std::string path =
        folder.file("main.xml", whole(R"(<default name="r" value="3"/><path value="parts"/>
        <include filename="first.xml"/>)"));
    const Scene scene = load(path);
    CHECK(scene.name == "main");
    REQUIRE(scene.shapes.size() == 2);
    CHECK(radius_of(scene) == 3);
    CHECK(scene.bsdfs.at(static_cast<std::size_t>(scene.shapes.at(1).bsdf)).id == "white");
}

TEST_CASE("errors in an included file name that file") {
    const ScratchFolder folder;
    write(folder, "part.xml", whole("\n" + sphere("-1")));
    const std::string path = folder.file("main.xml", whole(R"(<include filename="part.xml"/>)"));
    CHECK_THAT(error_of([&] { load(path); }), StartsWith(folder.path("part.xml") + ":3: "));
}

TEST_CASE("include cycles and endless fans of includes are refused") {
    const ScratchFolder folder;
    write(folder, "a.xml", whole(R"(<include filename="b.xml"/>)"));
    write(folder, "b.xml",
          whole("\n"
                R"(<include filename="./a.xml"/>)"));
    CHECK_THAT(error_of([&] { load(folder.path("a.xml")); }),
               StartsWith(folder.path("b.xml") + ":3: ") && Contains("includes itself"));

    for (int i = 0; i < 14; ++i) {
        const std::string next = R"(<include filename="f)" + std::to_string(i + 1) + ".xml\"/>";
        write(folder, "f" + std::to_string(i) + ".xml", whole(next + next + next));
    }
    write(folder, "f14.xml", whole(""));
    CHECK_THAT(error_of([&] { load(folder.path("f0.xml")); }), Contains("too many includes"));
}

TEST_CASE("what is no scene file is refused without waiting for it") {
    const ScratchFolder folder;
    CHECK_THAT(error_of([&] { load(folder.path("missing.xml")); }), Contains("no such file"));
    std::filesystem::create_directories(folder.path("folder.xml"));
    CHECK_THAT(error_of([&] { load(folder.path("folder.xml")); }), Contains("not a regular file"));
    REQUIRE(::mkfifo(folder.path("fifo.xml").c_str(), 0600) == 0);
    CHECK_THAT(error_of([&] { load(folder.path("fifo.xml")); }), Contains("not a regular file"));
    const std::string path = folder.file("main.xml", whole(R"(<include filename="fifo.xml"/>)"));
    CHECK_THAT(error_of([&] { load(path); }),
               StartsWith(path + ":2: ") && Contains("not a regular file"));
    CHECK_THAT(error_of([&] { load(folder.file("scene.txt", whole(""))); }),
               Contains("expected a .xml, .gltf, .glb, .obj or .ply"));
}

TEST_CASE("two hundred thousand nested elements are refused") {
    constexpr int depth = 200000;
    std::string closed;
    for (int i = 0; i < depth; ++i)
        closed += "<bsdf type=\"twosided\">\n";
    const std::string open = closed;
    for (int i = 0; i < depth; ++i)
        closed += "</bsdf>";
    CHECK_THAT(error_of_text(closed), StartsWith("65: ") && Contains("nested too deep"));
    CHECK_THAT(error_of_text(open), Contains("XML syntax error"));
}

TEST_CASE("byte order marks and any line ends are fine") {
    const ScratchFolder folder;
    const std::string path =
        folder.file("scene.xml", "\xEF\xBB\xBF<?xml version=\"1.0\"?>\r\n<!-- a comment\r\n -->\r\n"
                                 "<scene version=\"2.1.0\">\r\n" +
                                     sphere("1e-3") + "\r\n" + sphere("zero") + "\r\n</scene>");
    CHECK_THAT(error_of([&] { load(path); }), Contains(":6: ") && Contains("expected a number"));
}

TEST_CASE("every truncation of a scene file is refused") {
    const ScratchFolder folder;
    const std::string text = whole(R"(<shape type="sphere"><float name="radius" value="2"/>
        <bsdf type="diffuse"><rgb name="reflectance" value=".1 .2 .3"/></bsdf></shape>)");
    const std::size_t last = text.rfind('>');
    for (std::size_t length = 0; length < last; ++length) {
        const std::string path = folder.file("cut.xml", text.substr(0, length));
        const std::string error = error_of([&] { load(path); });
        INFO(length << " bytes: " << error);
        CHECK_THAT(error, StartsWith(path + ":"));
    }
}

TEST_CASE("what no shape uses may be unsupported, but not wrong") {
    CHECK(load_text(R"(<bsdf type="hair" id="a"/>)").bsdfs.empty());
    CHECK_THAT(error_of_text(R"(<bsdf type="diffuse" id="a"><float name="x" value="1"/></bsdf>)"),
               StartsWith("2: ") && Contains("unknown property \"x\""));
    CHECK(load_text(R"(<sensor type="perspective" id="one"><float name="fov" value="30"/></sensor>
                       <sensor type="spherical"/>)")
              .sensor.fov == 30);
}

TEST_CASE("shapes of the same file and options share the mesh") {
    const ScratchFolder folder;
    write(folder, "t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 .5\nv 1 1 0\nf 1 2 3\nf 2 4 3\n");
    const std::string file = R"(<string name="filename" value="t.obj"/>)";
    const Scene scene = load(folder.file(
        "scene.xml",
        whole(R"(<shape type="obj">)" + file + R"(</shape><shape type="obj">)" + file +
              R"(<transform name="to_world"><rotate y="1" angle="20"/></transform>
        </shape><shape type="obj">)" +
              file +
              R"(<boolean name="face_normals" value="true"/></shape>
        <shape type="obj">)" +
              file + R"(<transform name="to_world"><scale z="-1"/></transform></shape>)")));
    CHECK(scene.shapes.at(0).mesh == scene.shapes.at(1).mesh);
    CHECK(scene.shapes.at(2).mesh->normals.empty());

    // Mirrored, normals that the file does not state come from the mirrored triangles.
    const Mesh &plain = *scene.shapes.at(0).mesh;
    const Mesh &mirrored = *scene.shapes.at(3).mesh;
    REQUIRE(mirrored.normals.size() == plain.normals.size());
    for (std::size_t i = 0; i < plain.normals.size(); ++i)
        CHECK(glm::distance(mirrored.normals.at(i), -plain.normals.at(i)) < 1e-5F);
}
