#pragma once
/// How a render is cut into launches.

#include <cstddef>
#include <vector>

namespace clrender {

/// Hands out the work: passes over the picture, one or more blocks of samples each, cut into runs
/// of work-items. The picture does not depend on any of it.
class LaunchPlan {
public:
    struct Launch {
        std::size_t first_item, item_count;
        int first_block, end_block;
    };

    /// `blocks` blocks of samples for `items` work-items. `tile_items` and `batch_blocks`: as
    /// RenderOptions; 0 lets the measured speed decide.
    LaunchPlan(std::size_t items, int blocks, std::size_t tile_items, int batch_blocks,
               std::size_t least_items);

    [[nodiscard]] bool done() const { return first_block_ >= blocks_; }
    /// The next launch; only while not done.
    Launch next();
    /// A launch has taken so long: the next ones aim at about a tenth of a second.
    void learn(const Launch &launch, double seconds);

private:
    std::size_t items_;
    int blocks_;
    std::size_t least_items_;
    bool fixed_tile_;
    std::size_t tile_items_;
    int batch_blocks_;
    bool fixed_batch_;
    std::size_t next_item_ = 0;
    int first_block_ = 0;
};

} // namespace clrender
