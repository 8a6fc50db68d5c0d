#pragma once
/// The numbers of a glTF file: accessors, with every offset and count checked before it is used.

#include "gltf_document.h"

#include <cstdint>
#include <string>
#include <vector>

namespace clrender::gltf {

/// Elements of `components` numbers each, one after the other.
struct Numbers {
    std::size_t components = 0;
    std::vector<float> values;

    [[nodiscard]] std::size_t count() const { return values.size() / components; }
};

/// The elements of accessor `index`, which have between `least` and `most` components (of a scalar
/// or a vector), normalised integers as the standard says, others as they are. `place` is what
/// names the accessor. Memory is claimed for them. What is not finite is refused, or becomes 0
/// with a warning where `repairs`. Throws InputError.
Numbers read_numbers(const Document &document, int index, int least, int most,
                     const std::string &place, bool repairs = false);

/// The unsigned integers of a scalar accessor, each below `limit`. Throws InputError.
std::vector<std::uint32_t> read_indices(const Document &document, int index, std::size_t limit,
                                        const std::string &place);

/// A normalised integer as a number, by the standard's formulas; `value` as it is where `type` is
/// none of the small integers.
float normalised(double value, int type);

} // namespace clrender::gltf
