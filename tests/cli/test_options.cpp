/// The parser of the command line, without running the program.

#include "cli/options.h"
#include "cli/progress.h"

#include <catch2/catch.hpp>

using clrender::cli::Command;
using clrender::cli::Options;
using clrender::cli::ParseResult;

namespace {

ParseResult parse(std::vector<const char *> arguments) {
    arguments.insert(arguments.begin(), "clrender");
    return clrender::cli::parse_options(static_cast<int>(arguments.size()), arguments.data());
}

Options accept(const std::vector<const char *> &arguments) {
    const ParseResult result = parse(arguments);
    REQUIRE(result.options.has_value());
    return *result.options;
}

} // namespace

TEST_CASE("A scene alone: everything else is left to the scene and the program") {
    const Options options = accept({"folder/room.v2.xml"});
    CHECK(options.command == Command::render);
    CHECK(options.scene == "folder/room.v2.xml");
    CHECK(options.outputs == std::vector<std::string>{"room.v2.png", "room.v2.exr"});
    CHECK(options.device == "auto");
    CHECK_FALSE(options.spp.has_value());
    CHECK_FALSE(options.resolution.has_value());
    CHECK_FALSE(options.max_depth.has_value());
    CHECK_FALSE(options.rr_depth.has_value());
    CHECK_FALSE(options.seed.has_value());
    CHECK(options.lanes == 0);
    CHECK(options.sampling.light_samples == 0);
    CHECK(options.sampling.strategy == clrender::Strategy::mis);
    CHECK(!options.sampling.brute_force);
    CHECK(options.exposure == 0);
    CHECK(options.defines.empty());
    CHECK(options.stats.empty());
}

TEST_CASE("Every option of the contract is read") {
    const Options options = accept({"-o",
                                    "a.png",
                                    "--output=b.exr",
                                    "-d",
                                    "gpu",
                                    "-s",
                                    "7",
                                    "-r",
                                    "40x30",
                                    "--max-depth",
                                    "-1",
                                    "--rr-depth",
                                    "5",
                                    "--seed",
                                    "4294967295",
                                    "--lanes",
                                    "16",
                                    "-D",
                                    "a=1",
                                    "-Db=x=y",
                                    "--exposure",
                                    "-1.5",
                                    "--pixel-centers",
                                    "--light-samples",
                                    "8",
                                    "--strategy",
                                    "bsdf",
                                    "--specular-connections",
                                    "off",
                                    "--accel",
                                    "none",
                                    "--check",
                                    "--stats",
                                    "s.json",
                                    "-v",
                                    "scene.xml"});
    CHECK(options.scene == "scene.xml");
    CHECK(options.outputs == std::vector<std::string>{"a.png", "b.exr"});
    CHECK(options.device == "gpu");
    CHECK(options.spp == 7);
    REQUIRE(options.resolution.has_value());
    CHECK(options.resolution->width == 40);
    CHECK(options.resolution->height == 30);
    CHECK(options.max_depth == -1);
    CHECK(options.rr_depth == 5);
    CHECK(options.seed == 4294967295U);
    CHECK(options.lanes == 16);
    CHECK(options.defines == std::map<std::string, std::string>{{"a", "1"}, {"b", "x=y"}});
    CHECK(options.exposure == -1.5);
    CHECK(options.sampling.pixel_centers);
    CHECK(options.sampling.light_samples == 8);
    CHECK(options.sampling.strategy == clrender::Strategy::bsdf);
    CHECK_FALSE(options.sampling.specular_connections);
    CHECK(options.sampling.brute_force);
    CHECK(options.check);
    CHECK(options.stats == "s.json");
    CHECK(options.verbose);
    CHECK_FALSE(options.quiet);
}

TEST_CASE("The last -D of a name counts, and a value may be empty") {
    const Options options = accept({"-D", "a=1", "-D", "a=2", "-D", "b=", "scene.xml"});
    CHECK(options.defines == std::map<std::string, std::string>{{"a", "2"}, {"b", ""}});
}

TEST_CASE("A profile takes the argument behind it only where that is a .json file") {
    CHECK_FALSE(accept({"scene.xml"}).profile);

    const Options bare = accept({"--profile", "scene.xml"});
    CHECK(bare.profile);
    CHECK(bare.profile_trace.empty());
    CHECK(bare.scene == "scene.xml");
    CHECK(accept({"scene.xml", "--profile"}).profile);
    CHECK(accept({"scene.xml", "--profile", "-s", "4"}).spp == 4);
    CHECK(accept({"scene.xml", "--profile", "--stats=s.json"}).stats == "s.json");
    CHECK(accept({"--profile", "--", "scene.json"}).scene == "scene.json");

    for (const auto &arguments :
         std::vector<std::vector<const char *>>{{"--profile", "t.json", "scene.xml"},
                                                {"scene.xml", "--profile", "t.json"},
                                                {"scene.xml", "--profile=t.json"}}) {
        const Options options = accept(arguments);
        CHECK(options.profile);
        CHECK(options.profile_trace == "t.json");
        CHECK(options.scene == "scene.xml");
    }
}

TEST_CASE("Features that the kernel gets though the scene does not need them") {
    CHECK(accept({"scene.xml"}).sampling.forced_features.empty());
    CHECK(accept({"scene.xml", "--generic", "HAS_LENS,HAS_CLIP", "--generic=HAS_ALPHA"})
              .sampling.forced_features ==
          std::set<std::string>{"HAS_ALPHA", "HAS_CLIP", "HAS_LENS"});
    CHECK(accept({"scene.xml", "--generic", "all"}).sampling.forced_features.count("LIGHT_COUNT") ==
          1);
}

TEST_CASE("Double precision has one lane") {
    CHECK_FALSE(accept({"scene.xml"}).double_precision);
    CHECK_FALSE(accept({"scene.xml", "--precision", "single", "--lanes", "8"}).double_precision);
    CHECK(accept({"scene.xml", "--precision", "double"}).double_precision);
    CHECK(accept({"scene.xml", "--precision", "double", "--lanes", "1"}).double_precision);
}

TEST_CASE("The other commands") {
    CHECK(accept({"--list-devices"}).command == Command::list_devices);
    const Options compare = accept({"compare", "a.exr", "b.exr", "--tolerance", "1e-3"});
    CHECK(compare.command == Command::compare);
    CHECK(compare.compare.a == "a.exr");
    CHECK(compare.compare.b == "b.exr");
    CHECK(compare.compare.tolerance == 1e-3);
    CHECK(accept({"compare", "a.exr", "b.exr"}).compare.tolerance == 0);
}

TEST_CASE("Values at the edge of what is allowed") {
    CHECK(accept({"x.xml", "-s", "1073741824"}).spp == 1073741824);
    CHECK(accept({"x.xml", "-r", "65536x4096"}).resolution->height == 4096);
    CHECK(accept({"x.xml", "-r", "1x1"}).resolution->width == 1);
    CHECK(accept({"x.xml", "--max-depth", "0"}).max_depth == 0);
    CHECK(accept({"x.xml", "--rr-depth", "1"}).rr_depth == 1);
    CHECK_FALSE(accept({"x.xml", "--rr-depth", "1"}).weight_window);
    CHECK(accept({"x.xml", "--rr-depth", "auto"}).weight_window);
    CHECK_FALSE(accept({"x.xml", "--rr-depth", "auto"}).rr_depth.has_value());
    CHECK(accept({"x.xml", "--seed", "0"}).seed == 0U);
    CHECK(accept({"x.xml", "--sensor", "2"}).sensor == 2);
    CHECK_FALSE(accept({"x.xml"}).sensor.has_value());
}

TEST_CASE("Times and errors that end a render") {
    const auto seconds = [](const char *text) {
        return accept({"x.xml", "--time", text}).stop.seconds.value_or(-1);
    };
    CHECK(seconds("90") == 90);
    CHECK(seconds("90s") == 90);
    CHECK(seconds("1.5m") == 90);
    CHECK(seconds("2h") == 7200);
    CHECK(seconds("1h30m") == 5400);
    CHECK(seconds("1h0m5s") == 3605);
    CHECK(accept({"x.xml", "--target-error", "1%"}).stop.error == 0.01);
    CHECK(accept({"x.xml", "--target-error", "0.02"}).stop.error == 0.02);
    CHECK_FALSE(accept({"x.xml"}).stop.any());
}

TEST_CASE("A mistake ends with exit code 2") {
    const std::vector<std::vector<const char *>> mistakes = {
        {},
        {"a.xml", "b.xml"},
        {"x.xml", "--unknown"},
        {"x.xml", "--precision", "half"},
        {"x.xml", "--precision", "double", "--lanes", "8"},
        {"x.xml", "-s"},
        {"x.xml", "-s", "0"},
        {"x.xml", "-s", "-1"},
        {"x.xml", "-s", "1e3"},
        {"x.xml", "-s", "12abc"},
        {"x.xml", "-s", "1073741825"},
        {"x.xml", "-s", "2147483585"},
        {"x.xml", "-s", "2147483648"},
        {"x.xml", "-s", "1099511627776"},
        {"x.xml", "-s", "99999999999999999999999"},
        {"x.xml", "-s", "1", "-s", "2"},
        {"x.xml", "-r", "640"},
        {"x.xml", "-r", "640x"},
        {"x.xml", "-r", "640x480x3"},
        {"x.xml", "-r", "0x480"},
        {"x.xml", "-r", "640x-480"},
        {"x.xml", "-r", "65537x1"},
        {"x.xml", "-r", "65536x4097"},
        {"x.xml", "--max-depth", "-2"},
        {"x.xml", "--rr-depth", "0"},
        {"x.xml", "--seed", "-1"},
        {"x.xml", "--sensor", "-1"},
        {"x.xml", "--seed", "4294967296"},
        {"x.xml", "--lanes", "2"},
        {"x.xml", "--lanes", "wide"},
        {"x.xml", "-D", "name"},
        {"x.xml", "-D", "=value"},
        {"x.xml", "-D", "a b=1"},
        {"x.xml", "--exposure", "nan"},
        {"x.xml", "--exposure", "inf"},
        {"x.xml", "--exposure", "1e999"},
        {"x.xml", "--exposure", ""},
        {"x.xml", "--light-samples", "3"},
        {"x.xml", "--strategy", "both"},
        {"x.xml", "--accel", "kd"},
        {"x.xml", "--time", ""},
        {"x.xml", "--time", "0s"},
        {"x.xml", "--time", "-1s"},
        {"x.xml", "--time", "5x"},
        {"x.xml", "--time", "1m2h"},
        {"x.xml", "--time", "1m2"},
        {"x.xml", "--time", "1mm"},
        {"x.xml", "--time", "nan"},
        {"x.xml", "--target-error", "0"},
        {"x.xml", "--target-error", "1x"},
        {"x.xml", "--target-error", "101%"},
        {"x.xml", "--time", "5s", "--profile"},
        {"test", "x.xml", "--reference", "a.exr", "--time", "5s"},
        {"x.xml", "-d", ""},
        {"x.xml", "-o", ""},
        {"x.xml", "-o", "picture"},
        {"x.xml", "-o", "picture.gif"},
        {"x.xml", "-o", "no/such/folder/a.png"},
        {"x.xml", "-o", "a.png", "-o", "./a.png"},
        {"x.xml", "--stats", "no/such/folder/a.json"},
        {"x.xml", "--stats", "./a.png", "-o", "a.png"},
        {"x.xml", "--stats", "t.json", "--profile", "./t.json"},
        {"x.xml", "--profile=t.txt"},
        {"x.xml", "--profile", "t.txt"},
        {"x.xml", "--profile", "no/such/folder/t.json"},
        {"x.xml", "--kernel-dir", "no/such/folder"},
        {"x.xml", "--generic", ""},
        {"x.xml", "--generic", "HAS_NOTHING"},
        {"x.xml", "--generic", "LANES"},
        {"x.xml", "-q", "-v"},
        {"compare"},
        {"compare", "a.exr"},
        {"compare", "a.exr", "b.exr", "c.exr"},
        {"compare", "a.exr", "b.exr", "--tolerance", "-1"},
        {"compare", "a.exr", "b.exr", "--tolerance", "nan"},
        {"x.xml", "compare", "a.exr", "b.exr"},
    };
    for (const auto &arguments : mistakes) {
        std::string line = "clrender";
        for (const char *argument : arguments)
            line += std::string(" ") + argument;
        INFO(line);
        const ParseResult result = parse(arguments);
        CHECK_FALSE(result.options.has_value());
        CHECK(result.exit_code == 2);
    }
}

TEST_CASE("Help and version end with exit code 0") {
    for (const char *argument : {"--help", "-h", "--version"}) {
        const ParseResult result = parse({argument});
        CHECK_FALSE(result.options.has_value());
        CHECK(result.exit_code == 0);
    }
}

TEST_CASE("Durations are rounded up and read as people say them") {
    CHECK(clrender::cli::format_duration(0) == "0 s");
    CHECK(clrender::cli::format_duration(7.2) == "8 s");
    CHECK(clrender::cli::format_duration(59.5) == "1 m 00 s");
    CHECK(clrender::cli::format_duration(125) == "2 m 05 s");
    CHECK(clrender::cli::format_duration(12000) == "3 h 20 m");
}
