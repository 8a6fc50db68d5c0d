#include "hit_table.h"

#include <algorithm>

namespace clrender {

const HitRange &HitTable::range_of(std::uint32_t prim) const {
    const auto next =
        std::upper_bound(ranges.begin(), ranges.end(), prim,
                         [](std::uint32_t p, const HitRange &range) { return p < range.first; });
    return *(next - 1);
}

int HitTable::object_of(std::uint32_t prim, int instance) const {
    return instance >= 0 ? instance_objects[static_cast<std::size_t>(instance)]
                         : range_of(prim).object;
}

} // namespace clrender
