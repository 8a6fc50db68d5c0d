#include "formats.h"
#include "stb_memory.h"

#include <stb/stb_image.h>

#include <climits>
#include <memory>

namespace clrender::image_format {

namespace {

/// The most pixels that one byte of the file can stand for, checked before decoding; also
/// whether the file is whole.
double check_complete(std::string_view bytes) {
    if (bytes.starts_with("\x89PNG\r\n\x1a\n")) {
        // Deflate expands at most 1032 times; the smallest pixel is one bit.
        check_png_complete(bytes);
        return 1032 * 8;
    }
    if (bytes.starts_with("\xFF\xD8")) {
        // A block of 8 x 8 pixels takes at least one bit of the first scan.
        check_jpeg_complete(bytes);
        return 64 * 8;
    }
    if (bytes.starts_with("BM")) {
        check_bmp_complete(bytes);
        return 8;
    }
    check_tga_complete(bytes);
    return 128;
}

struct StbFree {
    void operator()(void *pixels) const { stbi_image_free(pixels); }
};

[[noreturn]] void fail() {
    const char *reason = stbi_failure_reason();
    throw FormatError(std::string("cannot be decoded (") + (reason ? reason : "unknown") + ")");
}

/// The most that stb_image takes for a sound file of this header: the file's data, what comes out
/// of the inflater, coefficients and planes of whole JPEG blocks, and the pixels, once more with
/// alpha.
std::size_t stb_bytes(const Image &header, bool is_16bit, std::size_t file_bytes) {
    constexpr std::size_t overhead = std::size_t{1} << 20;
    constexpr std::size_t block = 32;
    const std::size_t pixels = (static_cast<std::size_t>(header.width) + block) *
                               (static_cast<std::size_t>(header.height) + block);
    const std::size_t channels = static_cast<std::size_t>(header.channels) + 1;
    return overhead + 2 * file_bytes + pixels * channels * (is_16bit ? 12 : 8);
}

/// 16-bit values: colours are decoded from sRGB, alpha is linear.
void decode_16bit(const stbi_us *pixels, std::size_t count, Image &image) {
    image.type = PixelType::f32;
    image.f32.resize(count);
    const auto channels = static_cast<std::size_t>(image.channels);
    const bool has_alpha = channels == 2 || channels == 4;
    for (std::size_t i = 0; i < count; ++i) {
        const double value = pixels[i] / 65535.0;
        const bool is_alpha = has_alpha && i % channels == channels - 1;
        image.f32[i] = static_cast<float>(is_alpha ? value : srgb_decode(value));
    }
}

} // namespace

Image decode_8bit(std::string_view bytes) {
    if (bytes.size() > INT_MAX)
        throw FormatError("longer than 2 GiB");
    const double max_pixels_per_byte = check_complete(bytes);
    const auto *data = reinterpret_cast<const stbi_uc *>(bytes.data());
    const int length = static_cast<int>(bytes.size());
    Image image;
    if (stbi_info_from_memory(data, length, &image.width, &image.height, &image.channels) == 0)
        fail();
    check_size(image.width, image.height, bytes.size(), max_pixels_per_byte);

    // The header's number of channels is not always the decoded one (palettes).
    int width = 0;
    int height = 0;
    const bool is_16bit = stbi_is_16_bit_from_memory(data, length) != 0;
    claim_pixels(image.width, image.height,
                 (is_16bit ? 8U : 4U) * static_cast<std::size_t>(image.channels));
    const StbMemory memory(stb_bytes(image, is_16bit, bytes.size()));
    std::unique_ptr<void, StbFree> pixels(
        is_16bit ? static_cast<void *>(
                       stbi_load_16_from_memory(data, length, &width, &height, &image.channels, 0))
                 : static_cast<void *>(
                       stbi_load_from_memory(data, length, &width, &height, &image.channels, 0)));
    if (!pixels)
        fail();
    image.width = width;
    image.height = height;
    const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                              static_cast<std::size_t>(image.channels);
    if (is_16bit) {
        decode_16bit(static_cast<const stbi_us *>(pixels.get()), count, image);
    } else {
        const auto *first = static_cast<const stbi_uc *>(pixels.get());
        image.type = PixelType::u8;
        image.u8.assign(first, first + count);
    }
    return image;
}

} // namespace clrender::image_format
