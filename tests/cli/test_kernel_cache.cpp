/// The cache of compiled kernels, through the program: found again, damaged, and where it cannot be
/// written.

#include "program.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace clrender::test;

namespace {

const char *const ball_scene = R"(<scene version="3.0.0">
    <sensor type="perspective">
        <transform name="to_world"><lookat origin="0,0,-4" target="0,0,0" up="0,1,0"/></transform>
        <film type="hdrfilm">
            <integer name="width" value="8"/><integer name="height" value="8"/>
        </film>
    </sensor>
    <shape type="sphere"/>
    <emitter type="constant"/>
</scene>
)";

/// A folder with the scene, and caches that nobody else uses.
struct Caches {
    TempFolder folder;
    std::vector<std::pair<std::string, std::string>> environment;

    Caches() {
        folder.write("scene.xml", ball_scene);
        set(folder.path() / "cache", "");
    }

    void set(const fs::path &cache, const std::string &pocl) {
        environment = {{"XDG_CACHE_HOME", cache.string()}, {"POCL_CACHE_DIR", pocl}};
    }

    /// Renders; true if the statistics say that the kernel was in the cache.
    bool render_hits() const {
        const ProgramResult result = run_clrender(
            folder.path(), {"scene.xml", "-v", "-s", "1", "-o", "a.pfm", "--stats", "s.json"},
            environment);
        INFO(result.err);
        REQUIRE(result.exit_code == 0);
        const auto stats = nlohmann::json::parse(read_file(folder.path() / "s.json"));
        const bool hit = stats["kernel"]["cache"] == "hit";
        CHECK_THAT(result.err,
                   Catch::Contains(hit ? "kernel: from the cache" : "kernel: compiling, "));
        return hit;
    }

    /// Cuts every file below the cache that is longer than this short.
    void truncate(const fs::path &below, std::uintmax_t bytes) const {
        for (const auto &file : fs::recursive_directory_iterator(folder.path() / "cache" / below))
            if (file.is_regular_file() && file.file_size() > bytes)
                fs::resize_file(file.path(), bytes);
    }
};

} // namespace

TEST_CASE("A kernel is compiled once") {
    const Caches caches;
    CHECK_FALSE(caches.render_hits());
    const std::string picture = read_file(caches.folder.path() / "a.pfm");
    CHECK(caches.render_hits());
    CHECK(read_file(caches.folder.path() / "a.pfm") == picture);
}

TEST_CASE("A cache that is damaged or half removed is filled anew") {
    const Caches caches;
    const auto [below, bytes] = GENERATE(table<std::string, std::uintmax_t>(
        {{"clrender/kernels", 60}, {"clrender/pocl", 0}, {"clrender/pocl", 5000}}));
    INFO(below << " cut down to " << bytes);
    CHECK_FALSE(caches.render_hits());
    if (below == "clrender/pocl" && !caches.folder.has("cache/" + below)) {
        WARN("skipped: this device's kernels are not kept by PoCL");
        return;
    }
    REQUIRE(caches.folder.has("cache/" + below));
    const std::string picture = read_file(caches.folder.path() / "a.pfm");
    caches.truncate(below, bytes);
    caches.render_hits();
    CHECK(read_file(caches.folder.path() / "a.pfm") == picture);
    CHECK(caches.render_hits());

    fs::remove_all(caches.folder.path() / "cache" / below);
    caches.render_hits();
    CHECK(caches.render_hits());
}

TEST_CASE("What an unfinished run has left in PoCL's cache is removed") {
    const Caches caches;
    CHECK_FALSE(caches.render_hits());
    const fs::path below = caches.folder.path() / "cache" / "clrender";
    if (!fs::exists(below / "pocl")) {
        WARN("skipped: this device's kernels are not kept by PoCL");
        return;
    }
    const std::string picture = read_file(caches.folder.path() / "a.pfm");
    fs::remove_all(below / "kernels");
    caches.truncate("clrender/pocl", GENERATE(0, 5000));
    for (const auto &entry : fs::recursive_directory_iterator(below / "pocl"))
        fs::last_write_time(entry, fs::file_time_type::clock::now() - std::chrono::hours(2));
    CHECK_FALSE(caches.render_hits());
    CHECK(read_file(caches.folder.path() / "a.pfm") == picture);
    CHECK(caches.render_hits());
}

TEST_CASE("Folders that cannot be written fail no render") {
    Caches caches;
    caches.folder.write("file", "");
    const fs::path impossible = caches.folder.path() / "file" / "cache";
    caches.set(impossible, GENERATE("", "file/pocl"));
    CHECK_FALSE(caches.render_hits());
    CHECK_FALSE(caches.render_hits());
    caches.set("", "");
    caches.environment.emplace_back("HOME", impossible.string());
    CHECK_FALSE(caches.render_hits());
}

TEST_CASE("PoCL's cache stays where the user has put it") {
    Caches caches;
    caches.set(caches.folder.path() / "cache", (caches.folder.path() / "pocl").string());
    CHECK_FALSE(caches.render_hits());
    CHECK(caches.render_hits());
    CHECK_FALSE(caches.folder.has("cache/clrender/pocl"));
}
