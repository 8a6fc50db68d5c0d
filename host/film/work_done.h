#pragma once
/// Which samples of which tiles a film has: of checkpoints, and of parts that are merged.

#include <cstdint>
#include <vector>

namespace clrender {

/// The blocks of samples [first_block, end_block) (film_blocks.h) of the tiles [first_item,
/// end_item) of a colour, as LaunchPlan numbers them.
struct WorkPiece {
    int first_block = 0, end_block = 0;
    unsigned colour = 0;
    std::uint64_t first_item = 0, end_item = 0;

    bool operator==(const WorkPiece &) const = default;
};

using Work = std::vector<WorkPiece>;

/// The tiles of a picture, and whether they are launched colour by colour.
struct WorkGrid {
    std::uint64_t columns = 0, rows = 0;
    bool by_colour = false;

    bool operator==(const WorkGrid &) const = default;
};

/// The blocks [first_block, end_block) of all tiles, a piece for each colour.
Work all_work(const WorkGrid &grid, int first_block, int end_block);

/// The share of part `part` of `parts` (counted from 1) of the first `blocks` blocks: each
/// `parts`th block; where there are fewer blocks than parts, a share of the tiles of each block.
Work part_of_work(const WorkGrid &grid, int blocks, int part, int parts);

/// What of `wanted` is not in `done`.
Work missing_work(const Work &wanted, const Work &done);

/// Whether both have some samples.
bool overlap(const Work &a, const Work &b);

/// The same work in few pieces.
Work joined(Work pieces);

} // namespace clrender
