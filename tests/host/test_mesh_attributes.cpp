#include "files.h"
#include "mitsuba_text_scene.h"
#include "stderr_of.h"

#include "flatten/flat_scene.h"
#include "scene/mesh_attributes.h"
#include "scene/model_scene.h"

#include <catch2/catch.hpp>

using namespace clrender;

namespace {

/// A quad of one polygon as a PLY file; the texts are the further properties and their values.
std::string ply(const std::string &of_vertex, const std::string &values,
                const std::string &of_face = "", const std::string &face_values = "") {
    const auto properties = [](const std::string &names) {
        std::string text;
        for (std::size_t at = 0; at < names.size();) {
            const std::size_t end = std::min(names.find(' ', at), names.size());
            text += "property float " + names.substr(at, end - at) + "\n";
            at = end + 1;
        }
        return text;
    };
    std::string text =
        "ply\nformat ascii 1.0\nelement vertex 4\n" + properties("x y z " + of_vertex);
    text += "element face 1\nproperty list uchar int vertex_indices\n" + properties(of_face);
    text += "end_header\n";
    for (const char *place : {"0 0 0 ", "1 0 0 ", "1 1 0 ", "0 1 0 "})
        text += place + values + "\n";
    return text + "4 0 1 2 3 " + face_values + "\n";
}

Mesh read(const std::string &text, const std::set<std::string> &wanted) {
    const test::ScratchFolder folder;
    return read_ply_mesh(folder.file("mesh.ply", text), {.attributes = wanted});
}

std::vector<std::string> names_of(const std::string &of_vertex, const std::string &values) {
    std::vector<std::string> names;
    for (const MeshAttribute &attribute : read(ply(of_vertex, values), {"vertex_any"}).attributes)
        names.push_back(attribute.name + "/" + std::to_string(attribute.channels));
    return names;
}

/// A scene of that mesh with a texture of an attribute as `parameter` of a BSDF.
std::string scene(const std::string &file, const std::string &bsdf, const std::string &parameter,
                  const std::string &name, const std::string &more = "") {
    return "<shape type=\"" + file.substr(file.size() - 3) +
           "\"><string name=\"filename\" value=\"" + file + "\"/>\n<bsdf type=\"" + bsdf +
           "\"><texture type=\"mesh_attribute\" name=\"" + parameter +
           "\"><string name=\"name\" value=\"" + name + "\"/>" + more + "</texture></bsdf></shape>";
}

} // namespace

TEST_CASE("PLY properties are attributes as Mitsuba names them", "[ply][attributes]") {
    using Names = std::vector<std::string>;
    CHECK(names_of("r g b", "1 1 1") == Names{"vertex_color/3"});
    CHECK(names_of("blue green red alpha", "1 1 1 1") == Names{"vertex_color/3"});
    CHECK(names_of("red g b", "1 1 1").empty());
    CHECK(names_of("h_0 foo_x foo_y foo_z", "1 1 1 1") == Names{"vertex_h/1", "vertex_foo/3"});
    CHECK(names_of("foo_r foo_g foo_b", "1 1 1") == Names{"vertex_foo_color/3"});
    CHECK(names_of("a_b_1 a_b_2 a_b_3", "1 1 1") == Names{"vertex_a_b/3"});
    CHECK(names_of("foo_0 foo_1", "1 1").empty());
    CHECK(names_of("foo_0 foo_2 foo_1", "1 1 1").empty());
    CHECK(names_of("foo_0 foo_1 foo_2 foo_3", "1 1 1 1").empty());
    CHECK(names_of("foo_0 bar_0 foo_1", "1 1 1") == Names{"vertex_foo/1", "vertex_bar/1"});
    CHECK(names_of("plain foo_w foo_red", "1 1 1").empty());
}

TEST_CASE("what nothing asks for is passed over, whatever it holds", "[ply][attributes]") {
    const Mesh mesh = read(ply("r g b h_0", "1 2 3 nan", "q_0", "nan"), {"vertex_color"});
    REQUIRE(mesh.attributes.size() == 3);
    CHECK(find_attribute(mesh, "face_q")->values.empty());
    CHECK(find_attribute(mesh, "vertex_h")->values.empty());
    CHECK(find_attribute(mesh, "vertex_color")->values ==
          std::vector<float>{1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3});
    CHECK(read(ply("r g b", "1 2 3"), {}).attributes.empty());
}

TEST_CASE("the triangles of a polygon share its attributes", "[ply][attributes]") {
    const Mesh mesh = read(ply("", "", "r g b", "5 6 7"), {"face_color"});
    REQUIRE(mesh.triangles.size() == 2);
    CHECK(find_attribute(mesh, "face_color")->values == std::vector<float>{5, 6, 7, 5, 6, 7});
}

TEST_CASE("faces that stand before the vertices keep their attributes", "[ply][attributes]") {
    const Mesh mesh = read("ply\nformat ascii 1.0\nelement face 2\n"
                           "property list uchar int vertex_indices\nproperty uchar h_0\n"
                           "element vertex 5\nproperty float x\nproperty float y\n"
                           "property float z\nend_header\n4 0 1 2 3 9\n3 0 1 4 7\n"
                           "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n",
                           {"face_h"});
    CHECK(find_attribute(mesh, "face_h")->values == std::vector<float>{9, 9, 7});
    CHECK(find_attribute(mesh, "face_h")->whole == 255);
}

TEST_CASE("attributes have to be finite", "[ply][attributes]") {
    CHECK_THAT(test::error_of([] { read(ply("h_0", "inf"), {"vertex_h"}); }),
               Catch::Contains("mesh.ply:11: ") && Catch::Contains("finite"));
}

TEST_CASE("OBJ colours belong to places", "[obj][attributes]") {
    const test::ScratchFolder folder;
    const std::string file =
        folder.file("mesh.obj", "v 0 0 0 .1 .2 .3\nv 1 0 0\nv 0 1 0 1 0 0\n"
                                "vt 0 0\nvt 1 1\nf 3/1 1/1 2/1\nf 1/2 2/1 3/1\n");
    const Mesh mesh = read_obj_mesh(file, {.attributes = {"vertex_color"}});
    REQUIRE(mesh.positions.size() == 4);
    CHECK(find_attribute(mesh, "vertex_color")->values ==
          std::vector<float>{1, 0, 0, .1F, .2F, .3F, 1, 1, 1, .1F, .2F, .3F});
    CHECK(read_obj_mesh(file, {}).attributes.empty());
}

TEST_CASE("attributes reach the device where a shape shows them", "[attributes]") {
    const test::ScratchFolder folder;
    const std::string file = folder.file("a.ply", ply("r g b h_0", ".1 .2 .3 .4", "t_0", ".5"));
    const std::string plain =
        "<shape type=\"ply\"><string name=\"filename\" value=\"" + file + "\"/></shape>";
    const Scene first = test::load_text(plain + scene(file, "diffuse", "reflectance", "face_t"));
    REQUIRE(first.shapes[1].attribute_textures.size() == 1);
    const FlatScene flat = flatten(first);
    CHECK(flat.attributes == std::vector<clr_real>(6, .5F));
    REQUIRE(flat.attribute_places.size() == 2);
    // Its first triangle is number 2 of the scene.
    CHECK(flat.attribute_places[1] == 0U - 2U);
    CHECK(flat.uvs.empty());
    CHECK(flatten(test::load_text(plain)).attributes.empty());
}

TEST_CASE("a scene is told which attributes a mesh has", "[attributes]") {
    const test::ScratchFolder folder;
    const std::string file = folder.file("a.ply", ply("r g b h_0", "1 2 3 4", "t_0", "-5"));
    const auto error = [&](const std::string &bsdf, const std::string &parameter,
                           const std::string &name, const std::string &more = "") {
        return test::error_of_text(scene(file, bsdf, parameter, name, more));
    };
    CHECK_THAT(error("diffuse", "reflectance", "vertex_t"),
               Catch::StartsWith("3: ") &&
                   Catch::Contains("\"face_t\", \"vertex_color\", \"vertex_h\""));
    CHECK_THAT(error("roughconductor", "alpha", "vertex_color"),
               Catch::StartsWith("3: ") && Catch::Contains("has 3 channels"));
    CHECK_THAT(error("diffuse", "reflectance", "face_t"), Catch::Contains("negative values"));
    CHECK_THAT(
        error("diffuse", "reflectance", "vertex_h", "<float name=\"scale\" value=\"1e30\"/>"),
        Catch::Contains("too large"));
    CHECK(error("roughconductor", "alpha", "vertex_h").empty());
    CHECK_THAT(test::stderr_of([&] { error("diffuse", "reflectance", "vertex_color"); }),
               Catch::Contains("goes up to 3: the surface gives more light than it gets"));
}

TEST_CASE("a bare model shows its colours as displays do", "[model][attributes]") {
    const test::ScratchFolder folder;
    const std::string obj = "v 0 0 0 0 .5 1\nv 1 0 0 0 .5 1\nv 0 1 0 0 .5 1\nf 1 2 3\n";
    for (const std::string &file : {folder.file("a.ply", ply("r g b", "0 .5 1")),
                                    folder.file("b.ply", ply("", "", "red green blue", "0 .5 1")),
                                    folder.file("c.obj", obj)}) {
        INFO(file);
        const Scene scene = load_model(file);
        REQUIRE(scene.shapes[0].attribute_textures.size() == 1);
        const auto texture = static_cast<std::size_t>(scene.shapes[0].attribute_textures[0]);
        const MeshAttribute *colors =
            find_attribute(*scene.shapes[0].mesh, scene.textures[texture].attribute);
        REQUIRE(colors != nullptr);
        CHECK(colors->values[0] == 0);
        CHECK(colors->values[1] == Approx(0.21404).epsilon(1e-4));
        CHECK(colors->values[2] == 1);
    }
    CHECK(load_model(folder.file("d.ply", ply("", ""))).shapes[0].attribute_textures.empty());
}
