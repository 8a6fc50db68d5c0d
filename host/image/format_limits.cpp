/// The largest pictures that the formats, and the libraries that write them, can hold.

#include "image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <limits>

namespace clrender {

namespace {

struct FormatLimit {
    std::int64_t side;  ///< pixels
    std::int64_t bytes; ///< of the buffer that the encoder counts with int
};

constexpr std::int64_t any = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t max_int = std::numeric_limits<std::int32_t>::max();

/// stb_image_write's growing array: 3 * 2^29 - 1 is the last capacity that it can double to.
constexpr std::int64_t max_deflated = (std::int64_t{3} << 29U) - 1;

FormatLimit limit_of(const std::string &extension) {
    if (extension == ".jpg" || extension == ".jpeg")
        return {65535, max_int}; // 16 bits in the frame's header (ISO/IEC 10918-1, B.2.2)
    if (extension == ".png")
        return {max_int, max_deflated}; // 31 bits in the header (PNG, section 11.2.2)
    if (extension == ".hdr")
        return {max_int, max_int};
    return {max_int, any};
}

/// What the encoder holds of the picture at once: rows of PNG begin with a filter's number; .hdr
/// is encoded from floats that it counts, not their bytes.
std::int64_t encoder_bytes(const std::string &extension, std::int64_t width, std::int64_t height,
                           std::int64_t channels) {
    if (extension == ".png")
        return (width * channels + 1) * height;
    return width * height * 3;
}

} // namespace

std::string why_too_large(const std::string &path, int width, int height, int channels) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const FormatLimit limit = limit_of(extension);
    if (std::max(width, height) > limit.side)
        return fmt::format("{} x {} pixels, but {} holds at most {} on a side", width, height,
                           extension, limit.side);
    const std::int64_t bytes = encoder_bytes(extension, width, height, channels);
    if (bytes > limit.bytes)
        return fmt::format("{} x {} pixels take {} bytes, but {} is written with at most {}", width,
                           height, bytes, extension, limit.bytes);
    return {};
}

} // namespace clrender
