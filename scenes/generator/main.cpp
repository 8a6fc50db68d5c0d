// Makes the meshes, textures and the sky that the scenes use.
#include "images.h"
#include "mesh_writer.h"
#include "shapes.h"
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

void print_usage() {
    std::fputs("usage: clrender-make-mesh SHAPE TRIANGLES OUT.obj [--seed N] "
               "[--texture OUT.png] [--size WxH]\n"
               "       clrender-make-mesh sky OUT.hdr [--size WxH]\n"
               "       clrender-make-mesh enlarge FACTOR IN.png OUT.png\n"
               "shapes:",
               stderr);
    for (const std::string &name : shape_names())
        std::fprintf(stderr, " %s", name.c_str());
    std::fputs("\n", stderr);
}

struct Options {
    std::vector<std::string> words;
    std::string texture;
    uint32_t seed = 1;
    int width = 1024, height = 512;
};

double to_number(const std::string &text, double low, double high) {
    char *end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0' || !(value >= low && value <= high))
        throw std::invalid_argument("'" + text + "' is not a number from " + std::to_string(low) +
                                    " to " + std::to_string(high));
    return value;
}

Options parse(int argc, char **argv) {
    Options options;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (word.rfind("--", 0) != 0) {
            options.words.push_back(word);
            continue;
        }
        if (++i == argc)
            throw std::invalid_argument(word + " needs a value");
        const std::string value = argv[i];
        if (word == "--seed")
            options.seed = static_cast<uint32_t>(to_number(value, 0, 4294967295.0));
        else if (word == "--texture")
            options.texture = value;
        else if (word == "--size") {
            const size_t x = value.find('x');
            options.width = static_cast<int>(to_number(value.substr(0, x), 1, 16384));
            options.height = static_cast<int>(
                to_number(value.substr(std::min(x, value.size() - 1) + 1), 1, 16384));
        } else
            throw std::invalid_argument("unknown option " + word);
    }
    return options;
}

void make_mesh(const Options &options) {
    const double triangles = to_number(options.words[1], 1e3, 16e6);
    const Surface surface = make_shape(options.words[0], triangles, options.seed);
    const MeshCounts counts = write_obj(surface, triangles, options.words[2]);
    std::printf("%s: %llu triangles, %llu vertices\n", options.words[2].c_str(),
                static_cast<unsigned long long>(counts.triangles),
                static_cast<unsigned long long>(counts.vertices));
    if (!options.texture.empty())
        write_texture(surface, options.width, options.height, options.texture);
}

} // namespace

int main(int argc, char **argv) {
    try {
        const Options options = parse(argc, argv);
        const auto &words = options.words;
        if (words.size() == 2 && words[0] == "sky")
            write_sky(options.width, options.height, words[1]);
        else if (words.size() == 4 && words[0] == "enlarge")
            enlarge(words[2], static_cast<int>(to_number(words[1], 1, 64)), words[3]);
        else if (words.size() == 3)
            make_mesh(options);
        else {
            print_usage();
            return 2;
        }
    } catch (const std::exception &error) {
        std::fprintf(stderr, "clrender-make-mesh: %s\n", error.what());
        return 2;
    }
    return 0;
}
