/// Memory: --max-memory refuses before anything is taken, with the byte counts; what runs out all
/// the same is no device's fault.

// The sanitizers take memory of their own, and what OpenCL runtimes leak for failures.
#ifndef CLRENDER_SANITIZE

#include "program.h"
#include "small_scene.h"

#include <catch2/catch.hpp>

using namespace clrender::test;

namespace {

/// A PFM whose header promises `side` x `side` pixels, as a file with a hole of that length.
void write_sparse_pfm(const TempFolder &folder, const std::string &name, std::uint64_t side) {
    const std::string header =
        "Pf\n" + std::to_string(side) + " " + std::to_string(side) + "\n-1\n";
    folder.write(name, header);
    fs::resize_file(folder.path() / name, header.size() + 4 * side * side);
}

std::string textured(const std::string &file) {
    return "<scene version=\"3.0.0\"><integrator type=\"path\"/><sensor "
           "type=\"perspective\"/><shape type=\"sphere\">"
           "<bsdf type=\"diffuse\"><texture type=\"bitmap\" name=\"reflectance\">"
           "<string name=\"filename\" value=\"" +
           file + "\"/></texture></bsdf></shape><emitter type=\"constant\"/></scene>";
}

void check_refused(const ProgramResult &result, const std::string &part) {
    INFO(result.err);
    CHECK(result.exit_code == 2);
    CHECK(is_one_line(result.err));
    CHECK_THAT(result.err, Catch::Contains(part));
    CHECK_THAT(result.err, Catch::Contains("--max-memory"));
}

} // namespace

TEST_CASE(
    "the option --max-memory refuses pictures, meshes, scenes and films before they take memory") {
    const TempFolder folder;
    write_sparse_pfm(folder, "map.pfm", 8192);
    folder.write("map.xml", textured("map.pfm"));
    folder.write("scene.xml", lit_floor);
    folder.write("mesh.ply",
                 "ply\nformat binary_little_endian 1.0\nelement vertex 4000000\n"
                 "property float x\nproperty float y\nproperty float z\n"
                 "element face 1\nproperty list uchar int vertex_indices\nend_header\n");
    fs::resize_file(folder.path() / "mesh.ply", 48000300);
    folder.write("mesh.obj", "v 0 0 0\n");
    fs::resize_file(folder.path() / "mesh.obj", 48000000);
    std::string flood = "<scene version=\"3.0.0\">";
    for (int i = 0; i < 1000000; ++i)
        flood += "<a/>";
    folder.write("flood.xml", flood + "</scene>");

    const auto run = [&](const std::string &file, const std::string &limit) {
        return run_clrender(folder.path(), {file, "-q", "-o", "a.pfm", "--max-memory", limit});
    };
    check_refused(run("map.xml", "300M"), "8192 x 8192 needs 268435456 bytes");
    check_refused(run("map.xml", "100M"), "needs 268435472 bytes");
    check_refused(run("map.xml", "1G"), "the scene needs 1610612736 bytes");
    check_refused(run("mesh.ply", "100M"), "needs 176000012 bytes");
    check_refused(run("mesh.obj", "100M"), "240000000 bytes");
    const ProgramResult result = run("flood.xml", "60MiB");
    check_refused(result, "bytes");
    CHECK(result.peak_kib < 60 * 1024);
    check_refused(run_clrender(folder.path(), {"scene.xml", "-q", "-r", "1024x1024", "-o", "a.pfm",
                                               "--max-memory", "10M"}),
                  "the scene and the film need");
    CHECK_FALSE(folder.has("a.pfm"));
    CHECK(run("scene.xml", "1.5GiB").exit_code == 0);
}

TEST_CASE("Memory that runs out is told with what was being done") {
    const TempFolder folder;
    std::string scene = "<scene version=\"3.0.0\">";
    for (int i = 0; i < 500000; ++i)
        scene += "<bsdf type=\"diffuse\" id=\"b" + std::to_string(i) + "\"/>";
    folder.write("scene.xml", scene + "</scene>");
    const auto limit = [] {
        const rlimit bytes{300 << 20, 300 << 20};
        setrlimit(RLIMIT_AS, &bytes);
    };
    const ProgramResult result =
        run_clrender(folder.path(), {"scene.xml", "-o", "a.pfm"}, {}, limit);
    INFO(result.err);
    CHECK(result.exit_code == 5);
    CHECK(result.err == "clrender: out of memory while reading scene.xml\n");
    CHECK_FALSE(folder.has("a.pfm"));
}

#endif
