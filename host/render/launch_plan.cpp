#include "launch_plan.h"

#include "film/film_blocks.h"
#include "shared/launch_data.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace clrender {

namespace {

/// The longest launch that is planned; one of two equal parts of more than that takes half of it.
constexpr double longest_seconds = 0.095;
/// In the first pass launches are planned shorter, as the tiles ahead may cost more than those
/// before, by this factor or, where nothing of a cell has been measured, the second one; there a
/// launch is also at most so much larger than the last one.
constexpr double first_caution = 2;
constexpr double unknown_caution = 4;
constexpr double largest_step = 4;
/// Cells in a row and in a column of the grid at most.
constexpr std::size_t most_cells = 128;
constexpr int most_blocks = 1024;

} // namespace

int preview_samples(int spp, bool in_bands) {
    return in_bands ? std::clamp(spp / 256, 1, 4) : 1;
}

LaunchPace::LaunchPace(std::size_t columns, std::size_t rows, std::size_t least_items)
    : cell_columns_(std::max<std::size_t>((columns + most_cells - 1) / most_cells, 2)),
      cell_rows_(std::max<std::size_t>((rows + most_cells - 1) / most_cells, 2)),
      grid_columns_((columns + cell_columns_ - 1) / cell_columns_), least_items_(least_items),
      cells_(grid_columns_ * ((rows + cell_rows_ - 1) / cell_rows_)) {}

void LaunchPace::measured(const std::vector<Run> &runs, int samples, double seconds, int pass) {
    double items = 0;
    for (const Run &run : runs)
        items += static_cast<double>(run.items);
    latest_units_ = items * samples;
    latest_ = std::max(seconds, 1e-6) / latest_units_;
    for (const Run &run : runs) {
        Cell &cell = cells_[run.cell];
        if (cell.pass != pass) {
            cell.before = cell.seconds;
            cell.seconds = 0;
            cell.pass = pass;
        }
        cell.seconds = std::max(cell.seconds, latest_);
    }
}

LaunchPlan::LaunchPlan(const TileRows &rows, int spp, bool by_colour, LaunchPace &pace,
                       std::size_t tile_items, int batch, int first_block)
    : spp_(spp), blocks_(blocks_of(spp)), by_colour_(by_colour), pace_(pace),
      tile_items_(tile_items), batch_(batch), pass_(pace.begin_pass()), first_block_(first_block),
      start_block_(first_block), finished_block_(first_block) {
    if (by_colour) {
        for (unsigned number = 0; number < CLR_TILE_COLOURS; ++number) {
            const std::size_t columns = (rows.columns + 1 - (number & 1)) / 2;
            const std::size_t end_row = (rows.end_row + 1 - (number >> 1)) / 2;
            const Colour colour{number, rows.first_row / 2 * columns, end_row * columns, columns};
            if (colour.end_item > colour.first_item)
                colours_.push_back(colour);
        }
    } else {
        colours_.push_back({CLR_ALL_TILES, rows.first_row * rows.columns,
                            rows.end_row * rows.columns, rows.columns});
    }
    for (Colour &colour : colours_)
        colour.finished = first_block_ == 0 ? colour.first_item : colour.end_item;
    next_item_ = colours_[0].first_item;
    end_block_ = first_block_ == 0 ? std::min(1, blocks_) : end_of_pass();
}

void LaunchPlan::restrict_to(const Work &pieces) {
    std::vector<Colour> colours;
    for (Colour &colour : colours_)
        for (const WorkPiece &piece : pieces)
            if (piece.colour == colour.number) {
                colour.first_item = piece.first_item;
                colour.end_item = piece.end_item;
                colour.finished = first_block_ == 0 ? colour.first_item : colour.end_item;
                colours.push_back(colour);
            }
    colours_ = std::move(colours);
    next_item_ = colours_[0].first_item;
}

Work LaunchPlan::work() const {
    Work work;
    for (std::size_t i = 0; i < colours_.size(); ++i) {
        const Colour &colour = colours_[i];
        if (first_block_ > start_block_)
            work.push_back(
                {start_block_, first_block_, colour.number, colour.first_item, colour.end_item});
        const std::size_t end =
            i < colour_ ? colour.end_item : (i == colour_ ? next_item_ : colour.first_item);
        if (end > colour.first_item)
            work.push_back({first_block_, end_block_, colour.number, colour.first_item, end});
    }
    return work;
}

int LaunchPlan::samples(int first_block, int end_block) const {
    return std::min(CLR_BLOCK_START(end_block), spp_) - CLR_BLOCK_START(first_block);
}

/// Calls visit(cell, items) for the items [first, end) of a colour, run by run within one cell and
/// one row, until it returns false.
template <typename Visit>
void LaunchPlan::for_each_run(const Colour &colour, std::size_t first, std::size_t end,
                              Visit visit) const {
    const std::size_t step = by_colour_ ? 2 : 1;
    const std::size_t odd_column = by_colour_ ? colour.number & 1 : 0;
    const std::size_t odd_row = by_colour_ ? colour.number >> 1 : 0;
    for (std::size_t item = first; item < end;) {
        const std::size_t in_row = item % colour.columns;
        const std::size_t column = in_row * step + odd_column;
        const std::size_t row = item / colour.columns * step + odd_row;
        const std::size_t to_cell_end = (pace_.end_of_cell(column) - column + step - 1) / step;
        const std::size_t items = std::min({to_cell_end, colour.columns - in_row, end - item});
        if (!visit(pace_.cell_of(column, row), items))
            return;
        item += items;
    }
}

/// Seconds that a sample of all items from `first_item` on is expected to take.
double LaunchPlan::seconds_of(const Colour &colour, std::size_t first_item) const {
    double seconds = 0;
    for_each_run(colour, first_item, colour.end_item, [&](std::size_t cell, std::size_t items) {
        seconds += static_cast<double>(items) * pace_.seconds_in(cell);
        return true;
    });
    return seconds;
}

/// What is left of the colour is cut into equal times.
std::size_t LaunchPlan::items_of_launch(const Colour &colour, int samples) const {
    const std::size_t left = colour.end_item - next_item_;
    if (tile_items_ > 0)
        return std::min(tile_items_, left);
    const double total = seconds_of(colour, next_item_) * samples;
    if (total <= 0)
        return std::min(pace_.least_items(), left);
    const double target = total / std::ceil(total / longest_seconds);

    std::size_t count = 0;
    double seconds = 0;
    bool known = true;
    for_each_run(colour, next_item_, colour.end_item, [&](std::size_t cell, std::size_t items) {
        known = known && pace_.knows(cell);
        const double caution = !known ? unknown_caution : first_block_ == 0 ? first_caution : 1;
        const double wanted = target / caution - seconds;
        if (wanted <= 0)
            return false;
        const double cost = pace_.seconds_in(cell) * samples;
        // Rounded up, so that equal parts do not leave an item for a launch of its own.
        const double most = std::max(std::ceil(wanted / cost - 1e-3), 1.0);
        const std::size_t taken =
            most < static_cast<double>(items) ? static_cast<std::size_t>(most) : items;
        seconds += static_cast<double>(taken) * cost;
        count += taken;
        return taken == items;
    });
    if (!known)
        count = std::min(count,
                         static_cast<std::size_t>(largest_step * pace_.latest_units() / samples));
    return std::min(std::max(count, pace_.least_items()), left);
}

/// Blocks that one launch of all items of the first colour can take; the first pass takes one.
int LaunchPlan::end_of_pass() const {
    if (batch_ > 0)
        return std::min(first_block_ + batch_, blocks_);
    const Colour &colour = colours_[0];
    const double seconds = seconds_of(colour, colour.first_item);
    int end = std::min(first_block_ + 1, blocks_);
    while (seconds > 0 && end < blocks_ && end - first_block_ < most_blocks &&
           seconds * samples(first_block_, end + 1) <= longest_seconds)
        ++end;
    return end;
}

LaunchPlan::Launch LaunchPlan::next() {
    const Colour &colour = colours_[colour_];
    Launch launch{next_item_,    items_of_launch(colour, samples(first_block_, end_block_)),
                  first_block_,  end_block_,
                  colour.number, pass_};
    next_item_ += launch.item_count;
    if (next_item_ == colour.end_item) {
        if (++colour_ == colours_.size()) {
            colour_ = 0;
            launch.ends_pass = true;
            first_block_ = end_block_;
            end_block_ = end_of_pass();
            pass_ = pace_.begin_pass();
        }
        next_item_ = colours_[colour_].first_item;
    }
    return launch;
}

void LaunchPlan::finished(const Launch &launch, double seconds) {
    Colour &colour = *std::find_if(colours_.begin(), colours_.end(),
                                   [&](const Colour &c) { return c.number == launch.colour; });
    const std::size_t end = launch.first_item + launch.item_count;
    std::vector<LaunchPace::Run> runs;
    for_each_run(colour, launch.first_item, end, [&](std::size_t cell, std::size_t items) {
        runs.push_back({cell, items});
        return true;
    });
    pace_.measured(runs, samples_of(launch), seconds, launch.pass);
    if (launch.first_block == 0)
        colour.finished = end;
    if (launch.ends_pass)
        finished_block_ = launch.end_block;
}

double LaunchPlan::seconds_of_first_pass() const {
    double seconds = 0;
    for (const Colour &colour : colours_)
        seconds += seconds_of(colour, colour.first_item);
    return seconds * samples(0, 1);
}

int LaunchPlan::samples_of_all() const {
    return samples(0, finished_block_);
}

bool LaunchPlan::has_samples(std::size_t column, std::size_t row) const {
    for (const Colour &colour : colours_) {
        const bool of_colour = !by_colour_ || ((column & 1) == (colour.number & 1) &&
                                               (row & 1) == (colour.number >> 1));
        if (!of_colour)
            continue;
        const std::size_t item =
            by_colour_ ? row / 2 * colour.columns + column / 2 : row * colour.columns + column;
        return item >= colour.first_item && item < colour.finished;
    }
    return false;
}

} // namespace clrender
