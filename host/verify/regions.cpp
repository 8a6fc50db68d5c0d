#include "regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace clrender::verify {

namespace {

/// The number of the region that each pixel is in, from 1; 0 in none.
struct Map {
    int width = 0, height = 0;
    std::vector<int> region;

    int &at(int x, int y) {
        return region[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x)];
    }
};

constexpr int marked = -1;

template <typename Use> void for_each_pixel(const Windows &windows, std::size_t window, Use use) {
    for (int y = windows.top(window); y < windows.top(window) + windows.height(); ++y)
        for (int x = windows.left(window); x < windows.left(window) + windows.width(); ++x)
            use(x, y);
}

Map mark_findings(const PictureTest &test, const PictureTest::Look &look, const Image &image) {
    Map map = {image.width, image.height, {}};
    map.region.assign(
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height), 0);
    for (std::size_t f = 0; f < look.families.size(); ++f) {
        const Windows &windows = test.families()[f].windows();
        if (windows.count() == 1)
            continue;
        for (const Family::Finding &finding : look.families[f].findings)
            for_each_pixel(windows, finding.window, [&](int x, int y) { map.at(x, y) = marked; });
    }
    return map;
}

/// Gives the marked pixels that are connected with (x, y) the number of a region.
Region fill(Map &map, int x, int y, int number) {
    Region region = {x, y, x, y, 0, nullptr, {}};
    std::vector<std::array<int, 2>> open = {{x, y}};
    map.at(x, y) = number;
    while (!open.empty()) {
        const auto [i, j] = open.back();
        open.pop_back();
        ++region.pixels;
        region = {std::min(region.left, i),
                  std::min(region.top, j),
                  std::max(region.right, i),
                  std::max(region.bottom, j),
                  region.pixels,
                  nullptr,
                  {}};
        for (const auto &[dx, dy] : {std::array{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
            const int u = i + dx, v = j + dy;
            if (u >= 0 && u < map.width && v >= 0 && v < map.height && map.at(u, v) == marked) {
                map.at(u, v) = number;
                open.push_back({u, v});
            }
        }
    }
    return region;
}

/// All regions, in the order of their numbers in the map.
std::vector<Region> number_regions(Map &map, const PictureTest &test,
                                   const PictureTest::Look &look) {
    std::vector<Region> regions;
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x)
            if (map.at(x, y) == marked)
                regions.push_back(fill(map, x, y, static_cast<int>(regions.size()) + 1));
    for (std::size_t f = 0; f < look.families.size(); ++f) {
        const Family &family = test.families()[f];
        if (family.windows().count() == 1)
            continue;
        for (const Family::Finding &finding : look.families[f].findings) {
            const int number =
                map.at(family.windows().left(finding.window), family.windows().top(finding.window));
            Region &region = regions[static_cast<std::size_t>(number) - 1];
            if (region.family == nullptr || std::abs(finding.t) > std::abs(region.worst.t)) {
                region.family = &family;
                region.worst = finding;
            }
        }
    }
    return regions;
}

/// The picture's brightness for the eye, at most a half.
float dimmed(const Image &image, std::size_t pixel) {
    const auto channels = static_cast<std::size_t>(image.channels);
    const auto colours = static_cast<std::size_t>(colour_channels(image));
    double sum = 0;
    for (std::size_t c = 0; c < colours; ++c)
        sum += std::clamp(double{image.f32[pixel * channels + c]}, 0.0, 1.0);
    return static_cast<float>(0.5 * sum / static_cast<double>(colours));
}

} // namespace

std::vector<Region> find_regions(const PictureTest &test, const PictureTest::Look &look,
                                 const Image &image) {
    Map map = mark_findings(test, look, image);
    std::vector<Region> regions = number_regions(map, test, look);
    std::stable_sort(regions.begin(), regions.end(),
                     [](const Region &a, const Region &b) { return a.pixels > b.pixels; });
    return regions;
}

Image mark_regions(const Image &image, const PictureTest &test, const PictureTest::Look &look) {
    constexpr float tint = 0.3F;
    Map map = mark_findings(test, look, image);
    const std::vector<Region> regions = number_regions(map, test, look);
    Image result;
    result.width = image.width;
    result.height = image.height;
    result.channels = 3;
    for (std::size_t pixel = 0; pixel < map.region.size(); ++pixel) {
        const float grey = dimmed(image, pixel);
        const bool red = map.region[pixel] != 0;
        result.f32.insert(result.f32.end(),
                          {red ? grey + tint : grey, red ? grey / 2 : grey, red ? grey / 2 : grey});
    }
    const auto frame = [&](int x, int y) {
        if (x < 0 || x >= image.width || y < 0 || y >= image.height)
            return;
        const std::size_t i =
            3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                 static_cast<std::size_t>(x));
        result.f32[i] = result.f32[i + 1] = 1;
        result.f32[i + 2] = 0;
    };
    for (const Region &region : regions) {
        for (int x = region.left - 1; x <= region.right + 1; ++x) {
            frame(x, region.top - 1);
            frame(x, region.bottom + 1);
        }
        for (int y = region.top - 1; y <= region.bottom + 1; ++y) {
            frame(region.left - 1, y);
            frame(region.right + 1, y);
        }
    }
    return result;
}

} // namespace clrender::verify
