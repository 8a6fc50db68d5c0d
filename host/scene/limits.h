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

/// Radiance, intensity and their factors: sums of float32 stay finite.
inline constexpr double max_radiance = 1e30;

/// A reconstruction filter's radius or standard deviation in pixels, and what B and C of Mitchell's
/// may be. Smaller ones have no tables in float32, larger ones no meaning.
inline constexpr double min_filter_size = 1e-3;
inline constexpr double max_filter_size = 1024;
inline constexpr double max_filter_parameter = 100;

/// Without a limit of a path's length, roulette ends paths from this many segments on, so that
/// light that nothing absorbs does not go on for ever. Unbiased, as roulette is.
inline constexpr int max_depth_without_roulette = 4096;

/// Where no depth is stated, roulette is a weight window, which lets all paths on that are not
/// light; from this many segments on it ends some of every path. Unbiased, as roulette is.
inline constexpr int window_end_depth = 32;

} // namespace clrender
