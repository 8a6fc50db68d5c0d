#include "launch_plan.h"

#include "shared/launch_data.h"

#include <algorithm>

namespace clrender {

namespace {

/// Short enough for the desktop to stay alive and for Ctrl-C to be answered, long enough for the
/// cost of a launch to vanish.
constexpr double target_seconds = 0.1;

} // namespace

LaunchPlan::LaunchPlan(std::size_t tiles_x, std::size_t tiles_y, int blocks, bool by_colour,
                       std::size_t tile_items, int batch, std::size_t least_items)
    : blocks_(blocks), least_items_(least_items), fixed_items_(tile_items > 0),
      launch_items_(fixed_items_ ? tile_items : least_items), fixed_batch_(by_colour || batch > 0),
      batch_(by_colour ? 1 : std::max(batch, 1)) {
    if (!by_colour) {
        items_ = {tiles_x * tiles_y};
        colours_ = {CLR_ALL_TILES};
        return;
    }
    for (unsigned colour = 0; colour < CLR_TILE_COLOURS; ++colour) {
        const std::size_t columns = (tiles_x + 1 - (colour & 1)) / 2;
        const std::size_t rows = (tiles_y + 1 - (colour >> 1)) / 2;
        if (columns * rows > 0) {
            items_.push_back(columns * rows);
            colours_.push_back(colour);
        }
    }
}

LaunchPlan::Launch LaunchPlan::next() {
    const int end_block = std::min(first_block_ + batch_, blocks_);
    Launch launch{next_item_, std::min(launch_items_, items_[colour_] - next_item_), first_block_,
                  end_block, colours_[colour_]};
    next_item_ += launch.item_count;
    if (next_item_ == items_[colour_]) {
        next_item_ = 0;
        if (++colour_ == colours_.size()) {
            colour_ = 0;
            first_block_ = end_block;
            launch.ends_pass = true;
        }
    }
    return launch;
}

void LaunchPlan::learn(const Launch &launch, double seconds) {
    const auto units =
        static_cast<double>(launch.item_count) * (launch.end_block - launch.first_block);
    const double wanted = units * target_seconds / std::max(seconds, 1e-6);

    // Small pictures take several blocks in one launch, but only from one pass to the next.
    const auto items = static_cast<double>(items_[colour_]);
    if (!fixed_batch_ && next_item_ == 0)
        batch_ = std::clamp(static_cast<int>(wanted / items), 1, 1024);
    if (!fixed_items_)
        launch_items_ = std::max(least_items_, static_cast<std::size_t>(wanted / batch_));
}

} // namespace clrender
