#pragma once
/// Records of first hits, as first_hits.cl leaves them.

#include "shared/config_values.h"
#include "shared/first_hits.h"

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace clrender {

/// The records of rows [first_row, end_row) of a picture.
struct HitStrip {
    std::size_t width = 0; ///< of the picture, pixels
    std::size_t first_row = 0, end_row = 0;
    std::size_t samples = 0; ///< of each pixel
    int aovs = 0;            ///< CLR_AOV_*
    const float *records = nullptr;

    [[nodiscard]] std::size_t runs() const { return (width + CLR_HITS_RUN - 1) / CLR_HITS_RUN; }
    [[nodiscard]] std::size_t stride() const { return CLR_HITS_OF_RUN(samples); }
    [[nodiscard]] std::size_t fields() const {
        return static_cast<std::size_t>(CLR_HIT_FIELDS(aovs));
    }

    /// The values of a field for all samples of a pixel, one after the other.
    [[nodiscard]] const float *values(std::size_t x, std::size_t y, std::size_t field) const {
        const std::size_t run = (y - first_row) * runs() + x / CLR_HITS_RUN;
        return records + (run * fields() + field) * stride() + x % CLR_HITS_RUN * samples;
    }
    /// A whole number among them.
    [[nodiscard]] static std::int32_t whole(float value) {
        std::int32_t result = 0;
        std::memcpy(&result, &value, sizeof(result));
        return result;
    }
};

} // namespace clrender
