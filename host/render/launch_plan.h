#pragma once
/// How a render is cut into launches.

#include <cstddef>
#include <vector>

namespace clrender {

/// Hands out the work: passes over the picture, of one or more blocks of samples each, cut into
/// runs of tiles. The picture does not depend on any of it.
class LaunchPlan {
public:
    /// Tiles first_item, first_item + 1, ... of a colour, the sample blocks [first_block,
    /// end_block).
    struct Launch {
        std::size_t first_item, item_count;
        int first_block, end_block;
        unsigned colour;
        bool ends_pass = false; ///< the last one of its blocks
    };

    /// `tiles_x` x `tiles_y` tiles, `blocks` blocks of samples. `by_colour`: samples reach into
    /// neighbouring tiles, so tiles are launched colour by colour and block by block, which fixes
    /// the order of all sums. `tile_items` and `batch`: as RenderOptions; 0 lets the measured speed
    /// decide, from `least_items` on.
    LaunchPlan(std::size_t tiles_x, std::size_t tiles_y, int blocks, bool by_colour,
               std::size_t tile_items, int batch, std::size_t least_items);

    [[nodiscard]] bool done() const { return first_block_ >= blocks_; }
    /// The next launch; only while not done.
    Launch next();
    /// A launch has taken so long: the next ones aim at about a tenth of a second.
    void learn(const Launch &launch, double seconds);

private:
    std::vector<std::size_t> items_; ///< by colour
    std::vector<unsigned> colours_;
    int blocks_;
    std::size_t least_items_;
    bool fixed_items_;
    std::size_t launch_items_;
    bool fixed_batch_;
    int batch_;
    std::size_t colour_ = 0; ///< index into colours_
    std::size_t next_item_ = 0;
    int first_block_ = 0;
};

} // namespace clrender
