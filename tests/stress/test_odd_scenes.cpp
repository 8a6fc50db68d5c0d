/// Scenes that are odd but can be rendered: a warning says what is odd, and there is a picture.

// The sanitizers take what OpenCL runtimes leak for failures of the program.
#ifndef CLRENDER_SANITIZE

#include "program.h"
#include "small_scene.h"

#include <catch2/catch.hpp>

using namespace clrender::test;

namespace {

/// The lit floor with `shapes` in it.
std::string with_shapes(const std::string &shapes) {
    std::string scene = lit_floor;
    return scene.insert(scene.find("    <emitter"), shapes);
}

/// Renders it; returns what was said.
std::string render(const std::string &scene, const std::vector<std::string> &more = {}) {
    const TempFolder folder;
    folder.write("scene.xml", scene);
    folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\nf 1 2 4\n");
    std::vector<std::string> arguments = {"scene.xml", "-q", "-s", "1", "-o", "a.pfm"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = run_clrender(folder.path(), arguments);
    INFO(result.err);
    CHECK(result.exit_code == 0);
    CHECK(folder.has("a.pfm"));
    return result.err;
}

} // namespace

TEST_CASE("Degenerate triangles, no light, a camera in a solid: a warning and a picture") {
    CHECK(render(lit_floor).empty());
    CHECK_THAT(render(with_shapes("<shape type=\"obj\"><string name=\"filename\" "
                                  "value=\"flat.obj\"/></shape>\n")),
               Catch::Contains("warning: 2 triangles or spheres without area"));

    std::string dark = lit_floor;
    dark.erase(dark.find("    <emitter"), dark.find("</scene>") - dark.find("    <emitter"));
    CHECK_THAT(render(dark), Catch::Contains("no light"));

    // The camera is at (0, 3, -3).
    const std::string around = "<shape type=\"sphere\"><float name=\"radius\" value=\"5\"/>";
    CHECK_THAT(render(with_shapes(around + "</shape>\n")),
               Catch::Contains("scene.xml:14: warning: the camera is inside of this solid"));
    CHECK(render(with_shapes(around + "<boolean name=\"flip_normals\" value=\"true\"/></shape>\n"))
              .empty());
    const std::string cube = "<shape type=\"cube\"><transform name=\"to_world\"><scale value=\"";
    CHECK_THAT(render(with_shapes(cube + "5\"/></transform></shape>\n")),
               Catch::Contains("warning: the camera is inside of this solid"));
    CHECK(render(with_shapes(cube + "2\"/></transform></shape>\n")).empty());
}

TEST_CASE("Light that nothing absorbs ends, though no depth does") {
    const std::string closed =
        "<scene version=\"3.0.0\"><integrator type=\"path\"/><sensor type=\"perspective\">"
        "<film type=\"hdrfilm\"><integer name=\"width\" value=\"8\"/>"
        "<integer name=\"height\" value=\"8\"/></film></sensor><shape type=\"sphere\">"
        "<float name=\"radius\" value=\"3\"/><boolean name=\"flip_normals\" value=\"true\"/>"
        "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"1\"/></bsdf></shape>"
        "<emitter type=\"point\"/></scene>";
    render(closed, {"--max-depth", "-1", "--rr-depth", "2147483647"});
}

#endif
