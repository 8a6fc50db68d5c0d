/// Launches and bands: that all of the picture is rendered once, and how long launches are.

#include "render/bands.h"
#include "render/launch_plan.h"
#include "shared/launch_data.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

using namespace clrender;

namespace {

/// The tile that an item of a colour renders, as the kernel's tile_of_item() has it.
std::pair<std::size_t, std::size_t> tile_of(std::size_t columns, unsigned colour,
                                            std::size_t item) {
    if (colour == CLR_ALL_TILES)
        return {item % columns, item / columns};
    const std::size_t of_colour = (columns + 1 - (colour & 1)) / 2;
    return {item % of_colour * 2 + (colour & 1), item / of_colour * 2 + (colour >> 1)};
}

std::size_t row_of(std::size_t columns, const LaunchPlan::Launch &launch, std::size_t i) {
    return tile_of(columns, launch.colour, launch.first_item + i).second;
}

/// A device that takes `row_cost` seconds for a sample of a tile in a row, and some for a launch.
struct Device {
    std::function<double(std::size_t)> row_cost;

    [[nodiscard]] double seconds(std::size_t columns, const LaunchPlan &plan,
                                 const LaunchPlan::Launch &launch) const {
        double seconds = 1e-4;
        for (std::size_t i = 0; i < launch.item_count; ++i)
            seconds += row_cost(row_of(columns, launch, i)) * plan.samples_of(launch);
        return seconds;
    }
};

struct Length {
    double seconds;
    bool first_pass, least;
};

/// Runs a plan as the renderer does: the next launch is planned before the last one has ended.
std::vector<Length> lengths(std::size_t columns, std::size_t rows, int spp, bool by_colour,
                            const Device &device) {
    constexpr std::size_t least = 2;
    LaunchPace pace(columns, rows, least);
    LaunchPlan plan({columns, 0, rows}, spp, by_colour, pace);
    std::vector<LaunchPlan::Launch> pending;
    std::vector<Length> result;
    while (!plan.done() || !pending.empty()) {
        while (!plan.done() && pending.size() < 2)
            pending.push_back(plan.next());
        const LaunchPlan::Launch launch = pending.front();
        pending.erase(pending.begin());
        const double seconds = device.seconds(columns, plan, launch);
        plan.finished(launch, seconds);
        result.push_back({seconds, launch.first_block == 0, launch.item_count <= least});
    }
    return result;
}

} // namespace

TEST_CASE("every block of every tile is in one launch, in bands or in one piece", "[launch]") {
    struct Size {
        std::size_t columns, rows;
    };
    for (const bool by_colour : {false, true})
        for (const Size size : {Size{1, 1}, Size{5, 3}, Size{8, 9}, Size{1, 7}})
            for (const std::size_t band_rows : {0, 2, 4}) {
                INFO(size.columns << "x" << size.rows << " tiles, bands of " << band_rows
                                  << (by_colour ? ", by colour" : ""));
                constexpr int spp = 1000;
                const PictureTiles tiles{size.columns * 8 - 3, size.rows * 8 - 5, 8, 2};
                std::map<std::pair<std::size_t, std::size_t>, int> samples;
                LaunchPace pace(size.columns, size.rows, 2);
                for (const Band &band : cut_into_bands(tiles, SIZE_MAX, band_rows)) {
                    LaunchPlan plan(band.tiles, spp, by_colour, pace);
                    while (!plan.done()) {
                        const LaunchPlan::Launch launch = plan.next();
                        REQUIRE(launch.item_count > 0);
                        for (std::size_t i = 0; i < launch.item_count; ++i) {
                            const auto tile =
                                tile_of(size.columns, launch.colour, launch.first_item + i);
                            REQUIRE(tile.first < size.columns);
                            REQUIRE(tile.second >= band.tiles.first_row);
                            REQUIRE(tile.second < band.tiles.end_row);
                            int &done = samples[tile];
                            REQUIRE(done == CLR_BLOCK_START(launch.first_block));
                            done += plan.samples_of(launch);
                        }
                        plan.finished(launch, 1e-3);
                    }
                    CHECK(plan.samples_of_all() == spp);
                }
                CHECK(samples.size() == size.columns * size.rows);
                CHECK(std::all_of(samples.begin(), samples.end(),
                                  [&](const auto &s) { return s.second == spp; }));
            }
}

TEST_CASE("the first pass takes one block of every tile, and the plan tells which have samples",
          "[launch]") {
    for (const bool by_colour : {false, true}) {
        INFO((by_colour ? "by colour" : "all tiles"));
        constexpr std::size_t columns = 7, rows = 5;
        LaunchPace pace(columns, rows, 2);
        LaunchPlan plan({columns, 0, rows}, 10000, by_colour, pace, 3);
        std::map<std::pair<std::size_t, std::size_t>, bool> done;
        while (plan.samples_of_all() == 0) {
            for (std::size_t y = 0; y < rows; ++y)
                for (std::size_t x = 0; x < columns; ++x)
                    REQUIRE(plan.has_samples(x, y) == done[{x, y}]);
            const LaunchPlan::Launch launch = plan.next();
            REQUIRE(launch.first_block == 0);
            REQUIRE(launch.end_block == 1);
            plan.finished(launch, 1e-3);
            for (std::size_t i = 0; i < launch.item_count; ++i)
                done[tile_of(columns, launch.colour, launch.first_item + i)] = true;
        }
        CHECK(done.size() == columns * rows);
        CHECK(plan.samples_of_all() == CLR_BLOCK_START(1));
        CHECK(plan.has_samples(columns - 1, rows - 1));
    }
}

TEST_CASE("launches take 50 to 100 milliseconds at every size and speed", "[launch]") {
    struct Case {
        std::size_t columns, rows;
        double cost; ///< seconds of a tile's sample, on average
        int spp;
    };
    // From 64x48 pixels to 8192x8192, at 100 million and 300 thousand paths a second.
    for (const Case c : {Case{8, 6, 64 / 3e6, 200000}, Case{8, 6, 64 / 1e8, 4000000},
                         Case{8, 6, 64 / 3e5, 1000}, Case{128, 96, 64 / 3e6, 600},
                         Case{128, 96, 64 / 3e5, 300}, Case{1024, 1024, 64 / 1e8, 128}})
        for (const bool by_colour : {false, true})
            for (const double contrast : {1.0, 10.0}) {
                INFO(c.columns << "x" << c.rows << " tiles of " << c.cost << " s, " << c.spp
                               << " samples, rows differ by " << contrast
                               << (by_colour ? ", by colour" : ""));
                // Dear rows in the middle of the picture, behind a sharp edge.
                const Device device{[&](std::size_t row) {
                    const bool dear = row > c.rows / 3 && row < c.rows / 2;
                    return c.cost * (dear ? contrast : 1);
                }};
                const std::vector<Length> all =
                    lengths(c.columns, c.rows, c.spp, by_colour, device);
                double in_range = 0, counted = 0, longest = 0, longest_first = 0;
                for (const Length &l : all) {
                    if (l.least)
                        continue;
                    (l.first_pass ? longest_first : longest) =
                        std::max(l.first_pass ? longest_first : longest, l.seconds);
                    if (l.first_pass)
                        continue;
                    counted += l.seconds;
                    in_range += l.seconds >= 0.045 && l.seconds <= 0.105 ? l.seconds : 0;
                }
                INFO("longest " << longest << " s, in the first pass " << longest_first << " s");
                // The first pass meets the dear rows unprepared.
                CHECK(longest_first < 0.05 * contrast + 0.05);
                CHECK(longest < 0.2);
                CHECK(counted > 0);
                CHECK(in_range > 0.9 * counted);
            }
}

TEST_CASE("bands hold whole rows of all colours and what these reach, within the bytes",
          "[launch]") {
    constexpr std::size_t limit = std::size_t{512} << 20;
    for (const PictureTiles tiles :
         {PictureTiles{16384, 16384, 8, 2}, PictureTiles{65536, 4096, 8, 4},
          PictureTiles{4096, 65536, 1, 0}, PictureTiles{10001, 9999, 8, 2}}) {
        INFO(tiles.width << "x" << tiles.height);
        const std::vector<Band> bands = cut_into_bands(tiles, limit);
        REQUIRE(bands.size() > 1);
        CHECK(bands.front().first_row == 0);
        CHECK(bands.back().end_row == tiles.height);
        std::size_t row = 0;
        for (const Band &band : bands) {
            CHECK(band.tiles.first_row == row);
            CHECK(band.tiles.first_row % 2 == 0);
            CHECK(band.tiles.columns == tiles.columns());
            row = band.tiles.end_row;
            CHECK(band_bytes(tiles, band) <= limit);
            CHECK((band.first_row == 0 ||
                   band.first_row == band.tiles.first_row * tiles.side - 2 * tiles.border));
            CHECK((band.end_row == tiles.height ||
                   band.end_row == band.tiles.end_row * tiles.side + tiles.border));
        }
        CHECK(row == tiles.rows());
    }
    CHECK(cut_into_bands({640, 480, 8, 2}, limit).size() == 1);
}
