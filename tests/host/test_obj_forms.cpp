/// OBJ and MTL files as programs and people write them.

#include "files.h"
#include "stderr_of.h"

#include "scene/mesh_io.h"
#include "scene/model_scene.h"

#include <catch2/catch.hpp>

#include <cstring>

using namespace clrender;

namespace {

const std::string quad = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
const std::string face = "f 1/1 2/2 3/3 4/4\n";

struct Model {
    Scene scene;
    std::string messages;
};

/// The model m.obj of a folder of files, with what was said about it; paths are cut out.
Model load(const std::vector<std::pair<std::string, std::string>> &files) {
    const test::ScratchFolder folder;
    for (const auto &[name, bytes] : files)
        (void)folder.file(name, bytes);
    Model model;
    model.messages = test::stderr_of([&] { model.scene = load_model(folder.path("m.obj")); });
    for (std::size_t at = model.messages.find(folder.path("")); at != std::string::npos;
         at = model.messages.find(folder.path("")))
        model.messages.erase(at, folder.path("").size());
    return model;
}

Model load(const std::string &materials, const std::string &name = "red") {
    return load({{"m.mtl", materials},
                 {"m.obj", "mtllib m.mtl\n" + quad + "usemtl " + name + "\n" + face}});
}

/// The texture of the first shape, which is diffuse.
Texture texture_of(const Scene &scene) {
    const auto &sides = std::get<TwosidedBsdf>(
        scene.bsdfs.at(static_cast<std::size_t>(scene.shapes.at(0).bsdf)).model);
    const auto &front =
        std::get<DiffuseBsdf>(scene.bsdfs.at(static_cast<std::size_t>(sides.front)).model);
    return scene.textures.at(static_cast<std::size_t>(front.reflectance));
}

bool has(const std::string &text, const std::string &part) {
    return text.find(part) != std::string::npos;
}

/// A picture of one pixel.
std::string pfm(float value) {
    std::string bytes(sizeof(float), '\0');
    std::memcpy(bytes.data(), &value, sizeof(float));
    return "Pf\n1 1\n-1\n" + bytes;
}

const Rgb red(.9, .1, .1);
const std::string grey_name = "the material 'red' is in no mtllib";

} // namespace

TEST_CASE("OBJ lines end with LF, CRLF or CR, and a backslash continues them", "[obj]") {
    const std::string text = "# made\\\nv -1 -1 0 1.0\nv 1 -1 0\nv 1 1 \\\n0 # a corner\nv -1 1 0\n"
                             "f 1 2 \\  \n  3 \\\n 4\n";
    const test::ScratchFolder folder;
    for (const std::string &line_end :
         {std::string("\n"), std::string("\r\n"), std::string("\r")}) {
        std::string bytes;
        for (const char c : text)
            bytes += c == '\n' ? line_end : std::string(1, c);
        for (const std::string &mark : {std::string(), std::string("\xEF\xBB\xBF")}) {
            const Mesh mesh = read_obj_mesh(folder.file("m.obj", mark + bytes), {});
            CHECK(mesh.triangles.size() == 2);
            CHECK(mesh.positions.size() == 4);
            // Lines are counted as they stand in the file, a continued one by its first.
            const std::string bad =
                folder.file("bad.obj", mark + bytes + "f 1 2 \\" + line_end + " x");
            CHECK(has(test::error_of([&] { read_obj_mesh(bad, {}); }),
                      "bad.obj:10: face vertex 'x'"));
        }
    }
    // A file may end within a continued line.
    CHECK(read_obj_mesh(folder.file("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 \\"), {})
              .triangles.size() == 1);
}

TEST_CASE("OBJ corners may end with strokes that nothing follows", "[obj]") {
    const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 1 0\n";
    const test::ScratchFolder folder;
    const auto read = [&](const std::string &line) {
        return read_obj_mesh(folder.file("m.obj", corners + line), {});
    };
    for (const char *line : {"f 1/ 2/ 3/\n", "f 1// 2// 3//\n", "f 1/1/ 2/1/ 3/1/\n"})
        CHECK(read(line).normals.at(0) == glm::vec3(0, 0, 1));
    CHECK(read("f 1//1 2//1 3//1\n").normals.at(0) == glm::vec3(0, 1, 0));
    for (const char *line :
         {"f 1/// 2 3\n", "f /1 2 3\n", "f 1/0 2 3\n", "f 1/a 2 3\n", "f 1//0 2 3\n"})
        CHECK(has(test::error_of([&] { read(line); }), "m.obj:6: face vertex"));
}

TEST_CASE("line ends are found at the border of a block", "[obj]") {
    // Blocks of 64 KiB: the CR is the last byte of the first one, the LF the first of the second.
    const std::string corners = "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\n";
    const test::ScratchFolder folder;
    for (const std::size_t border : {65534, 65535, 65536, 65537}) {
        const std::string comment = "#" + std::string(border - corners.size() - 1, '-');
        const std::string path = folder.file("m.obj", corners + comment + "\r\nf 1 2 9\r\n");
        CHECK(has(test::error_of([&] { read_obj_mesh(path, {}); }), "m.obj:5: vertex 9"));
    }
}

TEST_CASE("material names with blanks and tabs around and within", "[obj]") {
    for (const auto &[in_library, in_model] :
         {std::pair<std::string, std::string>{"newmtl   red\t\r\nKd 0.9 0.1 0.1\r\n", "  red  "},
          {"newmtl red\rKd .9 .1 .1\r", "red\t"},
          {"\tnewmtl\tred  clay\n  Kd\t.9\t.1\t.1\n", "red clay"},
          {"\xEF\xBB\xBFnewmtl red clay # a comment\nKd .9 .1 \\\n.1\n", "  red \t clay # other"},
          {"newmtl r#d\nKd .9 .1 .1\n", "r#d"},
          {"NEWMTL red\nKD .9 .1 .1\n", "red"}}) {
        CAPTURE(in_library);
        const Model model = load(in_library, in_model);
        CHECK(texture_of(model.scene).value == red);
        CHECK(model.messages.empty());
    }
}

TEST_CASE("several material libraries, on a line or on several, with blanks in their names",
          "[obj]") {
    const std::string blue = "newmtl blue\nKd .1 .1 .9\n";
    const std::string other = "newmtl red\nKd .9 .1 .1\n";
    const std::string rest = quad + "usemtl red\n" + face;
    for (const std::string &lines :
         {std::string("mtllib a.mtl b.mtl\n"), std::string("mtllib a.mtl\nmtllib b.mtl\n"),
          std::string("mtllib\ta.mtl \t b.mtl  \r\n"), std::string("mtllib b.mtl a.mtl\n"),
          std::string("mtllib a.mtl \\\n b.mtl\n"), std::string("mtllib .\\b.mtl\n")}) {
        CAPTURE(lines);
        const Model model = load({{"a.mtl", blue}, {"b.mtl", other}, {"m.obj", lines + rest}});
        CHECK(texture_of(model.scene).value == red);
        CHECK(model.messages.empty());
    }
    const Model spaced = load({{"my materials b.mtl", other},
                               {"a.mtl", blue},
                               {"m.obj", "mtllib a.mtl my materials b.mtl\n" + rest}});
    CHECK(texture_of(spaced.scene).value == red);
    const Model half = load({{"b.mtl", other}, {"m.obj", "#\nmtllib gone.mtl b.mtl\n" + rest}});
    CHECK(texture_of(half.scene).value == red);
    CHECK(has(half.messages, "m.obj:2: warning: \"gone.mtl\" is not a file"));
}

TEST_CASE("unknown material names are said, with the line that uses them first", "[obj]") {
    const Model model = load({{"m.mtl", "newmtl blue\nKd 0 0 1\n"},
                              {"m.obj", "mtllib m.mtl\n" + quad + "usemtl red\n" + face +
                                            "usemtl green\n" + face + "usemtl red\n" + face}});
    CHECK(
        model.messages ==
        "m.obj:10: warning: the material 'red' (and 1 more) is in no mtllib: plain grey is used\n");
    CHECK(has(load({{"m.obj", quad + "usemtl red\n" + face}}).messages, grey_name));
    // Where the library itself is missing, that is enough; `usemtl` alone means none.
    CHECK_FALSE(has(load({{"m.obj", "mtllib m.mtl\n" + quad + "usemtl red\n" + face}}).messages,
                    grey_name));
    CHECK(load({{"m.obj", quad + "usemtl\n" + face}}).messages.empty());
}

TEST_CASE("a texture that is missing or broken leaves the plain colour", "[obj]") {
    const Model missing = load("newmtl red\nKd .9 .1 .1\nmap_Kd gone.png\n");
    CHECK(texture_of(missing.scene).value == red);
    CHECK(missing.messages ==
          "m.mtl:3: warning: the texture \"gone.png\" is not there: the material "
          "'red' has its plain colour\n");
    const Model broken = load({{"t.dds", "DDS etc."},
                               {"m.mtl", "newmtl red\nKd .9 .1 .1\nmap_Kd t.dds\n"},
                               {"m.obj", "mtllib m.mtl\n" + quad + "usemtl red\n" + face}});
    CHECK(texture_of(broken.scene).kind == TextureKind::constant);
    CHECK(texture_of(broken.scene).value == red);
    CHECK(has(broken.messages, "m.mtl:3: warning: t.dds: unknown format"));
}

TEST_CASE("textures are found by all the paths that programs write", "[obj]") {
    for (const char *name : {"my tile.pfm", "./my tile.pfm", "C:\\work\\my tile.pfm",
                             "\"my tile.pfm\"", "/home/somebody/my tile.pfm", "  my tile.pfm  "}) {
        CAPTURE(name);
        const Model model =
            load({{"my tile.pfm", pfm(.25F)},
                  {"m.mtl", std::string("newmtl red\nKd .9 .1 .1\nmap_Kd ") + name + "\r\n"},
                  {"m.obj", "mtllib m.mtl\n" + quad + "usemtl red\n" + face}});
        CHECK(model.messages.empty());
        REQUIRE(texture_of(model.scene).kind == TextureKind::bitmap);
        CHECK(texture_of(model.scene).bitmap->f32.at(0) == .25F);
    }
}

TEST_CASE("the options of map_Kd are done, or said", "[obj]") {
    const auto with_options = [](const std::string &options) {
        return load({{"t.pfm", pfm(.25F)},
                     {"m.mtl", "newmtl red\nmap_Kd " + options + " t.pfm\n"},
                     {"m.obj", "mtllib m.mtl\n" + quad + "usemtl red\n" + face}});
    };
    // The corner with vt (1, 1) and scale (2, 3), offset (.25, 0) looks up (2.25, 3), v counted
    // from below; from above, as the mesh has it, (1, 0) becomes (2.25, 1 - 3).
    const auto check = [&](const std::string &options, const glm::dvec2 &at_one,
                           const glm::dvec2 &at_zero) {
        CAPTURE(options);
        const Model model = with_options(options);
        CHECK(model.messages.empty());
        const glm::dmat3 to_uv = texture_of(model.scene).to_uv;
        const glm::dvec3 one = to_uv * glm::dvec3(1, 0, 1);
        const glm::dvec3 zero = to_uv * glm::dvec3(0, 1, 1);
        CHECK(one.x == Approx(at_one.x));
        CHECK(1 - one.y == Approx(at_one.y));
        CHECK(zero.x == Approx(at_zero.x).margin(1e-12));
        CHECK(1 - zero.y == Approx(at_zero.y).margin(1e-12));
    };
    check("", {1, 1}, {0, 0});
    check("-s 2 3 1 -o .25 0 0", {2.25, 3}, {.25, 0});
    check("-o .25 .5 -s 2 3", {2.25, 3.5}, {.25, .5});
    check("-s 2", {2, 1}, {0, 0});
    check("-o 0 -.125 0", {1, .875}, {0, -.125});
    check("-bm 1 -t 0 0 0 -mm 0 1 -cc off -s 2 2 2", {2, 2}, {0, 0});
    CHECK(texture_of(with_options("-clamp on").scene).wrap == TextureWrap::clamp);
    CHECK(texture_of(with_options("-clamp off").scene).wrap == TextureWrap::repeat);
    CHECK(with_options("-mm .1 2 -imfchan r -blendu off -type sphere -texres 64").messages ==
          "m.mtl:2: warning: not rendered: map_Kd -blendu, map_Kd -imfchan, map_Kd -mm, map_Kd "
          "-texres, "
          "map_Kd -type\n");
    for (const char *bad : {"-mm 1", "-s", "-clamp"}) {
        CAPTURE(bad);
        CHECK(has(test::error_of([&] { load("newmtl red\nmap_Kd " + std::string(bad) + "\n"); }),
                  "m.mtl:2: map_Kd: option"));
    }
    CHECK(has(test::error_of([&] { load("newmtl red\nmap_Kd -s 1 1 1\n"); }),
              "m.mtl:2: map_Kd: no file name"));
}

TEST_CASE("MTL statements that are not rendered are said in one line", "[obj]") {
    const Model model =
        load("newmtl red\nKa 1 1 1\nNs 10\nKd .9 .1 .1\nKs .5 .5 .5\nd 1\nTr 0\nillum 1\n"
             "refl b.png\nmap_Ns d.png\ndisp e.png\nrefl c.png\nmap_Ks s.png\n");
    CHECK(texture_of(model.scene).value == red);
    CHECK(model.messages == "m.mtl:9: warning: not rendered: refl, map_Ns, disp, map_Ks, Ks\n");
    CHECK(load("newmtl red\nKa 1 1 1\nKd .9 .1 .1\nKs 0 0 0\nNi 1.45\nNs 250\nd 1\nillum 2\n")
              .messages.empty());
    CHECK(has(load("newmtl red\nKd spectral a.rfl\n").messages, "not rendered: Kd spectral"));
    CHECK(has(load("Kd 1 1 1\nnewmtl red\n").messages, "m.mtl:1: warning: not rendered: Kd"));
}

TEST_CASE("MTL colours in all their forms", "[obj]") {
    const auto colour = [](const std::string &statements) {
        return texture_of(load("newmtl red\n" + statements + "\n").scene).value;
    };
    CHECK(colour("Kd .25") == Rgb(.25));
    CHECK(colour("Kd .25 .5 .75 # grey") == Rgb(.25, .5, .75));
    CHECK(colour("illum 2") == Rgb(.5));
    CHECK(colour("Kd .9 .1 .1\nd 0.5\nd 1\nTr .5") == red);
    // The white of sRGB (IEC 61966-2-1).
    const Rgb white = colour("Kd xyz .9505 1 1.089");
    for (int c = 0; c < 3; ++c)
        CHECK(white[c] == Approx(1).epsilon(1e-3));
    const Model halo = load("newmtl red\nKd 1 1 1\nNi 1.5\nd -halo .5\n");
    CHECK(std::holds_alternative<DielectricBsdf>(
        halo.scene.bsdfs.at(static_cast<std::size_t>(halo.scene.shapes.at(0).bsdf)).model));
    for (const char *bad : {"Kd", "Kd x", "Ni", "Tr one", "Kd xyz", "illum two"})
        CHECK(has(test::error_of([&] { load("newmtl red\n" + std::string(bad) + "\n"); }),
                  "m.mtl:2: "));
}

TEST_CASE("curved surfaces of an OBJ file are said to be left out", "[obj]") {
    CHECK(load({{"m.obj",
                 quad + face + "cstype bspline\nsurf 0 1 0 1 1 2 3 4\nsurf 0 1 0 1 1 2 3 4\n"}})
              .messages ==
          "m.obj:11: warning: curved surfaces (surf) are left out, expected polygons\n");
}
