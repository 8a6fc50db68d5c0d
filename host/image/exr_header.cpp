/// OpenEXR's headers, read before the library does: it takes the memory that they ask for, and
/// reads attributes by their type where their stated size says otherwise.

#include "formats.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>

namespace clrender::image_format {

namespace {

/// Compressed blocks shrink zeros by about a thousand; below `always_fine` bytes nobody is hurt.
constexpr std::uint64_t max_expansion = 2048;
constexpr std::uint64_t always_fine = std::uint64_t{64} << 20;

/// Bits of the version field (OpenEXR File Layout, "Version Field").
constexpr std::uint32_t flag_deep = 0x800;
constexpr std::uint32_t flag_multipart = 0x1000;

/// What decides how much memory the library takes as soon as it opens a part.
struct Extent {
    std::int64_t width = 0, height = 0;
    std::int64_t tile_width = 0, tile_height = 0; ///< 0: scan lines
    std::uint64_t channels = 0;
    std::size_t compression = 0;
};

std::string_view take(std::string_view &bytes, std::size_t count) {
    if (bytes.size() < count)
        throw FormatError("the file ends within its header (truncated)");
    const std::string_view taken = bytes.substr(0, count);
    bytes.remove_prefix(count);
    return taken;
}

std::string_view take_name(std::string_view &bytes) {
    const std::string_view name = bytes.substr(0, bytes.find('\0'));
    take(bytes, name.size() + 1);
    return name;
}

std::uint32_t take_unsigned(std::string_view &bytes) {
    std::uint32_t value = 0;
    const std::string_view raw = take(bytes, 4);
    for (std::size_t i = 4; i-- > 0;)
        value = value << 8 | static_cast<unsigned char>(raw[i]);
    return value;
}

std::int64_t take_int(std::string_view &bytes) {
    return static_cast<std::int32_t>(take_unsigned(bytes));
}

[[noreturn]] void fail_attribute(std::string_view name) {
    constexpr std::size_t longest = 32;
    std::string shown;
    for (const char c : name.substr(0, longest))
        shown += c >= ' ' && c <= '~' ? c : '?';
    throw FormatError("damaged header (the attribute " + shown +
                      " has a size that its type has not)");
}

/// Per channel: its name, type, flags and samplings; an empty name ends the list.
std::uint64_t count_channels(std::string_view &value) {
    std::uint64_t count = 0;
    while (!take_name(value).empty()) {
        take(value, 16);
        ++count;
    }
    return count;
}

/// Throws unless the value of an attribute is as long as the library will read it.
void check_attribute(std::string_view name, std::string_view type, std::string_view value) {
    static const std::map<std::string_view, std::size_t> sizes = {
        {"box2f", 16},         {"box2i", 16},    {"chromaticities", 32},
        {"compression", 1},    {"double", 8},    {"envmap", 1},
        {"deepImageState", 1}, {"float", 4},     {"int", 4},
        {"keycode", 28},       {"lineOrder", 1}, {"m33d", 72},
        {"m33f", 36},          {"m44d", 128},    {"m44f", 64},
        {"rational", 8},       {"tiledesc", 9},  {"timecode", 8},
        {"v2d", 16},           {"v2f", 8},       {"v2i", 8},
        {"v3d", 24},           {"v3f", 12},      {"v3i", 12}};
    if (const auto fixed = sizes.find(type); fixed != sizes.end()) {
        if (value.size() != fixed->second)
            fail_attribute(name);
    } else if (type == "chlist") {
        (void)count_channels(value);
        if (!value.empty())
            fail_attribute(name);
    } else if (type == "stringvector") {
        while (!value.empty())
            take(value, take_unsigned(value));
    } else if (type == "preview") {
        const std::uint64_t width = take_unsigned(value);
        const std::uint64_t height = take_unsigned(value);
        if (width > value.size() || height > value.size() || 4 * width * height != value.size())
            fail_attribute(name);
    } else if (type == "floatvector" && value.size() % sizeof(float) != 0) {
        fail_attribute(name);
    }
}

/// Reads the attributes of a header: name, type, size, value, up to an empty name.
Extent take_header(std::string_view &bytes) {
    Extent extent;
    for (std::string_view name = take_name(bytes); !name.empty(); name = take_name(bytes)) {
        const std::string_view type = take_name(bytes);
        const std::int64_t size = take_int(bytes);
        if (size < 0)
            throw FormatError("damaged header (an attribute of negative size)");
        std::string_view value = take(bytes, static_cast<std::size_t>(size));
        check_attribute(name, type, value);
        if (name == "dataWindow") {
            const std::int64_t x = take_int(value);
            const std::int64_t y = take_int(value);
            extent.width = take_int(value) - x + 1;
            extent.height = take_int(value) - y + 1;
        } else if (name == "tiles") {
            extent.tile_width = take_int(value);
            extent.tile_height = take_int(value);
            if (extent.tile_width <= 0 || extent.tile_height <= 0)
                throw FormatError("damaged header (a tile without pixels)");
        } else if (name == "compression") {
            extent.compression = static_cast<unsigned char>(take(value, 1)[0]);
        } else if (name == "channels") {
            extent.channels = count_channels(value);
        }
    }
    return extent;
}

/// Rows of a block of scan lines, by compression: none, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A,
/// DWAA, DWAB.
std::uint64_t rows_of_block(std::size_t compression) {
    constexpr std::array<std::uint64_t, 10> rows = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
    if (compression >= rows.size())
        throw FormatError("damaged header (unknown compression)");
    return rows[compression];
}

std::uint64_t divide_up(std::uint64_t value, std::uint64_t unit) {
    return (value + unit - 1) / unit;
}

void check_extent(const Extent &extent, std::uint64_t file_bytes) {
    check_size(extent.width, extent.height, file_bytes, std::numeric_limits<double>::infinity());
    const auto width = static_cast<std::uint64_t>(extent.width);
    const auto height = static_cast<std::uint64_t>(extent.height);
    const auto tile_width = static_cast<std::uint64_t>(extent.tile_width);
    const auto tile_height = static_cast<std::uint64_t>(extent.tile_height);
    const std::uint64_t rows = rows_of_block(extent.compression);

    // The library holds the table of all blocks' places, 8 bytes each, which is in the file; and
    // whole blocks of pixels.
    const bool is_tiled = tile_width > 0;
    const std::uint64_t blocks = is_tiled
                                     ? divide_up(width, tile_width) * divide_up(height, tile_height)
                                     : divide_up(height, rows);
    const std::uint64_t pixels = std::max(width * std::max(height, rows), tile_width * tile_height);
    const std::uint64_t limit = std::max(always_fine, max_expansion * file_bytes);
    if (blocks > file_bytes / 8 ||
        pixels > limit / sizeof(float) / std::max<std::uint64_t>(extent.channels, 1))
        throw FormatError("size " + std::to_string(extent.width) + " x " +
                          std::to_string(extent.height) + " promised, but the file has only " +
                          std::to_string(file_bytes) + " bytes");
}

} // namespace

void check_exr_header(std::string_view bytes) {
    const std::uint64_t file_bytes = bytes.size();
    take(bytes, 4);
    const std::uint32_t version = take_unsigned(bytes);
    if ((version & flag_deep) != 0)
        throw FormatError("deep pixels, expected flat ones");
    check_extent(take_header(bytes), file_bytes);

    // Of several parts the first is read, but the library opens all; an empty header ends them.
    if ((version & flag_multipart) != 0)
        while (!bytes.starts_with('\0'))
            check_extent(take_header(bytes), file_bytes);
}

} // namespace clrender::image_format
