#include "work_done.h"

#include "shared/launch_data.h"

#include <algorithm>

namespace clrender {

namespace {

bool is_empty(const WorkPiece &piece) {
    return piece.first_block >= piece.end_block || piece.first_item >= piece.end_item;
}

WorkPiece common(const WorkPiece &a, const WorkPiece &b) {
    if (a.colour != b.colour)
        return {};
    return {std::max(a.first_block, b.first_block), std::min(a.end_block, b.end_block), a.colour,
            std::max(a.first_item, b.first_item), std::min(a.end_item, b.end_item)};
}

/// Adds what of `piece` is not in `taken` to `rest`.
void add_rest(const WorkPiece &piece, const WorkPiece &taken, Work &rest) {
    const WorkPiece both = common(piece, taken);
    if (is_empty(both)) {
        rest.push_back(piece);
        return;
    }
    const auto add = [&](int first_block, int end_block, std::uint64_t first, std::uint64_t end) {
        const WorkPiece left{first_block, end_block, piece.colour, first, end};
        if (!is_empty(left))
            rest.push_back(left);
    };
    add(piece.first_block, both.first_block, piece.first_item, piece.end_item);
    add(both.first_block, both.end_block, piece.first_item, both.first_item);
    add(both.first_block, both.end_block, both.end_item, piece.end_item);
    add(both.end_block, piece.end_block, piece.first_item, piece.end_item);
}

/// Makes one of two pieces that lie side by side.
bool join(WorkPiece &a, const WorkPiece &b) {
    if (a.colour != b.colour)
        return false;
    if (a.first_item == b.first_item && a.end_item == b.end_item && a.end_block == b.first_block) {
        a.end_block = b.end_block;
        return true;
    }
    if (a.first_block == b.first_block && a.end_block == b.end_block &&
        a.end_item == b.first_item) {
        a.end_item = b.end_item;
        return true;
    }
    return false;
}

} // namespace

Work all_work(const WorkGrid &grid, int first_block, int end_block) {
    Work work;
    if (!grid.by_colour) {
        work.push_back({first_block, end_block, CLR_ALL_TILES, 0, grid.columns * grid.rows});
    } else {
        for (unsigned colour = 0; colour < CLR_TILE_COLOURS; ++colour) {
            const std::uint64_t columns = (grid.columns + 1 - (colour & 1U)) / 2;
            const std::uint64_t rows = (grid.rows + 1 - (colour >> 1U)) / 2;
            work.push_back({first_block, end_block, colour, 0, columns * rows});
        }
    }
    std::erase_if(work, is_empty);
    return work;
}

Work part_of_work(const WorkGrid &grid, int blocks, int part, int parts) {
    Work work;
    for (int block = 0; block < blocks; ++block) {
        if (blocks >= parts && block % parts != part - 1)
            continue;
        for (WorkPiece piece : all_work(grid, block, block + 1)) {
            if (blocks < parts) {
                // Another share in each block: what is dear in a picture lies together.
                const auto share = static_cast<std::uint64_t>((part - 1 + block) % parts);
                const auto shares = static_cast<std::uint64_t>(parts);
                const std::uint64_t items = piece.end_item;
                piece.first_item = items * share / shares;
                piece.end_item = items * (share + 1) / shares;
            }
            if (!is_empty(piece))
                work.push_back(piece);
        }
    }
    return work;
}

Work missing_work(const Work &wanted, const Work &done) {
    Work rest = wanted;
    for (const WorkPiece &taken : done) {
        Work left;
        for (const WorkPiece &piece : rest)
            add_rest(piece, taken, left);
        rest = std::move(left);
    }
    return rest;
}

bool overlap(const Work &a, const Work &b) {
    return std::any_of(a.begin(), a.end(), [&](const WorkPiece &piece) {
        return std::any_of(b.begin(), b.end(),
                           [&](const WorkPiece &other) { return !is_empty(common(piece, other)); });
    });
}

Work joined(Work pieces) {
    for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t i = 0; i < pieces.size(); ++i)
            for (std::size_t k = 0; k < pieces.size(); ++k)
                if (i != k && join(pieces[i], pieces[k])) {
                    pieces.erase(pieces.begin() + static_cast<std::ptrdiff_t>(k));
                    i -= k < i ? 1 : 0;
                    k = 0;
                    changed = true;
                }
    }
    return pieces;
}

} // namespace clrender
