/// Whether an image file is whole. stb_image fills what is missing in a truncated file with zeros
/// and calls it an image; here it is an error.

#include "../memory_limit.h"
#include "formats.h"

#include <fmt/format.h>

namespace clrender::image_format {

namespace {

constexpr const char *truncated = "the file ends before its last pixel (truncated)";

std::uint64_t byte_at(std::string_view bytes, std::uint64_t i) {
    if (i >= bytes.size())
        throw FormatError(truncated);
    return static_cast<unsigned char>(bytes[i]);
}

std::uint64_t little_endian(std::string_view bytes, std::uint64_t offset, int count) {
    std::uint64_t value = 0;
    for (int i = count - 1; i >= 0; --i)
        value = value << 8 | byte_at(bytes, offset + static_cast<std::uint64_t>(i));
    return value;
}

std::uint64_t big_endian_32(std::string_view bytes, std::uint64_t offset) {
    std::uint64_t value = 0;
    for (std::uint64_t i = 0; i < 4; ++i)
        value = value << 8 | byte_at(bytes, offset + i);
    return value;
}

} // namespace

void check_size(std::int64_t width, std::int64_t height, std::uint64_t bytes,
                double max_pixels_per_byte) {
    if (width <= 0 || height <= 0)
        throw FormatError(fmt::format("size {} x {}, expected at least 1 x 1", width, height));
    const auto w = static_cast<std::uint64_t>(width);
    const auto h = static_cast<std::uint64_t>(height);
    if (w > max_pixels || h > max_pixels || w * h > max_pixels)
        throw FormatError(fmt::format("size {} x {}, expected at most 2^28 pixels", w, h));
    if (static_cast<double>(w * h) > max_pixels_per_byte * static_cast<double>(bytes))
        throw FormatError(
            fmt::format("size {} x {} promised, but the file has only {} bytes", w, h, bytes));
}

void claim_pixels(int width, int height, std::size_t bytes_per_pixel) {
    const std::string reason = claim_memory(static_cast<std::uint64_t>(width) *
                                            static_cast<std::uint64_t>(height) * bytes_per_pixel);
    if (!reason.empty())
        throw FormatError(fmt::format("size {} x {} {}", width, height, reason));
}

void check_png_complete(std::string_view bytes) {
    // Chunks of length, type, data and checksum, the last one of type IEND.
    std::uint64_t offset = 8;
    while (true) {
        const std::uint64_t length = big_endian_32(bytes, offset);
        (void)byte_at(bytes, offset + length + 11);
        if (bytes.substr(offset + 4, 4) == "IEND")
            return;
        offset += length + 12;
    }
}

namespace {

std::uint64_t big_endian_16(std::string_view bytes, std::uint64_t offset) {
    return byte_at(bytes, offset) << 8 | byte_at(bytes, offset + 1);
}

/// Moves `offset` behind the next JPEG marker and returns its code.
std::uint64_t next_marker(std::string_view bytes, std::uint64_t &offset) {
    while (byte_at(bytes, offset) != 0xFF)
        ++offset;
    while (byte_at(bytes, offset) == 0xFF)
        ++offset;
    return byte_at(bytes, offset++);
}

bool is_restart(std::uint64_t marker) {
    return marker >= 0xD0 && marker <= 0xD7;
}

/// A segment of Huffman tables: stb_image writes beyond its own if one has more than 256 codes.
void check_huffman_tables(std::string_view segment) {
    constexpr std::size_t header = 17; // which table, then the number of codes of each length
    while (!segment.empty()) {
        std::size_t codes = 0;
        for (std::size_t i = 1; i < header; ++i)
            codes += byte_at(segment, i);
        if (codes > 256 || segment.size() < header + codes)
            throw FormatError("damaged JPEG (bad Huffman table)");
        segment.remove_prefix(header + codes);
    }
}

} // namespace

void check_jpeg_complete(std::string_view bytes) {
    constexpr std::uint64_t huffman_tables = 0xC4;
    constexpr std::uint64_t end = 0xD9;
    constexpr std::uint64_t scan = 0xDA;
    // Few bytes can go over all pixels once more; a progressive file of libjpeg does so ten times.
    constexpr int most_scans = 100;
    int scans = 0;
    std::uint64_t offset = 2;
    for (auto marker = next_marker(bytes, offset); marker != end;
         marker = next_marker(bytes, offset)) {
        // Segments start with their length, which counts itself.
        if (marker < 0xC0 || is_restart(marker) || marker == 0xD8)
            throw FormatError("damaged JPEG (bad marker)");
        const std::uint64_t length = big_endian_16(bytes, offset);
        if (length < 2)
            throw FormatError("damaged JPEG (bad length)");
        (void)byte_at(bytes, offset + length - 1);
        if (marker == huffman_tables)
            check_huffman_tables(bytes.substr(offset + 2, length - 2));
        offset += length;

        // Coded data follow a scan's header; in them, FF 00 stands for FF, and restarts may occur.
        if (marker != scan)
            continue;
        if (++scans > most_scans)
            throw FormatError(fmt::format("more than {} scans, expected fewer", most_scans));
        std::uint64_t behind = offset;
        for (auto code = next_marker(bytes, behind); code == 0 || is_restart(code);
             code = next_marker(bytes, behind))
            offset = behind;
    }
}

void check_bmp_complete(std::string_view bytes) {
    // Rows are padded to 4 bytes; a negative height means the top row first.
    const std::uint64_t data_offset = little_endian(bytes, 10, 4);
    const bool is_core_header = little_endian(bytes, 14, 4) == 12;
    const auto signed_32 = [&](std::uint64_t offset) -> std::int64_t {
        return static_cast<std::int32_t>(little_endian(bytes, offset, 4));
    };
    const std::int64_t width =
        is_core_header ? static_cast<std::int64_t>(little_endian(bytes, 18, 2)) : signed_32(18);
    const std::int64_t height = is_core_header
                                    ? static_cast<std::int64_t>(little_endian(bytes, 20, 2))
                                    : std::abs(signed_32(22));
    check_size(width, height, bytes.size(), 8);
    const std::uint64_t bits = little_endian(bytes, is_core_header ? 24 : 28, 2);
    const std::uint64_t row = (static_cast<std::uint64_t>(width) * bits + 31) / 32 * 4;
    (void)byte_at(bytes, data_offset + row * static_cast<std::uint64_t>(height) - 1);
}

void check_tga_complete(std::string_view bytes) {
    // Header, name, palette, then pixels: as they are (types 1 to 3), or in packets (9 to 11).
    const std::uint64_t type = byte_at(bytes, 2);
    const bool is_packed = type >= 9 && type <= 11;
    if (!is_packed && (type < 1 || type > 3))
        throw FormatError("unknown format, expected PNG, JPEG, TGA, BMP, HDR, EXR or PFM");
    const std::uint64_t palette_bits =
        byte_at(bytes, 1) != 0 ? little_endian(bytes, 5, 2) * ((byte_at(bytes, 7) + 7) / 8) : 0;
    std::uint64_t offset = 18 + byte_at(bytes, 0) + palette_bits;
    const std::uint64_t width = little_endian(bytes, 12, 2);
    const std::uint64_t height = little_endian(bytes, 14, 2);
    const std::uint64_t pixel_size = (byte_at(bytes, 16) + 7) / 8;
    check_size(static_cast<std::int64_t>(width), static_cast<std::int64_t>(height), bytes.size(),
               is_packed ? 128 : 1);
    if (!is_packed) {
        (void)byte_at(bytes, offset + width * height * pixel_size - 1);
        return;
    }

    // A packet is one pixel repeated, or that many pixels.
    for (std::uint64_t done = 0; done < width * height;) {
        const std::uint64_t packet = byte_at(bytes, offset);
        const std::uint64_t count = (packet & 127) + 1;
        const std::uint64_t size = packet >= 128 ? pixel_size : count * pixel_size;
        (void)byte_at(bytes, offset + size);
        offset += 1 + size;
        done += count;
    }
}

} // namespace clrender::image_format
