/// `clrender test` on a box of 64x48 pixels, through the program: false alarms and misses. 100 and
/// 20 seeds under CLRENDER_STRESS=full (scripts/stress), where the ordinary tests have a few.

#include "program.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <fmt/core.h>

using namespace clrender::test;

namespace {

const fs::path data = fs::path(CLRENDER_TEST_DIR) / "cli" / "data";

bool full_stress() {
    const char *value = std::getenv("CLRENDER_STRESS");
    return value != nullptr && std::string(value) == "full";
}

/// Renders the reference, of another seed than all tests.
void make_reference(const TempFolder &folder, const std::vector<std::string> &options) {
    std::vector<std::string> arguments = {
        (data / "box.xml").string(), "--seed", "1000", "-o", "right.exr", "-q"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ProgramResult result = run_clrender(folder.path(), arguments);
    INFO(result.err);
    REQUIRE(result.exit_code == 0);
}

ProgramResult test_box(const TempFolder &folder, int seed,
                       const std::vector<std::string> &options) {
    std::vector<std::string> arguments = {
        "test",   (data / "box.xml").string(), "--reference", "right.exr", "-q",
        "--seed", std::to_string(seed)};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run_clrender(folder.path(), arguments);
}

/// Runs `seeds` seeds and counts those that end with `exit_code`.
int count_ends(const TempFolder &folder, int seeds, int exit_code,
               const std::vector<std::string> &options) {
    int count = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
        const ProgramResult result = test_box(folder, seed, options);
        REQUIRE(result.exit_code <= 1);
        count += result.exit_code == exit_code ? 1 : 0;
        UNSCOPED_INFO("seed " << seed << ": " << result.out);
    }
    return count;
}

/// One line of the table that scripts/stress gathers.
void print_check(const std::string &what, int count, int seeds, int bar) {
    fmt::print("check  clrender test  {}  {} of {} seeds  at most {}  {}\n", what, count, seeds,
               bar, count <= bar ? "pass" : "FAIL");
}

} // namespace

TEST_CASE("clrender test raises no false alarm", "[stress]") {
    const TempFolder folder;
    const bool full = full_stress();
    make_reference(folder, {"-s", full ? "16384" : "1024", "--aov", "variance,samples"});
    const int seeds = full ? 100 : 3;
    const int alarms = count_ends(folder, seeds, 1, {"-s", full ? "8192" : "1024"});
    print_check("false alarms", alarms, seeds, full ? 1 : 0);
    CHECK(alarms <= (full ? 1 : 0));
    CHECK(!folder.has("right_differs.png"));
}

TEST_CASE("clrender test sees what is wrong", "[stress]") {
    const TempFolder folder;
    const bool full = full_stress();
    make_reference(folder, {"-s", full ? "16384" : "4096", "--aov", "variance,samples"});
    const int seeds = full ? 20 : 1;
    const std::vector<std::pair<std::string, std::string>> faults = {
        {"misses of an albedo 2% off", "floor=0.612"},
        {"misses of a light 2% off", "light=10.2"},
        {"misses of a triangle of 16 pixels, 10% of contrast", "mesh=box_without_triangle.obj"}};
    for (const auto &[name, define] : faults) {
        INFO(name);
        const int misses = seeds - count_ends(folder, seeds, 1, {"-D", define});
        print_check(name, misses, seeds, 0);
        CHECK(misses == 0);
    }
    CHECK(folder.has("right_differs.png"));
}

TEST_CASE("clrender test excludes the effect that is asked for, or says that it cannot") {
    const TempFolder folder;
    make_reference(folder, {"-s", "1024", "-r", "16x12", "--aov", "variance,samples"});
    const ProgramResult same =
        test_box(folder, 1, {"-r", "16x12", "--effect", "20%", "-o", "picture.exr"});
    INFO(same.out << same.err);
    CHECK(same.exit_code == 0);
    CHECK_THAT(same.out, Catch::StartsWith("test: same, after 1024 samples a pixel, 1 look"));
    CHECK(folder.has("picture.exr"));

    const ProgramResult undecided =
        test_box(folder, 1, {"-r", "16x12", "--effect", "0.001%", "-s", "1000"});
    INFO(undecided.out << undecided.err);
    CHECK(undecided.exit_code == 0);
    CHECK_THAT(undecided.out, Catch::StartsWith("test: cannot decide, after 960 samples"));
}

TEST_CASE("clrender test knows the colours of a film in XYZ, and of a grey one") {
    const std::string format = GENERATE("xyz", "luminance");
    const TempFolder folder;
    make_reference(folder, {"-s", "1024", "-r", "16x12", "-D", "format=" + format, "--aov",
                            "variance,samples"});
    const ProgramResult same =
        test_box(folder, 1, {"-r", "16x12", "--effect", "20%", "-D", "format=" + format});
    INFO(same.out << same.err);
    CHECK_THAT(same.out, Catch::StartsWith("test: same"));
    const ProgramResult other = test_box(folder, 1, {"-r", "16x12", "--effect", "20%"});
    CHECK(other.exit_code == (format == "xyz" ? 0 : 2));
}

TEST_CASE("clrender test tells where, and takes a reference without layers as exact") {
    const TempFolder folder;
    make_reference(folder, {"-s", "4096", "-r", "16x12"});
    const ProgramResult result =
        test_box(folder, 1, {"-r", "16x12", "-D", "light=20", "--marked", "where.png"});
    INFO(result.out << result.err);
    CHECK(result.exit_code == 1);
    CHECK_THAT(result.err, Catch::Contains("taken as exact"));
    CHECK_THAT(result.out, Catch::StartsWith("test: differs, after 2048 samples a pixel") &&
                               Catch::Contains("mean of the picture: R is ") &&
                               Catch::Contains("worst pixel (") &&
                               Catch::Contains("where.png shows where"));
    CHECK(folder.has("where.png"));
}

TEST_CASE("clrender test refuses what it cannot compare") {
    const TempFolder folder;
    make_reference(folder, {"-s", "1", "-r", "16x12", "-o", "right.png"});
    const auto refuses = [&](const std::vector<std::string> &options, const std::string &reason) {
        const ProgramResult result = test_box(folder, 1, options);
        INFO(result.err);
        CHECK(result.exit_code == 2);
        CHECK(is_one_line(result.err));
        CHECK_THAT(result.err, Catch::Contains(reason));
    };
    refuses({"-r", "16x13"}, "size 16 x 12, expected the render's 16 x 13");
    refuses({"-s", "100"}, "at least 512 samples");
    refuses({"--effect", "0%"}, "is not a share such as 1%");
    refuses({"--check"}, "test excludes --check");
    refuses({"--reference", "right.png"}, "--reference");
    fs::copy(folder.path() / "right.png", folder.path() / "right.exr",
             fs::copy_options::overwrite_existing);
    refuses({"-r", "16x12"}, "8 bits a channel, expected an EXR file");
    folder.write("right.exr", std::string("PF\n1 1\n-1.0\n\0\0\0\0\0\0\xc0\x7f\0\0\0\0", 24));
    refuses({"-r", "1x1"}, "pixel (0, 0) is NaN or infinite");
}
