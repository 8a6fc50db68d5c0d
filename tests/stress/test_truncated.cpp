/// Good files, cut off at every byte: each either loads or is refused with an InputError.

#include "error.h"
#include "image/image.h"
#include "program.h"
#include "scene/load_scene.h"

#include <catch2/catch.hpp>
#include <cstring>

using namespace clrender::test;

namespace {

const char *const scene = R"(<?xml version="1.0" encoding="utf-8"?>
<!-- A bit of everything. -->
<scene version="3.0.0">
    <default name="size" value="16"/>
    <integrator type="path"><integer name="max_depth" value="4"/></integrator>
    <sensor type="thinlens">
        <float name="fov" value="60"/><float name="focus_distance" value="4"/>
        <float name="aperture_radius" value=".1"/>
        <transform name="to_world"><lookat origin="0,3,-3" target="0,0,0" up="0,1,0"/></transform>
        <film type="hdrfilm"><integer name="width" value="$size"/></film>
    </sensor>
    <bsdf type="twosided" id="grey"><bsdf type="diffuse">
        <spectrum name="reflectance" value="400:0.4, 700:0.6"/>
    </bsdf></bsdf>
    <shape type="cube"><ref id="grey"/>
        <transform name="to_world"><matrix value="1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"/></transform>
    </shape>
    <shape type="obj"><string name="filename" value="model.obj"/></shape>
    <emitter type="point"><point name="position" x="0" y="2" z="0"/></emitter>
</scene>
)";

const char *const obj = "# a square\nmtllib model.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                        "vt 0 0\nvt 1 0\nvn 0 0 1\nusemtl red\nf 1/1/1 2/2/1 3/1/1\nf -4 -2 -1\n";
const char *const mtl = "newmtl red\nKd 1 0 0\nKs .1 .1 .1\nNs 10\nillum 2\n";
const char *const ascii_ply =
    "ply\nformat ascii 1.0\ncomment c\nelement vertex 3\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

/// The triangle of `ascii_ply` in the byte order of this machine.
std::string binary_ply() {
    std::string text = ascii_ply;
    text.resize(text.find("end_header\n") + std::strlen("end_header\n"));
    text.replace(text.find("ascii"), 5, "binary_little_endian");
    const auto append = [&](const auto &value) {
        text.append(reinterpret_cast<const char *>(&value), sizeof value);
    };
    for (const float coordinate : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F})
        append(coordinate);
    append(static_cast<unsigned char>(3));
    for (const int index : {0, 1, 2})
        append(index);
    return text;
}

/// Writes every beginning of `content` to `path` and reads it with `read`. Returns how many of them
/// loaded. Anything but an InputError ends the test.
template <class Read>
int read_every_beginning(const fs::path &path, const std::string &content, const Read &read) {
    int loaded = 0;
    for (std::size_t length = 0; length <= content.size(); ++length) {
        std::ofstream(path, std::ios::binary) << content.substr(0, length);
        INFO(path.filename().string() << ", " << length << " of " << content.size() << " bytes");
        try {
            read(path.string());
            ++loaded;
        } catch (const clrender::InputError &error) {
            // The whole file is good.
            INFO(error.what());
            REQUIRE(length < content.size());
        }
    }
    return loaded;
}

} // namespace

TEST_CASE("A scene cut off at any byte loads or is refused") {
    const TempFolder folder;
    folder.write("model.obj", obj);
    folder.write("model.mtl", mtl);
    const int loaded = read_every_beginning(folder.path() / "scene.xml", scene,
                                            [](const auto &path) { clrender::load_scene(path); });
    // Only the last line break can be missing.
    CHECK(loaded == 2);
}

TEST_CASE("A model cut off at any byte loads or is refused") {
    const TempFolder folder;
    const auto load = [](const std::string &path) { clrender::load_scene(path); };
    folder.write("model.mtl", mtl);
    read_every_beginning(folder.path() / "model.obj", obj, load);
    read_every_beginning(folder.path() / "ascii.ply", ascii_ply, load);
    CHECK(read_every_beginning(folder.path() / "binary.ply", binary_ply(), load) == 1);

    const auto load_model = [&](const std::string &) {
        clrender::load_scene((folder.path() / "model.obj").string());
    };
    read_every_beginning(folder.path() / "model.mtl", mtl, load_model);
}

TEST_CASE("An image cut off at any byte loads or is refused") {
    clrender::Image image;
    image.width = 5;
    image.height = 4;
    image.channels = 3;
    for (int i = 0; i < 60; ++i)
        image.f32.push_back(0.016F * static_cast<float>(i));

    for (const char *extension : {".png", ".jpg", ".hdr", ".exr", ".pfm"}) {
        const TempFolder folder;
        const fs::path good = folder.path() / ("good" + std::string(extension));
        clrender::write_image(good.string(), image);
        read_every_beginning(folder.path() / ("cut" + std::string(extension)), read_file(good),
                             [](const std::string &path) { clrender::read_image(path); });
    }
}
