/// The command line as a contract: exit codes, what is printed and what is written.

#include "program.h"
#include "small_scene.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <set>

using namespace clrender::test;

namespace {

const std::string small_scene =
    scene_of({.power = "$power", .defaults = "    <default name=\"power\" value=\"10\"/>\n"});

} // namespace

TEST_CASE("The version and the help are printed") {
    const TempFolder folder;
    const ProgramResult version = run_clrender(folder.path(), {"--version"});
    CHECK(version.exit_code == 0);
    CHECK(version.out == "clrender " CLRENDER_VERSION "\n");
    CHECK(version.err.empty());

    const ProgramResult help = run_clrender(folder.path(), {"--help"});
    CHECK(help.exit_code == 0);
    for (const char *option :
         {"--output",    "--device",        "--list-devices", "--spp",     "--resolution",
          "--max-depth", "--rr-depth",      "--seed",         "--lanes",   "-D",
          "--exposure",  "--pixel-centers", "--accel",        "--check",   "--stats",
          "--profile",   "--quiet",         "--verbose",      "--version", "compare",
          "test",        "--precision"})
        CHECK_THAT(help.out, Catch::Contains(option));
}

TEST_CASE("The list of devices names at least one device") {
    const TempFolder folder;
    const ProgramResult result = run_clrender(folder.path(), {"--list-devices"});
    CHECK(result.exit_code == 0);
    CHECK_FALSE(result.out.empty());
}

TEST_CASE("A wrong option: exit code 2 and one line") {
    const TempFolder folder;
    folder.write("scene.xml", small_scene);
    for (const std::vector<std::string> &arguments : std::vector<std::vector<std::string>>{
             {"scene.xml", "--no-such-option"}, {"scene.xml", "-s", "0"}, {}}) {
        const ProgramResult result = run_clrender(folder.path(), arguments);
        CHECK(result.exit_code == 2);
        CHECK(is_one_line(result.err));
        CHECK(result.out.empty());
    }
    CHECK_FALSE(folder.has("scene.png"));
}

TEST_CASE("Wrong input: exit code 2, one line with the place, no picture") {
    const TempFolder folder;
    const ProgramResult missing = run_clrender(folder.path(), {"missing.xml"});
    CHECK(missing.exit_code == 2);
    CHECK(is_one_line(missing.err));
    CHECK_THAT(missing.err, Catch::StartsWith("missing.xml:"));

    folder.write("bad.xml", "<scene version=\"3.0.0\">\n  <shape type=\"blob\"/>\n</scene>\n");
    const ProgramResult bad = run_clrender(folder.path(), {"bad.xml"});
    CHECK(bad.exit_code == 2);
    CHECK(is_one_line(bad.err));
    CHECK_THAT(bad.err, Catch::StartsWith("bad.xml:2:") && Catch::Contains("blob"));
    CHECK_FALSE(folder.has("bad.png"));
    CHECK_FALSE(folder.has("bad.exr"));
}

TEST_CASE("A check reads the scene and writes nothing") {
    const TempFolder folder;
    folder.write("scene.xml", small_scene);
    CHECK(run_clrender(folder.path(), {"--check", "scene.xml"}).exit_code == 0);
    CHECK_FALSE(folder.has("scene.png"));
    CHECK_FALSE(folder.has("scene.exr"));
}

TEST_CASE("A check tells the memory that the device will need") {
    const TempFolder folder;
    const std::string scene = std::string(CLRENDER_SCENE_DIR) + "/mesh_bvh.xml";
    // For the statistics some tiles are rendered twice, which takes memory too.
    const ProgramResult check =
        run_clrender(folder.path(), {"--check", scene, "-r", "100x70", "--stats", "stats.json"});
    REQUIRE(check.exit_code == 0);
    const std::size_t end = check.err.find(" MiB on the device");
    REQUIRE(end != std::string::npos);
    const double predicted = std::stod(check.err.substr(check.err.rfind(' ', end - 1))) * (1 << 20);
    REQUIRE(run_clrender(folder.path(), {scene, "-r", "100x70", "-s", "1", "--stats", "stats.json"})
                .exit_code == 0);
    const auto stats = nlohmann::json::parse(read_file(folder.path() / "stats.json"));
    CHECK(predicted == Approx(stats["memory"]["device_bytes"].get<double>()).epsilon(0.05));
}

TEST_CASE("Without -o the picture is SCENE.png and SCENE.exr in the current folder") {
    const TempFolder folder;
    fs::create_directory(folder.path() / "scenes");
    folder.write("scenes/small.xml", small_scene);
    CHECK(run_clrender(folder.path(), {"scenes/small.xml"}).exit_code == 0);
    CHECK(folder.has("small.png"));
    CHECK(folder.has("small.exr"));
}

TEST_CASE("The number of threads does not change a bit of the picture") {
    const TempFolder folder;
    const std::string scene = folder.write("scene.xml", small_scene);
    for (const std::string threads : {"1", "2", "3"}) {
        // What PoCL is told; other runtimes take as many as they like.
        const ProgramResult result = run_clrender(
            folder.path(), {"-q", "-s", "64", "-r", "64x48", "-o", threads + ".pfm", scene},
            {{"POCL_MAX_PTHREAD_COUNT", threads}});
        REQUIRE(result.exit_code == 0);
        CHECK(read_file(folder.path() / (threads + ".pfm")) == read_file(folder.path() / "1.pfm"));
    }
}

TEST_CASE("Every output format is written") {
    const TempFolder folder;
    folder.write("scene.xml", small_scene);
    const std::vector<std::string> names = {"a.png", "a.jpg", "a.hdr", "a.exr", "a.pfm"};
    std::vector<std::string> arguments = {"scene.xml", "-q"};
    for (const std::string &name : names)
        arguments.insert(arguments.end(), {"-o", name});
    const ProgramResult result = run_clrender(folder.path(), arguments);
    CHECK(result.exit_code == 0);
    CHECK(result.err.empty());
    CHECK(result.out.empty());
    for (const std::string &name : names)
        CHECK(folder.has(name));
    CHECK_FALSE(folder.has("scene.png"));
}

TEST_CASE("A -D that nothing uses is a warning") {
    const TempFolder folder;
    folder.write("scene.xml", small_scene);
    const ProgramResult result =
        run_clrender(folder.path(), {"--check", "scene.xml", "-D", "power=3", "-D", "sparkle=1"});
    CHECK(result.exit_code == 0);
    CHECK_THAT(result.err, Catch::Contains("warning") && Catch::Contains("sparkle"));
    CHECK_THAT(result.err, !Catch::Contains("power"));
}

TEST_CASE("The statistics hold every figure of the contract") {
    const TempFolder folder;
    folder.write("scene.xml", small_scene);
    REQUIRE(run_clrender(folder.path(), {"scene.xml", "-o", "a.pfm", "--stats", "s.json", "-r",
                                         "20x10", "-s", "8"})
                .exit_code == 0);
    const auto stats = nlohmann::json::parse(read_file(folder.path() / "s.json"));
    CHECK(stats.at("device").is_string());
    CHECK(stats.at("lanes").get<int>() >= 1);
    CHECK(stats.at("width") == 20);
    CHECK(stats.at("height") == 10);
    CHECK(stats.at("spp") == 8);
    CHECK(stats.at("paths") == 20 * 10 * 8);
    CHECK(stats.at("rays").get<double>() >= stats.at("paths").get<double>());
    CHECK(stats.at("paths_per_second").get<double>() > 0);
    CHECK(stats.at("rays_per_second").get<double>() > 0);
    for (const char *phase : {"parse", "build", "compile", "upload", "render", "write", "total"}) {
        INFO(phase);
        CHECK(stats.at("seconds").at(phase).get<double>() >= 0);
    }
    CHECK(stats.at("kernel").contains("features"));
    CHECK(stats.at("kernel").contains("cache"));
    CHECK(stats.at("memory").at("host_bytes").get<double>() > 0);
    CHECK(stats.at("memory").at("device_bytes").get<double>() > 0);
    CHECK(stats.at("triangles").is_number_integer());
    CHECK(stats.at("nonfinite_samples") == 0);
}

TEST_CASE("A profile is printed behind the picture, whatever else is quiet") {
    const TempFolder folder;
    folder.write("scene.xml", small_scene);
    const ProgramResult result =
        run_clrender(folder.path(), {"-q", "-o", "a.pfm", "--profile", "scene.xml"});
    CHECK(result.exit_code == 0);
    CHECK(folder.has("a.pfm"));
    for (const char *text : {"path_trace", "device s", "million rays", "nodes and", "lanes alive",
                             "uploaded", "float operations"})
        CHECK_THAT(result.out, Catch::Contains(text));

    REQUIRE(run_clrender(folder.path(), {"-q", "-o", "b.pfm", "scene.xml"}).exit_code == 0);
    CHECK(read_file(folder.path() / "a.pfm") == read_file(folder.path() / "b.pfm"));
}

TEST_CASE("A trace holds the phases and every launch, within the time of the run") {
    const TempFolder folder;
    folder.write("scene.xml", small_scene);
    const ProgramResult result =
        run_clrender(folder.path(), {"scene.xml", "-o", "a.pfm", "-r", "40x30", "-s", "200",
                                     "--stats", "s.json", "--profile", "t.json"});
    REQUIRE(result.exit_code == 0);
    const auto trace = nlohmann::json::parse(read_file(folder.path() / "t.json"));
    const auto stats = nlohmann::json::parse(read_file(folder.path() / "s.json"));
    const double total_us = 1e6 * stats.at("seconds").at("total").get<double>();

    std::set<std::string> names;
    int kernels = 0;
    for (const auto &event : trace.at("traceEvents")) {
        if (event.at("ph") != "X")
            continue;
        INFO(event.dump());
        names.insert(event.at("name").get<std::string>());
        kernels += event.at("cat") == "kernel" ? 1 : 0;
        const auto start = event.at("ts").get<double>();
        const auto duration = event.at("dur").get<double>();
        CHECK(start >= 0);
        CHECK(duration >= 0);
        CHECK(start + duration <= total_us);
    }
    for (const char *name : {"parse", "build", "compile", "upload", "render", "read",
                             "measure peak", "write", "path_trace", "read counters"})
        CHECK(names.count(name) == 1);
    CHECK(kernels >= 4); // 200 samples are four blocks

    const auto &sums = trace.at("otherData");
    const double camera = sums.at("camera_rays"), bounce = sums.at("bounce_rays");
    const double shadow = sums.at("shadow_rays");
    CHECK(camera == stats.at("paths").get<double>());
    CHECK(camera + bounce + shadow == stats.at("rays").get<double>());
    CHECK(sums.at("peak_flops").get<double>() > 1e6);
    CHECK(sums.at("peak_bytes_per_second").get<double>() > 1e6);
}

TEST_CASE("compare: 0 for the same picture, 1 for another, 2 for none") {
    const TempFolder folder;
    folder.write("scene.xml", small_scene);
    REQUIRE(run_clrender(folder.path(), {"scene.xml", "-o", "a.pfm"}).exit_code == 0);
    REQUIRE(run_clrender(folder.path(), {"scene.xml", "-o", "b.pfm"}).exit_code == 0);
    REQUIRE(run_clrender(folder.path(), {"scene.xml", "-o", "c.pfm", "-D", "power=20"}).exit_code ==
            0);
    const auto compare = [&](const std::vector<std::string> &arguments) {
        std::vector<std::string> all = {"compare"};
        all.insert(all.end(), arguments.begin(), arguments.end());
        return run_clrender(folder.path(), all);
    };

    const ProgramResult same = compare({"a.pfm", "b.pfm"});
    CHECK(same.exit_code == 0);
    CHECK_THAT(same.out, Catch::Contains("relMSE"));
    CHECK(compare({"a.pfm", "c.pfm"}).exit_code == 1);
    CHECK(compare({"a.pfm", "c.pfm", "--tolerance", "1000"}).exit_code == 0);

    const ProgramResult seen = compare({"a.pfm", "c.pfm", "--flip", "flip.png"});
    CHECK_THAT(seen.out, Catch::Contains("FLIP                0."));
    CHECK(folder.has("flip.png"));
    CHECK(compare({"a.pfm", "c.pfm", "--flip", "flip.exr"}).exit_code == 2);

    const ProgramResult missing = compare({"a.pfm", "no.pfm"});
    CHECK(missing.exit_code == 2);
    CHECK(is_one_line(missing.err));
}

TEST_CASE("No device: exit code 3, one line with the reason") {
    const TempFolder folder;
    folder.write("scene.xml", small_scene);
    const ProgramResult unknown =
        run_clrender(folder.path(), {"scene.xml", "-d", "no such device"});
    CHECK(unknown.exit_code == 3);
    CHECK(is_one_line(unknown.err));
    CHECK_FALSE(folder.has("scene.png"));

    // An empty list of vendors is a machine without OpenCL; the line names the package to install.
    const ProgramResult none = run_clrender(folder.path(), {"scene.xml"},
                                            {{"OCL_ICD_VENDORS", folder.path().string() + "/"}});
    CHECK(none.exit_code == 3);
    CHECK(is_one_line(none.err));
    CHECK_THAT(none.err, Catch::Contains("pocl-opencl-icd"));
}

TEST_CASE("Ctrl-C writes the picture so far and says so") {
    const TempFolder folder;
    folder.write("scene.xml", small_scene);
    REQUIRE(run_clrender(folder.path(), {"scene.xml", "-o", "warm.pfm"}).exit_code == 0);
    Program program(folder.path(),
                    {"scene.xml", "-v", "-o", "a.pfm", "-r", "256x256", "-s", "1073741824"});
    program.wait_for("the first launch has ended");
    const auto start = std::chrono::steady_clock::now();
    program.send(SIGINT);
    const ProgramResult result = program.wait();
    CHECK(result.exit_code == 130);
    REQUIRE(folder.has("a.pfm"));
    const std::string picture = read_file(folder.path() / "a.pfm");
    CHECK(picture.find_first_not_of('\0', picture.size() - 256 * 256 * 12) != std::string::npos);
    CHECK_THAT(result.err, Catch::Contains("nterrupted"));
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(5));
}
