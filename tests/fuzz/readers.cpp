#include "readers.h"

#include "error.h"
#include "flatten/flat_scene.h"
#include "image/image.h"
#include "log.h"
#include "memory_limit.h"
#include "program.h"
#include "scene/load_scene.h"
#include "scene/mesh_io.h"
#include "scene/polygon.h"
#include "verify/reference.h"

#include <cstdint>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <vector>

namespace clrender::fuzz {

namespace {

/// Enough for every input of 1 MiB that is worth reading; a process of libFuzzer may take 512 MiB.
constexpr std::uint64_t memory_for_inputs = std::uint64_t{128} << 20;

void load_and_flatten(const std::string &path) {
    FlatScene flat = flatten(load_scene(path));
    build_hierarchy(flat);
}

/// Both ways to a mesh: from the beginning, and by the dictionary.
void load_serialized(const std::string &path) {
    (void)read_serialized_mesh(path, {.shape_index = 1, .attributes = {"vertex_color"}});
    (void)read_serialized_mesh(path, {});
}

void load_picture(const std::string &path) {
    (void)read_image(path);
}

void load_reference(const std::string &path) {
    (void)verify::read_reference(path);
}

/// A whole number of `bytes` bytes, the lowest first, with a sign.
double signed_number(const unsigned char *first, int bytes) {
    std::int32_t value = 0;
    for (int i = 0; i < bytes; ++i)
        value += first[i] << (8 * i);
    return value >= 1 << (8 * bytes - 1) ? value - (1 << (8 * bytes)) : value;
}

/// Cuts a polygon of whole coordinates, so that corners often repeat and lie on straight lines: x
/// and y of two bytes, z of one.
void cut_polygon(const std::string &path) {
    std::ifstream file(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const auto *bytes = reinterpret_cast<const unsigned char *>(text.data());
    std::vector<glm::dvec3> corners;
    for (std::size_t at = 0; at + 5 <= text.size(); at += 5)
        corners.emplace_back(signed_number(bytes + at, 2), signed_number(bytes + at + 2, 2),
                             signed_number(bytes + at + 4, 1));
    if (corners.size() < 3)
        return;
    PolygonCutter cutter;
    cutter.cut(corners);
    if (cutter.triangles().empty() || cutter.triangles().size() > corners.size() - 2)
        throw std::logic_error("a polygon has too few triangles, or too many");
    for (const PolygonCutter::Triangle &triangle : cutter.triangles())
        for (const std::uint32_t corner : triangle)
            if (corner >= corners.size())
                throw std::logic_error("a triangle has a corner that the polygon has not");
}

/// The folder that all files of this process are written to, with a mesh and a picture that scenes
/// can name.
const test::TempFolder &folder() {
    static const test::TempFolder folder;
    static const bool filled = [] {
        folder.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
        folder.write("map.pfm", std::string("PF\n2 1\n-1\n") + std::string(24, '\x3f'));
        return true;
    }();
    (void)filled;
    return folder;
}

} // namespace

const std::vector<Reader> &readers() {
    static const std::vector<Reader> all = {
        {"xml", ".xml", load_and_flatten}, {"obj", ".obj", load_and_flatten},
        {"ply", ".ply", load_and_flatten}, {"serialized", ".serialized", load_serialized},
        {"png", ".png", load_picture},     {"jpeg", ".jpg", load_picture},
        {"tga", ".tga", load_picture},     {"bmp", ".bmp", load_picture},
        {"hdr", ".hdr", load_picture},     {"exr", ".exr", load_picture},
        {"pfm", ".pfm", load_picture},     {"reference", ".exr", load_reference},
        {"polygon", ".bin", cut_polygon},  {"gltf", ".gltf", load_and_flatten}};
    return all;
}

void read_bytes(const Reader &reader, std::string_view bytes) {
    const std::size_t mark =
        reader.extension == ".obj" ? bytes.find(mtl_mark) : std::string_view::npos;
    if (mark != std::string_view::npos) {
        folder().write("model.mtl", std::string(bytes.substr(mark + mtl_mark.size())));
        bytes = bytes.substr(0, mark + 1);
    }
    const std::string name = folder().write("model" + reader.extension, std::string(bytes));

    set_memory_limit(memory_for_inputs);
    const log::Holder messages;
    try {
        reader.read((folder().path() / name).string());
    } catch (const InputError &error) {
        const std::string_view line = error.what();
        if (line.empty() || line.find('\n') != std::string_view::npos)
            throw std::logic_error("a refusal that is not one line: " + std::string(line));
    }
}

} // namespace clrender::fuzz
