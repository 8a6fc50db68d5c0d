/// Files as they are written for other versions of Mitsuba, NAME.old.xml, against NAME.new.xml,
/// the same upgraded by hand: both have to flatten to the same arrays.

#include "flatten/flat_scene.h"
#include "mitsuba_text_scene.h"
#include "stderr_of.h"

#include <catch2/catch.hpp>
#include <cstring>
#include <filesystem>

using namespace clrender;

namespace {

template <typename T> bool same_bytes(const std::vector<T> &a, const std::vector<T> &b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

Scene load_quietly(const std::string &path) {
    Scene scene;
    (void)test::stderr_of([&] { scene = test::load(path); });
    return scene;
}

} // namespace

TEST_CASE("old files are those that are upgraded by hand", "[dialect]") {
    int files = 0;
    for (const auto &entry :
         std::filesystem::directory_iterator(CLRENDER_TEST_DIR "/host/data/dialects")) {
        std::string path = entry.path().string();
        const std::size_t ending = path.find(".old.xml");
        if (ending == std::string::npos)
            continue;
        ++files;
        CAPTURE(path);
        const Scene old_scene = load_quietly(path);
        const Scene new_scene = load_quietly(path.replace(ending, 4, ".new"));
        CHECK(old_scene.sample_count == new_scene.sample_count);
        CHECK(old_scene.film.pixel_format == new_scene.film.pixel_format);
        const FlatScene a = flatten(old_scene, {});
        const FlatScene b = flatten(new_scene, {});
        CHECK(std::memcmp(&a.frame, &b.frame, sizeof(a.frame)) == 0);
        CHECK(a.border == b.border);
#define CLR_SAME_ARRAY(type, name, meaning)                                                        \
    {                                                                                              \
        INFO(#name);                                                                               \
        CHECK(same_bytes(a.name, b.name));                                                         \
    }
        CLR_SCENE_BUFFERS(CLR_SAME_ARRAY)
#undef CLR_SAME_ARRAY
        CHECK(same_bytes(a.corners, b.corners));
    }
    CHECK(files == 5);
}
