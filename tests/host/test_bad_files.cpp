#include "files.h"

#include "image/image.h"
#include "scene/mesh_io.h"

#include <catch2/catch.hpp>

#include <sys/stat.h>

#include <chrono>
#include <functional>

using namespace clrender;

namespace {

/// Each line of FOLDER/expectations.txt is `file:line:text`: reading the file throws an InputError
/// that begins with the file's path and line (none for 0) and contains the text.
void check_folder(const std::string &name, const std::function<void(const std::string &)> &read) {
    const std::string folder = std::string(CLRENDER_TEST_DIR) + "/stress/" + name + "/";
    std::ifstream expectations(folder + "expectations.txt");
    std::string entry;
    int count = 0;
    while (std::getline(expectations, entry)) {
        const std::size_t colon = entry.find(':');
        const std::size_t colon2 = entry.find(':', colon + 1);
        const SourceLocation where{folder + entry.substr(0, colon),
                                   std::stoi(entry.substr(colon + 1))};
        const auto start = std::chrono::steady_clock::now();
        const std::string error = test::error_of([&] { read(where.file); });
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        INFO(entry << "\n" << error);
        CHECK(error.find(where.str() + ": ") == 0);
        CHECK(error.find(entry.substr(colon2 + 1)) != std::string::npos);
        CHECK(error.find('\n') == std::string::npos);
        CHECK_THROWS_AS(read(where.file), InputError);
        CHECK(seconds.count() < 1);
        ++count;
    }
    CHECK(count >= 25);
}

} // namespace

TEST_CASE("malformed meshes are errors with their line", "[bad]") {
    check_folder("bad_meshes", [](const std::string &path) {
        if (path.ends_with(".ply"))
            (void)read_ply_mesh(path, {});
        else
            (void)read_obj_mesh(path, {});
    });
}

TEST_CASE("malformed images are errors", "[bad]") {
    check_folder("bad_images", [](const std::string &path) { (void)read_image(path); });
}

TEST_CASE("a FIFO or a folder is an error and does not block", "[bad]") {
    const test::ScratchFolder folder;
    const std::string fifo = folder.path("fifo.png");
    REQUIRE(::mkfifo(fifo.c_str(), 0600) == 0);
    for (const std::string &path : {fifo, folder.path("")}) {
        CHECK_THROWS_AS(read_image(path), InputError);
        CHECK_THROWS_AS(read_ply_mesh(path, {}), InputError);
        CHECK_THROWS_AS(read_obj_mesh(path, {}), InputError);
    }
}
