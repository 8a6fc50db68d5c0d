/// Checkpoints and parts: the same bits as a render in one go, and what is refused.

#include "image/image.h"
#include "image/layers.h"
#include "program.h"
#include "small_scene.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <fstream>
#include <random>

using namespace clrender;
using namespace clrender::test;

namespace {

/// Samples that neighbouring tiles share, three blocks and more.
std::string scene_with(const std::string &power) {
    return scene_of({.width = 20, .height = 18, .samples = 64, .power = power, .defaults = ""});
}

const std::vector<std::string> quiet = {"-q", "--lanes", "4"};

class Runs {
public:
    Runs() { folder_.write("scene.xml", scene_with("10")); }

    [[nodiscard]] const TempFolder &folder() const { return folder_; }

    /// With four lanes, which `merge` takes from its files.
    ProgramResult run(std::vector<std::string> arguments,
                      const std::function<void()> &prepare = {}) const {
        const bool is_merge = arguments.front() == "merge";
        arguments.insert(arguments.end(), quiet.begin(),
                         is_merge ? quiet.begin() + 1 : quiet.end());
        return Program(folder_.path(), arguments, {}, prepare).wait();
    }
    /// A run that has to succeed.
    void must(const std::vector<std::string> &arguments) const {
        const ProgramResult result = run(arguments);
        INFO(result.err);
        REQUIRE(result.exit_code == 0);
    }
    [[nodiscard]] std::vector<float> pixels(const std::string &name) const {
        return read_image((folder_.path() / name).string()).f32;
    }
    /// Runs without a break, and returns its pixels.
    [[nodiscard]] std::vector<float> in_one_go(const std::string &samples) const {
        must({"scene.xml", "-s", samples, "-o", "one.exr"});
        return pixels("one.exr");
    }

private:
    TempFolder folder_;
};

} // namespace

TEST_CASE("A render that is extended has the bits of one in one go") {
    const Runs runs;
    for (const auto &[first, then] :
         std::vector<std::pair<std::string, std::string>>{{"16", "64"}, {"40", "100"}}) {
        runs.must({"scene.xml", "-s", first, "-o", "a.exr", "--checkpoint", "c.exr"});
        CHECK(runs.pixels("c.exr") == runs.pixels("a.exr"));
        CHECK(runs.pixels("c.exr") == runs.in_one_go(first));
        runs.must({"resume", "c.exr", "-s", then});
        const auto expected = runs.in_one_go(then);
        CHECK(runs.pixels("a.exr") == expected);
        CHECK(runs.pixels("c.exr") == expected);
        fs::remove(runs.folder().path() / "c.exr");
    }
}

TEST_CASE("The variance goes on with the picture") {
    const Runs runs;
    const std::vector<std::string> layer = {"--aov", "variance"};
    runs.must(
        {"scene.xml", "-s", "128", "--aov", "variance", "-o", "one.exr", "--stats", "one.json"});
    runs.must(
        {"scene.xml", "-s", "32", "--aov", "variance", "-o", "a.exr", "--checkpoint", "c.exr"});
    runs.must({"resume", "c.exr", "-s", "128", "--stats", "a.json"});
    CHECK(runs.pixels("a.exr") == runs.pixels("one.exr"));
    const auto error = [&](const char *name) {
        const std::string text = read_file(runs.folder().path() / name);
        return text.substr(text.find("\"error\""), 150);
    };
    CHECK(error("a.json") == error("one.json"));
}

TEST_CASE("Layers are written whatever ends a render, and go on with it") {
    const Runs runs;
    const auto normal = [&](const char *name) {
        const auto layer = read_exr_layer((runs.folder().path() / name).string(), "normal");
        return layer ? layer->f32 : std::vector<float>();
    };
    runs.must({"scene.xml", "-s", "64", "--aov", "normal", "-o", "one.exr"});
    REQUIRE(!normal("one.exr").empty());
    runs.must({"scene.xml", "-s", "16", "--aov", "normal", "-o", "a.exr", "--checkpoint", "c.exr"});
    CHECK(!normal("a.exr").empty());
    runs.must({"resume", "c.exr", "-s", "64"});
    CHECK(normal("a.exr") == normal("one.exr"));
    runs.must({"scene.xml", "--time", "1s", "--aov", "normal", "-o", "t.exr"});
    CHECK(!normal("t.exr").empty());

    const ProgramResult without =
        runs.run({"scene.xml", "-s", "1", "--aov", "normal", "-o", "a.png"});
    CHECK(without.exit_code == 0);
    CHECK_THAT(without.err, Catch::Contains("the layers of --aov are left out"));
}

TEST_CASE("Pictures inside of aov share the time") {
    const Runs runs;
    std::string scene = scene_with("10");
    const std::string path = R"(<integrator type="path">)";
    scene.replace(scene.find(path), path.size(),
                  R"(<integrator type="aov"><string name="aovs" value=""/>
                     <integrator type="direct" name="b"/><integrator type="path" name="a">)");
    const std::string end = "</integrator>";
    scene.insert(scene.find(end), end);
    runs.folder().write("two.xml", scene);
    runs.must({"two.xml", "--time", "2s", "-o", "t.exr", "--stats", "t.json"});
    const std::string stats = read_file(runs.folder().path() / "t.json");
    // A picture that took all the time would leave the next one a single sample.
    const std::string spp = "\"spp\": ";
    CHECK(std::stoi(stats.substr(stats.find(spp) + spp.size())) > 16);
}

TEST_CASE("A render that is killed at any time goes on to the same bits") {
    const Runs runs;
    const std::string samples = "4096";
    const auto expected = runs.in_one_go(samples);
    std::mt19937 random(7);
    const auto kill_within = [&](std::vector<std::string> arguments, unsigned most_ms) {
        arguments.insert(arguments.end(), quiet.begin(), quiet.end());
        arguments.insert(arguments.end(), {"--checkpoint-interval", "0.01", "--tile", "2"});
        Program program(runs.folder().path(), arguments);
        for (int i = 0; i < 6000 && !runs.folder().has("c.exr"); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        std::this_thread::sleep_for(std::chrono::milliseconds(random() % most_ms));
        program.send(SIGKILL);
        (void)program.wait();
    };
    for (int i = 0; i < 3; ++i) {
        kill_within({"scene.xml", "-s", samples, "-o", "a.exr", "--checkpoint", "c.exr"}, 100);
        REQUIRE(runs.folder().has("c.exr"));
        kill_within({"resume", "c.exr"}, 400);
        runs.must({"resume", "c.exr"});
        CHECK(runs.pixels("a.exr") == expected);
        fs::remove(runs.folder().path() / "c.exr");
    }
}

TEST_CASE("A signal leaves a checkpoint from which the render goes on") {
    const Runs runs;
    std::vector<std::string> arguments = {"scene.xml",    "-s",    "1048576", "-o", "a.exr", "-v",
                                          "--checkpoint", "c.exr", "--lanes", "4"};
    Program program(runs.folder().path(), arguments);
    program.wait_for("the first launch has ended");
    program.send(SIGINT);
    CHECK(program.wait().exit_code == 130);
    REQUIRE(runs.folder().has("c.exr"));
    const ProgramResult less = runs.run({"resume", "c.exr", "-s", "1"});
    CHECK(less.exit_code == 2);
    CHECK_THAT(less.err, Catch::Contains("samples already"));
}

TEST_CASE("Parts add up to the bits of a single render, in any order") {
    const Runs runs;
    const auto expected = runs.in_one_go("128");
    // Four blocks: dealt whole to two and three parts, and by tiles to seven.
    for (const int parts : {2, 3, 7}) {
        std::vector<std::string> files;
        for (int part = 1; part <= parts; ++part) {
            const std::string share = std::to_string(part) + "/" + std::to_string(parts);
            runs.must({"scene.xml", "-s", "128", "--part", share});
            files.push_back("scene.part" + std::to_string(part) + "of" + std::to_string(parts) +
                            ".exr");
        }
        std::reverse(files.begin(), files.end());
        std::swap(files.front(), files[files.size() / 2]);
        std::vector<std::string> merge = {"merge"};
        merge.insert(merge.end(), files.begin(), files.end());
        merge.insert(merge.end(), {"-o", "m.exr"});
        runs.must(merge);
        CHECK(runs.pixels("m.exr") == expected);
    }
    runs.must({"resume", "m.exr", "-s", "192", "-o", "more.exr"});
    CHECK(runs.pixels("more.exr") == runs.in_one_go("192"));

    // Shares of tiles become shares of blocks.
    const ProgramResult longer = runs.run({"resume", "scene.part2of7.exr", "-s", "1024"});
    CHECK(longer.exit_code == 2);
    CHECK_THAT(longer.err, Catch::Contains("of 1024 samples"));
    const ProgramResult twice = runs.run(
        {"merge", "scene.part1of2.exr", "scene.part2of2.exr", "scene.part1of2.exr", "-o", "x.exr"});
    CHECK(twice.exit_code == 2);
    CHECK_THAT(twice.err, Catch::Contains("part 1 of 2"));
    const ProgramResult mixed =
        runs.run({"merge", "scene.part1of2.exr", "scene.part2of3.exr", "-o", "x.exr"});
    CHECK(mixed.exit_code == 2);
    const ProgramResult ignored =
        runs.run({"merge", "scene.part1of2.exr", "--seed", "5", "-o", "x.exr"});
    CHECK(ignored.exit_code == 2);
    CHECK_THAT(ignored.err, Catch::Contains("merge takes no --seed"));
    const ProgramResult missing =
        runs.run({"merge", "scene.part1of3.exr", "scene.part3of3.exr", "-o", "x.exr"});
    CHECK(missing.exit_code == 0);
    CHECK_THAT(missing.err, Catch::Contains("these are missing: 2"));
    runs.folder().write("scene.xml", scene_with("11"));
    runs.must({"scene.xml", "-s", "128", "--part", "2/2"});
    const ProgramResult other =
        runs.run({"merge", "scene.part1of2.exr", "scene.part2of2.exr", "-o", "y.exr"});
    CHECK(other.exit_code == 2);
    CHECK_THAT(other.err, Catch::Contains("another scene"));
    CHECK_FALSE(runs.folder().has("y.exr"));
}

TEST_CASE("A checkpoint of something else is refused by name") {
    const Runs runs;
    runs.must({"scene.xml", "-s", "16", "-o", "a.exr", "--checkpoint", "c.exr"});
    const auto refused = [&](std::vector<std::string> arguments, const std::string &word) {
        const ProgramResult result = runs.run(std::move(arguments));
        CHECK(result.exit_code == 2);
        CHECK(is_one_line(result.err));
        CHECK_THAT(result.err, Catch::Contains(word));
    };
    refused({"scene.xml", "--checkpoint", "c.exr"}, "is there already");
    refused({"resume", "c.exr", "--seed", "5"}, "--seed");
    refused({"resume", "c.exr", "-r", "9x9"}, "--resolution");
    refused({"resume", "c.exr", "--max-depth", "2"}, "--max-depth");
    refused({"resume", "c.exr", "--target-error", "1%"}, "variances");
    refused({"resume", "c.exr", "--rr-depth", "auto"}, "--rr-depth");
    refused({"resume", "c.exr", "--specular-connections", "off"}, "--specular-connections");
    refused({"resume", "c.exr", "-o", "./c.exr"}, "written twice");
    refused({"scene.xml", "-o", "d.exr", "--checkpoint", "d.exr"}, "written twice");
    refused({"resume", "one.exr"}, "one.exr");
    refused({"resume", "a.exr"}, "no checkpoint");
    refused({"scene.xml", "-s", "20", "--part", "1/2"}, "cannot be dealt");
    runs.folder().write("scene.xml", scene_with("11"));
    refused({"resume", "c.exr", "-s", "32"}, "another scene");
}

TEST_CASE("A resumed render knows all options and the end of the first one") {
    const Runs runs;
    const std::vector<std::string> options = {"--rr-depth", "auto",  "--specular-connections",
                                              "off",        "--aov", "samples"};
    const auto with_options = [&](std::vector<std::string> arguments) {
        arguments.insert(arguments.end(), options.begin(), options.end());
        return arguments;
    };
    runs.must(with_options({"scene.xml", "-s", "16", "-o", "a.exr", "--checkpoint", "c.exr"}));
    runs.must(with_options({"resume", "c.exr", "-s", "16"}));
    const std::string layers = read_file(runs.folder().path() / "a.exr");
    const bool has_layer = layers.find("samples.Y") != std::string::npos;
    CHECK(has_layer);
    runs.must({"resume", "c.exr"});
    const bool is_same = read_file(runs.folder().path() / "a.exr") == layers;
    CHECK(is_same);

    const auto resumed = [&](const char *rule, const char *value) {
        fs::remove(runs.folder().path() / "c.exr");
        runs.must({"scene.xml", rule, value, "-o", "a.exr", "--checkpoint", "c.exr"});
        return Program(runs.folder().path(), {"resume", "c.exr"}).wait();
    };
    const ProgramResult by_error = resumed("--target-error", "30%");
    CHECK(by_error.exit_code == 0);
    CHECK_THAT(by_error.err, Catch::Contains("target reached"));
    const ProgramResult by_time = resumed("--time", "0.3");
    CHECK(by_time.exit_code == 2);
    CHECK_THAT(by_time.err, Catch::Contains("--time, -s or --target-error"));
}

TEST_CASE("Files that have changed places are another scene, in another folder the same") {
    const Runs runs;
    const std::string part = R"(<scene version="3.0.0"><default name="NAME" value="1"/></scene>)";
    const auto write_part = [&](const std::string &file, const std::string &name) {
        std::string text = part;
        runs.folder().write(file, text.replace(text.find("NAME"), 4, name));
    };
    std::string scene = scene_with("10");
    scene.insert(scene.rfind("</scene>"),
                 R"(<include filename="a.xml"/><include filename="b.xml"/>)");
    runs.folder().write("scene.xml", scene);
    write_part("a.xml", "first");
    write_part("b.xml", "second");
    runs.must({"scene.xml", "-s", "64", "--part", "1/2"});
    fs::create_directory(runs.folder().path() / "other");
    for (const char *file : {"scene.xml", "a.xml", "b.xml"})
        fs::copy(runs.folder().path() / file, runs.folder().path() / "other" / file);
    runs.must({"other/scene.xml", "-s", "64", "--part", "2/2"});
    runs.must({"merge", "scene.part1of2.exr", "scene.part2of2.exr", "-o", "m.pfm"});
    write_part("b.xml", "first");
    write_part("a.xml", "second");
    const ProgramResult swapped = runs.run({"resume", "scene.part1of2.exr"});
    CHECK(swapped.exit_code == 2);
    CHECK_THAT(swapped.err, Catch::Contains("another scene"));
}

TEST_CASE("A checkpoint of another kernel is refused") {
    const Runs runs;
    const fs::path kernels = runs.folder().path() / "kernels";
    fs::copy(fs::path(CLRENDER_SCENE_DIR).parent_path() / "kernels", kernels,
             fs::copy_options::recursive);
    runs.must({"scene.xml", "-s", "16", "-o", "a.exr", "--checkpoint", "c.exr"});
    std::ofstream(kernels / "lanes.clh", std::ios::app) << "// changed\n";
    const ProgramResult other = runs.run({"resume", "c.exr", "--kernel-dir", "kernels"});
    CHECK(other.exit_code == 2);
    CHECK_THAT(other.err, Catch::Contains("another kernel"));
}

TEST_CASE("A checkpoint is of the picture, not of those of further integrators") {
    const Runs runs;
    std::string scene = scene_with("10");
    const std::string path =
        R"(<integrator type="path" name="NAME"><integer name="max_depth" value="4"/></integrator>)";
    const auto begin = scene.find("<integrator"), end = scene.find("<sensor");
    std::string inner = path, second = path;
    inner.replace(inner.find("NAME"), 4, "a");
    second.replace(second.find("NAME"), 4, "b");
    second.replace(second.find("\"4\""), 3, "\"2\"");
    scene.replace(begin, end - begin,
                  R"(<integrator type="aov"><string name="aovs" value="d:depth"/>)" + inner +
                      second + "</integrator>");
    runs.folder().write("scene.xml", scene);
    runs.must({"scene.xml", "-s", "16", "-o", "a.exr", "--checkpoint", "c.exr"});
    runs.must({"resume", "c.exr", "-s", "64"});
    const std::string resumed = read_file(runs.folder().path() / "a.exr");
    runs.must({"scene.xml", "-s", "64", "-o", "a.exr"});
    const bool is_same = read_file(runs.folder().path() / "a.exr") == resumed;
    CHECK(is_same);
    // An error that is asked for ends all of them.
    runs.must({"scene.xml", "--target-error", "50%", "-o", "a.exr"});
    const std::string exact = read_file(runs.folder().path() / "a.exr");
    const bool has_depth = exact.find("d.T") != std::string::npos;
    CHECK(has_depth);
}

TEST_CASE("A damaged checkpoint is refused") {
    const Runs runs;
    runs.must({"scene.xml", "-s", "16", "-o", "a.exr", "--checkpoint", "c.exr"});
    const std::string whole = read_file(runs.folder().path() / "c.exr");
    std::mt19937 random(3);
    for (int i = 0; i < 12; ++i) {
        std::string damaged = whole;
        if (i % 2 == 0)
            damaged.resize(whole.size() * static_cast<std::size_t>(i + 1) / 13);
        else
            for (std::size_t k = 0; k < 8; ++k)
                damaged[whole.size() / 2 + random() % (whole.size() / 2)] ^= '\x55';
        runs.folder().write("d.exr", damaged);
        const ProgramResult result = runs.run({"merge", "d.exr", "-o", "x.exr"});
        INFO(i << ": " << result.err);
        CHECK(result.exit_code == 2);
        CHECK(is_one_line(result.err));
        CHECK_FALSE(runs.folder().has("x.exr"));
    }
}

TEST_CASE("A full disk keeps the checkpoint before, and the render goes on") {
    const Runs runs;
    runs.must({"scene.xml", "-r", "320x240", "-s", "16", "-o", "a.pfm", "--checkpoint", "c.exr"});
    const std::string before = read_file(runs.folder().path() / "c.exr");
    const ProgramResult result = runs.run({"resume", "c.exr", "-s", "64", "-o", "small.jpg"}, [] {
        const rlimit limit = {2 << 20, 2 << 20};
        setrlimit(RLIMIT_FSIZE, &limit);
    });
    INFO(result.err);
    CHECK(result.exit_code == 4);
    CHECK_THAT(result.err, Catch::Contains("the checkpoint before it stays"));
    CHECK(read_file(runs.folder().path() / "c.exr") == before);
    CHECK(runs.folder().has("small.jpg"));
    CHECK(before.size() > 2 << 20);
    runs.must({"resume", "c.exr", "-s", "64", "-o", "a.pfm"});
    runs.must({"scene.xml", "-r", "320x240", "-s", "64", "-o", "one.pfm"});
    CHECK(runs.pixels("a.pfm") == runs.pixels("one.pfm"));
}

TEST_CASE("A render by time writes its picture and says why it ended") {
    const Runs runs;
    std::vector<std::string> arguments = {"scene.xml", "--time",  "1s", "-o",
                                          "a.exr",     "--lanes", "4"};
    const ProgramResult result = Program(runs.folder().path(), arguments).wait();
    CHECK(result.exit_code == 0);
    CHECK_THAT(result.err, Catch::Contains("the time is up after"));
    CHECK(runs.folder().has("a.exr"));
    const ProgramResult exact =
        Program(runs.folder().path(), {"scene.xml", "--target-error", "20%", "-o", "a.exr",
                                       "--stats", "s.json", "--lanes", "4"})
            .wait();
    CHECK(exact.exit_code == 0);
    CHECK_THAT(exact.err, Catch::Contains("target reached after"));
    CHECK_THAT(read_file(runs.folder().path() / "s.json"),
               Catch::Contains("\"ended_by\": \"error\""));
}
