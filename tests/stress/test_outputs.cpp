/// Outputs that cannot be written: found out before the render where that is possible; after it,
/// all others are written, and the exit code and a line each tell which are not.

// The sanitizers take what OpenCL runtimes leak for failures of the program.
#ifndef CLRENDER_SANITIZE

#include "program.h"
#include "small_scene.h"

#include <catch2/catch.hpp>
#include <sys/stat.h>

using namespace clrender::test;

namespace {

/// Files of this process may not grow beyond `bytes`, as on a disk that fills.
std::function<void()> file_limit(rlim_t bytes) {
    return [bytes] {
        const rlimit limit{bytes, bytes};
        setrlimit(RLIMIT_FSIZE, &limit);
    };
}

/// A process of root takes another user's place: root may write everywhere.
void become_ordinary() {
    constexpr uid_t nobody = 65534;
    if (getuid() == 0 && (setgid(nobody) != 0 || setuid(nobody) != 0))
        _exit(126);
}

/// The names in a folder, but what the program printed.
std::vector<std::string> names_in(const fs::path &folder) {
    std::vector<std::string> names;
    for (const auto &entry : fs::directory_iterator(folder))
        names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

/// A render of 512 x 384 pixels that is stopped in its middle, after `meanwhile`.
ProgramResult stopped_render(const TempFolder &folder, std::vector<std::string> arguments,
                             const std::function<void()> &meanwhile) {
    arguments.insert(arguments.begin(), {"scene.xml", "-r", "512x384", "-s", "1000000000"});
    Program program(folder.path(), arguments, {{"TMPDIR", folder.path().string()}});
    std::this_thread::sleep_for(std::chrono::seconds(3));
    meanwhile();
    program.send(SIGINT);
    return program.wait();
}

} // namespace

TEST_CASE("A disk that fills costs only the files that do not fit") {
    const TempFolder folder;
    folder.write("scene.xml", lit_floor);
    REQUIRE(run_clrender(folder.path(), {"scene.xml", "-o", "warm.pfm"}).exit_code == 0);
    folder.write("large.pfm", "old");
    const ProgramResult result =
        run_clrender(folder.path(),
                     {"scene.xml", "-q", "-r", "640x480", "-s", "1", "-o", "large.pfm", "-o",
                      "small.jpg", "--stats", "stats.json", "--profile", "trace.json"},
                     {}, file_limit(2 << 20));
    INFO(result.err);
    CHECK(result.exit_code == 4);
    CHECK(is_one_line(result.err));
    CHECK_THAT(result.err, Catch::Contains("large.pfm: cannot be written (File too large)"));
    CHECK(read_file(folder.path() / "large.pfm") == "old");
    CHECK(names_in(folder.path()) == std::vector<std::string>{"large.pfm", "scene.xml", "small.jpg",
                                                              "stats.json", "trace.json",
                                                              "warm.pfm"});
}

TEST_CASE("A picture that fits nowhere is reported, and leaves nothing behind") {
    const TempFolder folder;
    folder.write("scene.xml", lit_floor);
    REQUIRE(run_clrender(folder.path(), {"scene.xml", "-o", "warm.pfm"}).exit_code == 0);
    const ProgramResult result =
        run_clrender(folder.path(), {"scene.xml", "-q", "-r", "1280x960", "-s", "1", "-o", "a.pfm"},
                     {{"TMPDIR", folder.path().string()}}, file_limit(2 << 20));
    INFO(result.err);
    CHECK(result.exit_code == 4);
    CHECK(is_one_line(result.err));
    CHECK_THAT(result.err, Catch::Contains("a.pfm: cannot be written"));
    CHECK(names_in(folder.path()) == std::vector<std::string>{"scene.xml", "warm.pfm"});
}

TEST_CASE("A folder that vanishes during the render costs only what was to be in it") {
    const TempFolder folder;
    folder.write("scene.xml", lit_floor);
    fs::create_directory(folder.path() / "gone");
    const ProgramResult result = stopped_render(folder, {"-o", "gone/a.exr", "-o", "here.png"},
                                                [&] { fs::remove_all(folder.path() / "gone"); });
    INFO(result.err);
    CHECK(result.exit_code == 4);
    CHECK_THAT(result.err, Catch::Contains("gone/a.exr: cannot be written (No such file"));
    CHECK_THAT(result.err, Catch::Contains("so far is in here.png:"));
    CHECK(names_in(folder.path()) == std::vector<std::string>{"here.png", "scene.xml"});
}

TEST_CASE("Where no picture can be written as asked, it is rescued, and the place is said") {
    const TempFolder folder;
    folder.write("scene.xml", lit_floor);
    fs::create_directory(folder.path() / "gone");
    const ProgramResult result =
        stopped_render(folder, {"-o", "gone/a.png", "--stats", "gone/s.json"},
                       [&] { fs::remove_all(folder.path() / "gone"); });
    INFO(result.err);
    CHECK(result.exit_code == 4);
    CHECK_THAT(result.err, Catch::Contains("gone/a.png: cannot be written"));
    CHECK_THAT(result.err, Catch::Contains("gone/s.json: cannot be written"));
    const auto names = names_in(folder.path());
    REQUIRE(names.size() == 2);
    CHECK_THAT(names[0], Catch::StartsWith("scene.rescued-") && Catch::EndsWith(".exr"));
    CHECK_THAT(result.err, Catch::Contains((folder.path() / names[0]).string()));
}

TEST_CASE("What can never be written is refused before the render") {
    const TempFolder folder;
    folder.write("scene.xml", lit_floor);
    fs::create_directory(folder.path() / "locked");
    folder.write("locked/old.png", "old");
    fs::permissions(folder.path() / "locked/old.png", fs::perms::all);
    fs::permissions(folder.path() / "locked", fs::perms::owner_read | fs::perms::owner_exec |
                                                  fs::perms::others_read | fs::perms::others_exec);
    fs::permissions(folder.path(), fs::perms::all);
    REQUIRE(mkfifo((folder.path() / "fifo.png").c_str(), 0666) == 0);
    const std::string long_name = std::string(300, 'a') + ".png";
    for (const std::string &name : {std::string("locked/new.png"), std::string("locked/old.png"),
                                    std::string("fifo.png"), long_name})
        for (const char *option : {"-o", "--stats"}) {
            INFO(option << " " << name);
            const ProgramResult result =
                run_clrender(folder.path(), {"scene.xml", option, name}, {}, become_ordinary);
            CHECK(result.exit_code == 2);
            CHECK(is_one_line(result.err));
        }
    CHECK(names_in(folder.path()) == std::vector<std::string>{"fifo.png", "locked", "scene.xml"});
    CHECK(names_in(folder.path() / "locked") == std::vector<std::string>{"old.png"});
}

TEST_CASE("A name of the greatest length is written") {
    const TempFolder folder;
    folder.write("scene.xml", lit_floor);
    const std::string name = std::string(251, 'a') + ".pfm";
    CHECK(run_clrender(folder.path(), {"scene.xml", "-q", "-o", name}).exit_code == 0);
    CHECK(folder.has(name));
}

TEST_CASE("A picture too large for its format is refused before the render") {
    const TempFolder folder;
    folder.write("scene.xml", lit_floor);
    const ProgramResult result = run_clrender(
        folder.path(), {"scene.xml", "-r", "65536x1", "-s", "1", "-o", "a.exr", "-o", "a.jpg"});
    CHECK(result.exit_code == 2);
    CHECK(is_one_line(result.err));
    CHECK_THAT(result.err, Catch::StartsWith("a.jpg: ") && Catch::Contains("65535"));
    CHECK(names_in(folder.path()) == std::vector<std::string>{"scene.xml"});
}

TEST_CASE("Nobody who listens costs no picture") {
    const TempFolder folder;
    folder.write("scene.xml", lit_floor);
    const auto closed = [] {
        const int full = open("/dev/full", O_WRONLY);
        dup2(full, STDERR_FILENO);
        dup2(full, STDOUT_FILENO);
    };
    CHECK(run_clrender(folder.path(), {"scene.xml", "-v", "-o", "a.pfm"}, {}, closed).exit_code ==
          0);
    CHECK(folder.has("a.pfm"));

    // Where the text is all there is, its loss is a failure.
    CHECK(run_clrender(folder.path(), {"--list-devices"}, {}, closed).exit_code == 4);
}

#endif
