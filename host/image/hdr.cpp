/// Radiance's RGBE: three mantissas and a shared exponent (Ward 1991, "Real Pixels").

#include "formats.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>

namespace clrender::image_format {

namespace {

using Rgbe = std::array<unsigned char, 4>;

class HdrReader {
public:
    explicit HdrReader(std::string_view bytes) : bytes_(bytes) {}

    Image read();

private:
    std::string_view next_line();
    unsigned char next_byte();
    void read_header(Image &image);
    void read_row(std::vector<Rgbe> &row);
    void read_flat_row(std::vector<Rgbe> &row, Rgbe first);

    std::string_view bytes_;
    std::size_t offset_ = 0;
};

std::string_view HdrReader::next_line() {
    const std::size_t end = bytes_.find('\n', offset_);
    if (end == std::string_view::npos || end - offset_ > 4096)
        throw FormatError("the header does not end");
    const std::string_view line = bytes_.substr(offset_, end - offset_);
    offset_ = end + 1;
    return line.ends_with('\r') ? line.substr(0, line.size() - 1) : line;
}

unsigned char HdrReader::next_byte() {
    if (offset_ >= bytes_.size())
        throw FormatError("the file ends before its last pixel (truncated)");
    return static_cast<unsigned char>(bytes_[offset_++]);
}

void HdrReader::read_header(Image &image) {
    // Lines of text up to an empty one; then the size.
    (void)next_line();
    for (std::string_view line = next_line(); !line.empty(); line = next_line())
        if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe")
            throw FormatError("pixel format other than 32-bit_rle_rgbe");
    const std::string_view size = next_line();
    const std::size_t x = size.find(" +X ");
    const auto number = [](std::string_view text, int &value) {
        const auto [next, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        return error == std::errc() && next == text.data() + text.size();
    };
    if (!size.starts_with("-Y ") || x == std::string_view::npos ||
        !number(size.substr(3, x - 3), image.height) || !number(size.substr(x + 4), image.width))
        throw FormatError("bad size in the header, expected: -Y HEIGHT +X WIDTH");

    // The longest run covers 127 values of one of four channels with two bytes.
    check_size(image.width, image.height, bytes_.size() - offset_, 127.0 / 8);
    claim_pixels(image.width, image.height, 3 * sizeof(float));
}

void HdrReader::read_row(std::vector<Rgbe> &row) {
    Rgbe first;
    for (unsigned char &byte : first)
        byte = next_byte();
    const bool can_be_packed = row.size() >= 8 && row.size() < 32768;
    if (!can_be_packed || first[0] != 2 || first[1] != 2 || first[2] >= 128) {
        read_flat_row(row, first);
        return;
    }
    if (static_cast<std::size_t>(first[2] * 256 + first[3]) != row.size())
        throw FormatError("a row's length differs from the width");

    // Each channel on its own, in runs (length + 128, value) and literal stretches.
    for (std::size_t channel = 0; channel < 4; ++channel) {
        for (std::size_t i = 0; i < row.size();) {
            const unsigned char code = next_byte();
            const bool is_run = code > 128;
            const std::size_t count = is_run ? code - 128U : code;
            if (count == 0 || count > row.size() - i)
                throw FormatError("a run is longer than its row");
            unsigned char value = is_run ? next_byte() : 0;
            for (std::size_t n = 0; n < count; ++n, ++i) {
                if (!is_run)
                    value = next_byte();
                row[i][channel] = value;
            }
        }
    }
}

void HdrReader::read_flat_row(std::vector<Rgbe> &row, Rgbe first) {
    // Old files repeat the last pixel with mantissas (1, 1, 1) and the count as exponent.
    unsigned shift = 0;
    Rgbe pixel = first;
    for (std::size_t i = 0; i < row.size();) {
        if (pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1) {
            const std::size_t count = shift < 32 ? std::size_t{pixel[3]} << shift : row.size() + 1;
            if (i == 0 || count > row.size() - i)
                throw FormatError("a run is longer than its row");
            for (std::size_t n = 0; n < count; ++n, ++i)
                row[i] = row[i - 1];
            shift += 8;
        } else {
            row[i++] = pixel;
            shift = 0;
        }
        if (i < row.size())
            for (unsigned char &byte : pixel)
                byte = next_byte();
    }
}

Image HdrReader::read() {
    Image image;
    read_header(image);
    image.channels = 3;
    const auto width = static_cast<std::size_t>(image.width);
    const auto height = static_cast<std::size_t>(image.height);
    image.f32.reserve(width * height * 3);
    std::vector<Rgbe> row(width);
    for (std::size_t y = 0; y < height; ++y) {
        read_row(row);
        for (const Rgbe &pixel : row) {
            const float scale = pixel[3] != 0 ? std::ldexp(1.0F, pixel[3] - 136) : 0.0F;
            for (std::size_t channel = 0; channel < 3; ++channel)
                image.f32.push_back(static_cast<float>(pixel[channel]) * scale);
        }
    }
    return image;
}

} // namespace

Image decode_hdr(std::string_view bytes) {
    return HdrReader(bytes).read();
}

} // namespace clrender::image_format
