#pragma once
/// How a render is cut into launches.

#include "film/work_done.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace clrender {

/// Samples of every pixel that a render of `spp` begins with where its first pass takes long: in
/// one piece one, as that pass follows; in bands up to four, since the last band waits for all
/// others.
int preview_samples(int spp, bool in_bands);

/// Rows of tiles [first_row, end_row) of a picture `columns` tiles wide: a band, or all of it. In
/// bands of splatted pictures first_row is even, so that bands hold whole rows of every colour.
struct TileRows {
    std::size_t columns = 0;
    std::size_t first_row = 0, end_row = 0;
};

/// The measured speed of a render in each cell of a grid over the picture: parts of it differ by
/// the cost of what is seen in them, and cost about the same in every pass. It is kept from band to
/// band.
class LaunchPace {
public:
    /// Items of a launch in one cell.
    struct Run {
        std::size_t cell, items;
    };

    /// `columns` x `rows` tiles; no launch has less than `least_items` items, if there are as many.
    LaunchPace(std::size_t columns, std::size_t rows, std::size_t least_items);

    [[nodiscard]] std::size_t cell_of(std::size_t column, std::size_t row) const {
        return row / cell_rows_ * grid_columns_ + column / cell_columns_;
    }
    /// The column of tiles that the next cell begins with.
    [[nodiscard]] std::size_t end_of_cell(std::size_t column) const {
        return (column / cell_columns_ + 1) * cell_columns_;
    }
    /// Seconds of an item's sample in a cell; 0 as long as nothing has been measured. A cell that
    /// has not been launched yet is expected to be like the last launch.
    [[nodiscard]] double seconds_in(std::size_t cell) const {
        return knows(cell) ? std::max(cells_[cell].seconds, cells_[cell].before) : latest_;
    }
    [[nodiscard]] bool knows(std::size_t cell) const { return cells_[cell].seconds > 0; }
    [[nodiscard]] std::size_t least_items() const { return least_items_; }
    /// Items times samples of the last launch that was measured.
    [[nodiscard]] double latest_units() const { return latest_units_; }

    /// A launch of these items took `seconds` for `samples` samples of each, in the pass over the
    /// picture that is the `pass`th since the pace was made. Of all launches of this pass and the
    /// one before that meet in a cell, the slowest counts: a cell may lie across an edge.
    void measured(const std::vector<Run> &runs, int samples, double seconds, int pass);
    /// A number for the next pass.
    int begin_pass() { return ++passes_; }

private:
    std::size_t cell_columns_, cell_rows_, grid_columns_; ///< tiles of a cell; cells of a row
    std::size_t least_items_;
    struct Cell {
        double seconds = 0; ///< of an item's sample; 0: not known
        double before = 0;  ///< the same in the pass before
        int pass = 0;       ///< that `seconds` was measured in
    };
    std::vector<Cell> cells_;
    int passes_ = 0;
    double latest_ = 0;
    double latest_units_ = 0;
};

/// Hands out the work on some rows of tiles: passes over them, of one or more blocks of samples
/// each, cut into runs of tiles. The first pass takes one block, so that all tiles soon have some
/// samples. Launches take 50 to 100 milliseconds where the work allows it: short enough for a
/// desktop to stay usable and for Ctrl-C to be answered, long enough for their cost to vanish. The
/// picture does not depend on any of it.
class LaunchPlan {
public:
    /// Tiles first_item, first_item + 1, ... of a colour, the sample blocks [first_block,
    /// end_block). Items are counted over the whole picture.
    struct Launch {
        std::size_t first_item, item_count;
        int first_block, end_block;
        unsigned colour;
        int pass = 0;           ///< as LaunchPace::measured()
        bool ends_pass = false; ///< the last one of its blocks
    };

    /// `spp` samples of every pixel, of which those of the blocks before `first_block` have been
    /// taken. `by_colour`: samples reach into neighbouring tiles, so tiles
    /// are launched colour by colour. `tile_items` and `batch`: as RenderOptions; 0 lets the
    /// measured speed decide.
    LaunchPlan(const TileRows &rows, int spp, bool by_colour, LaunchPace &pace,
               std::size_t tile_items = 0, int batch = 0, int first_block = 0);
    /// From now on only these pieces are rendered, all of the blocks of the plan, one of a colour
    /// at most; before the first launch.
    void restrict_to(const Work &pieces);

    [[nodiscard]] bool done() const { return first_block_ >= blocks_; }
    /// The next launch; only while not done.
    Launch next();
    /// A launch has ended, the oldest of those that had not, and took so long.
    void finished(const Launch &launch, double seconds);

    /// Samples of each pixel that a launch takes.
    [[nodiscard]] int samples_of(const Launch &launch) const {
        return samples(launch.first_block, launch.end_block);
    }
    /// Whether launches of the first block are still to come.
    [[nodiscard]] bool is_in_first_pass() const { return first_block_ == 0 && !done(); }
    /// How long the first pass is expected to take in all; 0 before any launch has ended.
    [[nodiscard]] double seconds_of_first_pass() const;
    /// Samples that every pixel of all tiles has, by the launches that have ended.
    [[nodiscard]] int samples_of_all() const;
    /// The work of the launches that were handed out.
    [[nodiscard]] Work work() const;
    /// Whether the pixels of a tile, numbered over the whole picture, have samples.
    [[nodiscard]] bool has_samples(std::size_t column, std::size_t row) const;

private:
    struct Colour {
        unsigned number;
        std::size_t first_item, end_item;
        std::size_t columns;     ///< items of a row
        std::size_t finished{0}; ///< items behind the last launch of the first pass that has ended
    };

    [[nodiscard]] int samples(int first_block, int end_block) const;
    template <typename Visit>
    void for_each_run(const Colour &colour, std::size_t first, std::size_t end, Visit visit) const;
    [[nodiscard]] std::size_t items_of_launch(const Colour &colour, int samples) const;
    [[nodiscard]] double seconds_of(const Colour &colour, std::size_t first_item) const;
    [[nodiscard]] int end_of_pass() const;

    int spp_;
    int blocks_;
    bool by_colour_;
    LaunchPace &pace_;
    std::size_t tile_items_;
    int batch_;
    std::vector<Colour> colours_;
    int pass_;
    std::size_t colour_ = 0; ///< index into colours_
    std::size_t next_item_ = 0;
    int first_block_ = 0, end_block_ = 0; ///< of the current pass
    int start_block_ = 0;                 ///< of the plan
    int finished_block_ = 0;              ///< end of the last pass that has ended
};

} // namespace clrender
