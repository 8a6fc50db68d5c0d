/// `clrender --self-test`, through the program.

#include "program.h"

#include <catch2/catch.hpp>

using namespace clrender::test;

TEST_CASE("The self-test passes on this device and prints a table") {
    const TempFolder folder;
    const ProgramResult result = run_clrender(folder.path(), {"--self-test"});
    INFO(result.out << result.err);
    REQUIRE(result.exit_code == 0);
    CHECK_THAT(result.out, Catch::Contains("check  sphere_intersect ") &&
                               Catch::Contains("check  reference scene ") &&
                               Catch::Contains("\nself-test: pass: "));
}

TEST_CASE(
    "The self-test names the function of a wrong kernel, and exit code 3 says that it failed") {
    const TempFolder folder;
    const fs::path kernels = folder.path() / "kernels";
    fs::copy(fs::path(CLRENDER_TEST_DIR) / ".." / "kernels", kernels, fs::copy_options::recursive);
    std::string text = read_file(kernels / "sphere.clh");
    const std::string right = "real near = along - root;";
    const std::size_t at = text.find(right);
    REQUIRE(at != std::string::npos);
    text.replace(at, right.size(), "real near = along - 0.999f * root;");
    folder.write("kernels/sphere.clh", text);

    const ProgramResult result =
        run_clrender(folder.path(), {"--self-test", "--kernel-dir", "kernels"});
    INFO(result.out << result.err);
    CHECK(result.exit_code == 3);
    CHECK_THAT(result.out, Catch::Contains("self-test: sphere_intersect is wrong: ") &&
                               Catch::Contains("\nself-test: FAIL: "));
    CHECK_THAT(result.out, !Catch::Contains("planar_intersect is wrong"));
}

TEST_CASE("The self-test takes no scene") {
    const TempFolder folder;
    const ProgramResult result = run_clrender(folder.path(), {"--self-test", "scene.xml"});
    CHECK(result.exit_code == 2);
    CHECK_THAT(result.err, Catch::Contains("--self-test takes no SCENE"));
}
