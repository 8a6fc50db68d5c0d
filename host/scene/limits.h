#pragma once
/// The largest numbers that an option or a file may state. What counts samples, pixels or bytes of
/// a picture stays within its type up to these.

#include <cstdint>

namespace clrender {

/// Samples of a pixel: up to here block boundaries and sample numbers fit 32 bits with a sign.
inline constexpr int max_sample_count = 1 << 30;

/// Pixels of a picture.
inline constexpr int max_picture_side = 65536;
inline constexpr std::int64_t max_picture_pixels = std::int64_t{1} << 28;

} // namespace clrender
