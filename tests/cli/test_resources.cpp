/// Memory that is told before it is taken, and what signals leave behind.

#include "program.h"

#include "image/image.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>

using namespace clrender::test;

namespace {

/// A floor below a bright sky: no pixel is black.
const char *const bright_scene = R"(<scene version="3.0.0">
    <integrator type="path"><integer name="max_depth" value="3"/></integrator>
    <sensor type="perspective">
        <transform name="to_world"><lookat origin="0,3,-3" target="0,1,0" up="0,1,0"/></transform>
        <film type="hdrfilm">
            <integer name="width" value="16"/><integer name="height" value="12"/>
        </film>
    </sensor>
    <shape type="rectangle">
        <transform name="to_world"><rotate x="1" angle="-90"/><scale value="5"/></transform>
    </shape>
    <emitter type="constant"><rgb name="radiance" value="1"/></emitter>
</scene>
)";

/// What -v prints when there is something to keep.
const char *const has_samples = "the first launch has ended";

/// Lets a long render run until it has its first samples, and a little more, and sends it a signal.
struct Stopped {
    ProgramResult result;
    double seconds = 0; ///< from the signal to the end
};

Stopped stop(const TempFolder &folder, int signal, std::vector<std::string> arguments) {
    arguments.emplace_back("-v");
    Program program(folder.path(), std::move(arguments));
    program.wait_for(has_samples);
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    const auto start = std::chrono::steady_clock::now();
    program.send(signal);
    Stopped stopped{program.wait(), 0};
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    stopped.seconds = taken.count();
    return stopped;
}

/// The number before `unit` in a text.
double number_before(const std::string &text, const std::string &unit) {
    const std::size_t end = text.find(unit);
    if (end == std::string::npos)
        return -1;
    return std::stod(text.substr(text.rfind(' ', end - 1)));
}

} // namespace

TEST_CASE("A signal in the first pass leaves a picture without holes, in bands or in one piece") {
    const TempFolder folder;
    folder.write("scene.xml", bright_scene);
    REQUIRE(run_clrender(folder.path(), {"scene.xml", "-o", "warm.pfm"}).exit_code == 0);
    for (const std::string rows : {"1000", "64"}) {
        INFO("bands of " << rows << " rows of tiles");
        const Stopped stopped = stop(folder, rows == "64" ? SIGTERM : SIGINT,
                                     {"scene.xml", "-o", "a.exr", "-o", "a.png", "-r", "2048x2048",
                                      "-s", "100000", "--band-rows", rows, "--stats", "s.json"});
        CHECK(stopped.result.exit_code == (rows == "64" ? 143 : 130));
        CHECK_THAT(stopped.result.err, Catch::Contains("nterrupted"));
        // Two seconds on a machine that does nothing else.
        CHECK(stopped.seconds < 10);
        const clrender::Image picture = clrender::read_image((folder.path() / "a.exr").string());
        const auto dark = std::count_if(picture.f32.begin(), picture.f32.end(),
                                        [](float value) { return !(value > 0); });
        CHECK(dark == 0);
        CHECK(clrender::read_image((folder.path() / "a.png").string()).width == 2048);
        const auto stats = nlohmann::json::parse(read_file(folder.path() / "s.json"));
        CHECK(stats.at("interrupted") == true);
        CHECK(stats.contains("pixels_without_samples"));
    }
}

TEST_CASE("A signal before the first samples ends the run at once, and says so") {
    const TempFolder folder;
    folder.write("scene.xml", bright_scene);
    // The kernel is compiled for more than a second, as the cache is empty.
    const std::string cache = (folder.path() / "cache").string();
    fs::create_directory(cache);
    Program program(folder.path(), {"scene.xml", "-v", "-o", "a.pfm"},
                    {{"XDG_CACHE_HOME", cache}, {"POCL_CACHE_DIR", cache}});
    program.wait_for("kernel: compiling");
    program.send(SIGTERM);
    const ProgramResult result = program.wait();
    CHECK(result.exit_code == 143);
    CHECK_THAT(result.err, Catch::Contains("before the first samples"));
    CHECK_FALSE(folder.has("a.pfm"));
}

TEST_CASE("The second signal ends the run at once") {
    const TempFolder folder;
    folder.write("scene.xml", bright_scene);
    REQUIRE(run_clrender(folder.path(), {"scene.xml", "-o", "warm.pfm"}).exit_code == 0);
    Program program(folder.path(), {"scene.xml", "-o", "a.pfm", "-r", "2048x2048", "-s", "100000"});
    std::this_thread::sleep_for(std::chrono::seconds(3));
    program.send(SIGINT);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    program.send(SIGTERM);
    const ProgramResult result = program.wait();
    CHECK(result.exit_code == 143);
    CHECK_THAT(result.err, Catch::Contains("interrupted again"));
    CHECK_FALSE(folder.has("a.pfm"));
}

TEST_CASE("A check tells the memory of the process and of the device within a tenth") {
    const TempFolder folder;
    folder.write("scene.xml", bright_scene);
    const std::string size = "3200x2400";
    const ProgramResult check = run_clrender(folder.path(), {"--check", "scene.xml", "-r", size});
    REQUIRE(check.exit_code == 0);
    // The compilation of the kernel counts, so that the cache has to be empty.
    const ProgramResult render = run_clrender(
        folder.path(), {"scene.xml", "-r", size, "-s", "1", "-o", "a.pfm", "--stats", "s.json"},
        {{"XDG_CACHE_HOME", folder.path().string()}});
    REQUIRE(render.exit_code == 0);
    const auto stats = nlohmann::json::parse(read_file(folder.path() / "s.json"));
    INFO(check.err << "peak " << render.peak_kib / 1024 << " MiB");
    CHECK(number_before(check.err, " MiB in all") ==
          Approx(static_cast<double>(render.peak_kib) / 1024).epsilon(0.1));
    CHECK(number_before(check.err, " MiB on the device") ==
          Approx(stats["memory"]["device_bytes"].get<double>() / (1 << 20)).epsilon(0.01));
}

TEST_CASE("A render that needs more than --max-memory is refused with the byte counts") {
    const TempFolder folder;
    folder.write("scene.xml", bright_scene);
    const ProgramResult result =
        run_clrender(folder.path(), {"scene.xml", "-r", "16384x16384", "-s", "1", "-o", "a.pfm",
                                     "--max-memory", "1G"});
    CHECK(result.exit_code == 2);
    CHECK(is_one_line(result.err));
    CHECK_THAT(result.err, Catch::Contains("1073741824"));
    CHECK(result.peak_kib < 1024 * 1024);
    CHECK_FALSE(folder.has("a.pfm"));
}
