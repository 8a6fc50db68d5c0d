#include "launch_plan.h"

#include <algorithm>

namespace clrender {

namespace {

/// Short enough for the desktop to stay alive and for Ctrl-C to be answered, long enough for the
/// cost of a launch to vanish.
constexpr double target_seconds = 0.1;

} // namespace

LaunchPlan::LaunchPlan(std::size_t items, int blocks, std::size_t tile_items, int batch_blocks,
                       std::size_t least_items)
    : items_(items), blocks_(blocks), least_items_(std::min(least_items, items)),
      fixed_tile_(tile_items > 0), tile_items_(fixed_tile_ ? tile_items : least_items_),
      batch_blocks_(std::max(batch_blocks, 1)), fixed_batch_(batch_blocks > 0) {}

LaunchPlan::Launch LaunchPlan::next() {
    const int end_block = std::min(first_block_ + batch_blocks_, blocks_);
    const Launch launch{next_item_, std::min(tile_items_, items_ - next_item_), first_block_,
                        end_block};
    next_item_ += launch.item_count;
    if (next_item_ == items_) {
        next_item_ = 0;
        first_block_ = end_block;
    }
    return launch;
}

void LaunchPlan::learn(const Launch &launch, double seconds) {
    const auto units =
        static_cast<double>(launch.item_count) * (launch.end_block - launch.first_block);
    const double wanted = units * target_seconds / std::max(seconds, 1e-6);

    // Small pictures take several blocks in one launch, but only from one pass to the next.
    if (!fixed_batch_ && next_item_ == 0)
        batch_blocks_ = std::clamp(static_cast<int>(wanted / static_cast<double>(items_)), 1, 1024);
    if (!fixed_tile_)
        tile_items_ = static_cast<std::size_t>(std::clamp(wanted / batch_blocks_,
                                                          static_cast<double>(least_items_),
                                                          static_cast<double>(items_)));
}

} // namespace clrender
