/// Every scene of tests/references against the picture that Mitsuba 3 made of it. One test case a
/// scene, registered from the folder's contents, so that each is a test of its own in CTest.

#include "render_adapter.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <filesystem>
#include <set>

using namespace clrender;
using namespace clrender::test;

namespace {

constexpr double samples = 2e6;

class ReferenceTest : public Catch::ITestInvoker {
public:
    explicit ReferenceTest(std::filesystem::path scene) : path_(std::move(scene)) {}

    void invoke() const override {
        const Scene scene = load_scene(path_.string());
        const double pixels = static_cast<double>(scene.film.crop_width) * scene.film.crop_height;
        const auto picture =
            render_measured(scene, {.spp = static_cast<int>(std::ceil(samples / pixels))});

        auto image = path_;
        const auto verdict = compare_or_save(path_.stem().string(), picture,
                                             read_reference(image.replace_extension("exr")));
        INFO(verdict.summary);
        CHECK(verdict.passes);
    }

private:
    std::filesystem::path path_;
};

bool register_all() {
    std::set<std::filesystem::path> scenes;
    const auto folder = std::filesystem::path(CLRENDER_TEST_DIR) / "references";
    for (const auto &entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ".xml")
            scenes.insert(entry.path());
    for (const auto &scene : scenes)
        Catch::AutoReg(new ReferenceTest(scene), CATCH_INTERNAL_LINEINFO, Catch::StringRef(),
                       Catch::NameAndTags("reference " + scene.stem().string(), "[reference]"));
    return !scenes.empty();
}

const bool registered = register_all();

} // namespace

TEST_CASE("there are reference scenes") {
    CHECK(registered);
}
