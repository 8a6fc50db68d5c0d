/// Malformed scenes, models and images, given to the real program: exit code 2, one line with the
/// place, quickly, in little memory, and no picture.
///
/// What each file of bad_scenes, bad_meshes and bad_images has to be refused with stands in the
/// folder's expectations.txt, as `file:line:part of the message`, or in the file itself as
/// `<!-- expect: LINE: part of the message -->`. Line 0 stands for no line.

#include "program.h"

#include <catch2/catch.hpp>
#include <map>
#include <optional>
#include <regex>
#include <sys/stat.h>

using namespace clrender::test;

namespace {

struct Expectation {
    int line = 0;
    std::string part;
};

/// `line:part`, with or without spaces around them.
std::optional<Expectation> parse_expectation(const std::string &text) {
    std::smatch match;
    if (!std::regex_match(text, match, std::regex(R"(\s*(\d+)\s*:\s*(.*?)\s*)")))
        return std::nullopt;
    return Expectation{std::stoi(match[1]), match[2]};
}

std::map<std::string, Expectation> read_expectations(const fs::path &folder) {
    std::map<std::string, Expectation> all;
    std::ifstream list(folder / "expectations.txt");
    for (std::string text; std::getline(list, text);) {
        const std::size_t colon = text.find(':');
        if (text.empty() || text[0] == '#' || colon == std::string::npos)
            continue;
        if (const auto expectation = parse_expectation(text.substr(colon + 1)))
            all[text.substr(0, colon)] = *expectation;
    }

    for (const auto &entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (!entry.is_regular_file() || all.count(name) != 0 || name == "expectations.txt")
            continue;
        const std::string start = read_file(entry.path()).substr(0, 4096);
        std::smatch match;
        if (std::regex_search(start, match, std::regex("<!-- expect:(.*?)-->")))
            if (const auto expectation = parse_expectation(match[1]))
                all[name] = *expectation;
    }
    return all;
}

/// The files of a folder that have to be refused, in order.
std::vector<fs::path> files_of(const fs::path &folder) {
    std::vector<fs::path> files;
    for (const auto &entry : fs::directory_iterator(folder))
        if (entry.is_regular_file() && entry.path().filename() != "expectations.txt")
            files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

#ifdef CLRENDER_SANITIZE
constexpr double time_limit = 10;
constexpr bool measures_memory = false; // of the sanitizer's own there is more
#else
constexpr double time_limit = 1;
constexpr bool measures_memory = true;
#endif

/// What the program takes before it has read anything.
long idle_kib() {
    static const long kib = run_clrender(fs::temp_directory_path(), {"--version"}).peak_kib;
    return kib;
}

/// Renders `file` and checks all that holds for every refusal; returns the line on stderr.
std::string refuse(const TempFolder &folder, const std::string &file, std::uintmax_t bytes) {
    const ProgramResult result = run_clrender(folder.path(), {file, "-o", "out.png"});
    INFO("stderr: " << result.err.substr(0, 2000));
    CHECK(result.exit_code == 2);
    CHECK(is_one_line(result.err));
    CHECK(result.cpu_seconds < time_limit);
    CHECK_FALSE(folder.has("out.png"));
    if (measures_memory)
        CHECK(result.peak_kib - idle_kib() <= 64 * 1024 + 4 * static_cast<long>(bytes / 1024));
    return result.err;
}

std::string refuse(const TempFolder &folder, const std::string &file) {
    const fs::path path = folder.path() / file;
    return refuse(folder, file, fs::is_regular_file(path) ? fs::file_size(path) : 0);
}

std::string place(const std::string &file, int line) {
    return line > 0 ? file + ":" + std::to_string(line) + ": " : file + ": ";
}

/// Every file of a folder, rendered as it is.
void refuse_folder(const std::string &name) {
    const fs::path bad = fs::path(CLRENDER_TEST_DIR) / "stress" / name;
    const auto expectations = read_expectations(bad);
    for (const fs::path &file : files_of(bad)) {
        INFO(file.filename().string());
        const auto expected = expectations.find(file.filename().string());
        REQUIRE(expected != expectations.end());
        const TempFolder folder;
        const std::string line = refuse(folder, file.string(), fs::file_size(file));
        CHECK_THAT(line, Catch::StartsWith(place(file.string(), expected->second.line)));
        CHECK_THAT(line, Catch::Contains(expected->second.part, Catch::CaseSensitive::No));
    }
}

/// A scene whose fifth line names an image.
std::string scene_with_image(const std::string &image) {
    return "<scene version=\"3.0.0\">\n"
           "    <sensor type=\"perspective\"/>\n"
           "    <shape type=\"sphere\"><bsdf type=\"diffuse\">\n"
           "        <texture type=\"bitmap\" name=\"reflectance\">\n"
           "            <string name=\"filename\" value=\"" +
           image +
           "\"/>\n"
           "        </texture></bsdf></shape>\n"
           "    <emitter type=\"constant\"/>\n"
           "</scene>\n";
}

} // namespace

TEST_CASE("Malformed scenes are refused with their place") {
    refuse_folder("bad_scenes");
}

TEST_CASE("Malformed models are refused with their place") {
    refuse_folder("bad_meshes");
}

TEST_CASE("Malformed images are refused with the place that names them") {
    const fs::path bad = fs::path(CLRENDER_TEST_DIR) / "stress" / "bad_images";
    const auto expectations = read_expectations(bad);
    for (const fs::path &file : files_of(bad)) {
        INFO(file.filename().string());
        const auto expected = expectations.find(file.filename().string());
        REQUIRE(expected != expectations.end());
        const TempFolder folder;
        folder.write("scene.xml", scene_with_image(file.string()));
        const std::string line = refuse(folder, "scene.xml", fs::file_size(file));
        CHECK_THAT(line, Catch::StartsWith("scene.xml:4: ") || Catch::StartsWith("scene.xml:5: "));
        CHECK_THAT(line, Catch::Contains(file.filename().string()));
        CHECK_THAT(line, Catch::Contains(expected->second.part, Catch::CaseSensitive::No));
    }
}

TEST_CASE("What is not a file is refused") {
    const TempFolder folder;
    fs::create_directory(folder.path() / "folder.xml");
    fs::create_directory(folder.path() / "folder.obj");
    REQUIRE(mkfifo((folder.path() / "fifo.xml").c_str(), 0600) == 0);
    REQUIRE(mkfifo((folder.path() / "fifo.ply").c_str(), 0600) == 0);
    for (const std::string name : {"missing.xml", "missing.obj", "folder.xml", "folder.obj",
                                   "fifo.xml", "fifo.ply", "scene.unknown"}) {
        INFO(name);
        CHECK_THAT(refuse(folder, name), Catch::StartsWith(name + ": "));
    }
}

TEST_CASE("Elements nested 200 thousand deep are refused") {
    const TempFolder folder;
    std::string text = "<scene version=\"3.0.0\">\n";
    for (int i = 0; i < 200000; ++i)
        text += "<shape type=\"sphere\">";
    folder.write("deep.xml", text);
    CHECK_THAT(refuse(folder, "deep.xml"), Catch::StartsWith("deep.xml:"));
}

TEST_CASE("Scenes that include each other are refused") {
    const TempFolder folder;
    folder.write("a.xml", "<scene version=\"3.0.0\">\n<include filename=\"b.xml\"/>\n</scene>\n");
    folder.write("b.xml", "<scene version=\"3.0.0\">\n<include filename=\"a.xml\"/>\n</scene>\n");
    CHECK_THAT(refuse(folder, "a.xml"), Catch::Contains(".xml:2: "));
}

TEST_CASE(
    "A line of a thousand million characters is refused, and a polygon of a million corners") {
    const TempFolder folder;
    folder.write("hole.obj", "v 0 0 0\nf 1");
    fs::resize_file(folder.path() / "hole.obj", 1000000000);
    CHECK_THAT(refuse(folder, "hole.obj"), Catch::StartsWith("hole.obj:2: line longer"));

    std::string polygon = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf";
    for (int i = 0; i < 333334; ++i)
        polygon += " 1 2 3";
    folder.write("polygon.obj", polygon + "\n");
    CHECK_THAT(refuse(folder, "polygon.obj"), Catch::StartsWith("polygon.obj:4: line longer"));
}

TEST_CASE("A fault at the end of a long file is told in little memory") {
    const TempFolder folder;
    std::string vertices, faces = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (int i = 0; i < 1000000; ++i) {
        vertices += "v 0 0 0\n";
        faces += "f 1 2 3\n";
    }
    folder.write("vertices.obj", vertices + "f 1 2 x\n");
    folder.write("faces.obj", faces + "f 1 2 x\n");
    CHECK_THAT(refuse(folder, "vertices.obj"), Catch::StartsWith("vertices.obj:1000001: "));
    CHECK_THAT(refuse(folder, "faces.obj"), Catch::StartsWith("faces.obj:1000004: "));

    std::string elements = "<scene version=\"3.0.0\">\n";
    for (int i = 0; i < 100000; ++i)
        elements += "<float name=\"a" + std::to_string(i) + "\" value=\"1\"/>\n";
    folder.write("elements.xml", elements + "</shape>");
    CHECK_THAT(refuse(folder, "elements.xml"), Catch::StartsWith("elements.xml:100002: "));
}

TEST_CASE("Names out of a file stay on one line") {
    const TempFolder folder;
    folder.write("scene.xml", scene_with_image("no&#10;such&#9;file.png"));
    CHECK_THAT(refuse(folder, "scene.xml"), Catch::StartsWith("scene.xml:5: "));
}

TEST_CASE("A line of 64 million characters is refused") {
    const TempFolder folder;
    folder.write("long.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf " + std::string(64000000, '1') + "\n");
    CHECK_THAT(refuse(folder, "long.obj"), Catch::StartsWith("long.obj:4: "));
}
