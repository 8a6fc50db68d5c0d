/// Portable float maps: a line PF (RGB) or Pf (grey), a line with the size, a line with a scale
/// whose sign gives the byte order, then floats, the bottom row first.

#include "formats.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

namespace clrender::image_format {

namespace {

std::string_view next_word(std::string_view bytes, std::size_t &offset) {
    constexpr std::string_view blanks = " \t\r\n";
    const std::size_t begin = std::min(bytes.find_first_not_of(blanks, offset), bytes.size());
    const std::size_t end = bytes.find_first_of(blanks, begin);
    if (end == std::string_view::npos || end - begin > 64)
        throw FormatError("bad header, expected: PF WIDTH HEIGHT SCALE");
    offset = end;
    return bytes.substr(begin, end - begin);
}

template <class T> T parse(std::string_view word) {
    T value{};
    const auto [next, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || next != word.data() + word.size())
        throw FormatError("bad number in the header, expected: PF WIDTH HEIGHT SCALE");
    return value;
}

float load_float(const char *bytes, bool swap) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, bytes, sizeof bits);
    return std::bit_cast<float>(swap ? __builtin_bswap32(bits) : bits);
}

} // namespace

Image decode_pfm(std::string_view bytes) {
    std::size_t offset = 0;
    Image image;
    image.channels = next_word(bytes, offset) == "PF" ? 3 : 1;
    image.width = parse<int>(next_word(bytes, offset));
    image.height = parse<int>(next_word(bytes, offset));
    const double scale = parse<double>(next_word(bytes, offset));
    if (scale == 0 || !(std::abs(scale) <= std::numeric_limits<float>::max()))
        throw FormatError("scale in the header is not a finite number other than 0");
    ++offset;
    check_size(image.width, image.height, bytes.size(), 1);

    const auto height = static_cast<std::size_t>(image.height);
    const std::size_t row =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.channels);
    if (offset > bytes.size() || (bytes.size() - offset) / 4 < row * height)
        throw FormatError("the file ends before its last pixel (truncated)");
    claim_pixels(image.width, image.height,
                 sizeof(float) * static_cast<std::size_t>(image.channels));

    const bool swap = (scale < 0) != (std::endian::native == std::endian::little);
    const auto factor = static_cast<float>(std::abs(scale));
    image.f32.reserve(row * height);
    for (std::size_t y = height; y-- > 0;)
        for (std::size_t i = 0; i < row; ++i)
            image.f32.push_back(factor *
                                load_float(bytes.data() + offset + 4 * (y * row + i), swap));
    return image;
}

void encode_pfm(const Image &image, AtomicFile &file) {
    // Alpha has no place in the format.
    const bool is_grey = image.channels <= 2;
    const auto channels = static_cast<std::size_t>(image.channels);
    const std::size_t kept = is_grey ? 1 : 3;
    const auto width = static_cast<std::size_t>(image.width);
    file.write(std::string(is_grey ? "Pf" : "PF") + "\n" + std::to_string(image.width) + " " +
               std::to_string(image.height) + "\n" +
               (std::endian::native == std::endian::little ? "-1.0" : "1.0") + "\n");
    std::vector<float> row;
    for (auto y = static_cast<std::size_t>(image.height); y-- > 0;) {
        row.clear();
        for (std::size_t x = 0; x < width; ++x)
            for (std::size_t c = 0; c < kept; ++c)
                row.push_back(image.f32[(y * width + x) * channels + c]);
        file.write({reinterpret_cast<const char *>(row.data()), row.size() * sizeof(float)});
    }
}

} // namespace clrender::image_format
