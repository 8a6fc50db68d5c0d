#include "alias_table.h"

#include <numeric>

namespace clrender {

std::vector<AliasEntry> build_alias_table(std::span<const double> weights) {
    const std::size_t count = weights.size();
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    std::vector<double> scaled(count);
    std::vector<uint> small, large;
    for (std::size_t i = 0; i < count; ++i) {
        scaled[i] = weights[i] / total * static_cast<double>(count);
        (scaled[i] < 1 ? small : large).push_back(static_cast<uint>(i));
    }

    // Each small entry is filled up by a large one, which may become small itself.
    std::vector<AliasEntry> table(count);
    while (!small.empty() && !large.empty()) {
        const uint less = small.back();
        const uint more = large.back();
        small.pop_back();
        table[less] = {static_cast<float>(scaled[less]), more};
        scaled[more] -= 1 - scaled[less];
        if (scaled[more] < 1) {
            large.pop_back();
            small.push_back(more);
        }
    }

    // What rounding has left over keeps to itself; an entry of weight 0 never yields itself.
    for (const uint i : large)
        table[i] = {1.0f, i};
    for (const uint i : small)
        table[i] = weights[i] > 0 ? AliasEntry{1.0f, i} : AliasEntry{0.0f, 0};
    return table;
}

} // namespace clrender
