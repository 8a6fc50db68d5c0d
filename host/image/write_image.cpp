#include "../output_file.h"
#include "formats.h"
#include "image.h"

#include <stb/stb_image_write.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

namespace clrender {

namespace image_format {

namespace {

void append(void *target, void *data, int size) {
    static_cast<std::string *>(target)->append(static_cast<const char *>(data),
                                               static_cast<std::size_t>(size));
}

std::uint8_t to_8bit(double value) {
    // The negated comparison sends NaN to black.
    if (!(value > 0))
        return 0;
    return static_cast<std::uint8_t>(std::lround(255 * std::min(value, 1.0)));
}

/// 8-bit sRGB values of the first `kept` channels; alpha stays linear and unexposed.
std::vector<std::uint8_t> quantise(const Image &image, double exposure, std::size_t kept) {
    const double factor = std::exp2(exposure);
    const auto channels = static_cast<std::size_t>(image.channels);
    const bool has_alpha = channels == 2 || channels == 4;
    std::vector<std::uint8_t> bytes;
    bytes.reserve(image.f32.size() / channels * kept);
    for (std::size_t i = 0; i < image.f32.size(); i += channels) {
        for (std::size_t c = 0; c < kept; ++c) {
            const double value = image.f32[i + c];
            const bool is_alpha = has_alpha && c == channels - 1;
            bytes.push_back(to_8bit(is_alpha ? value : srgb_encode(std::min(value * factor, 1.0))));
        }
    }
    return bytes;
}

} // namespace

std::string encode_png(const Image &image, double exposure) {
    const auto channels = static_cast<std::size_t>(image.channels);
    const auto pixels = quantise(image, exposure, channels);
    std::string bytes;
    if (stbi_write_png_to_func(append, &bytes, image.width, image.height, image.channels,
                               pixels.data(), image.width * image.channels) == 0)
        throw FormatError("cannot be encoded");
    return bytes;
}

std::string encode_jpeg(const Image &image, double exposure) {
    constexpr int quality = 95;
    const int kept = image.channels <= 2 ? 1 : 3;
    const auto pixels = quantise(image, exposure, static_cast<std::size_t>(kept));
    std::string bytes;
    if (stbi_write_jpg_to_func(append, &bytes, image.width, image.height, kept, pixels.data(),
                               quality) == 0)
        throw FormatError("cannot be encoded");
    return bytes;
}

std::string encode_hdr(const Image &image) {
    // RGBE has no sign, no infinity and ends near 2^127.
    std::vector<float> rgb;
    const auto channels = static_cast<std::size_t>(image.channels);
    rgb.reserve(image.f32.size() / channels * 3);
    for (std::size_t i = 0; i < image.f32.size(); i += channels)
        for (std::size_t c = 0; c < 3; ++c) {
            const float value = image.f32[i + (channels <= 2 ? 0 : c)];
            rgb.push_back(value > 0 ? std::min(value, 1e38F) : 0.0F);
        }
    std::string bytes;
    if (stbi_write_hdr_to_func(append, &bytes, image.width, image.height, 3, rgb.data()) == 0)
        throw FormatError("cannot be encoded");
    return bytes;
}

} // namespace image_format

namespace {

std::string lower_extension(const std::string &path) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

std::string encode(const std::string &extension, const Image &image, double exposure,
                   const std::map<std::string, std::string> &metadata,
                   const std::vector<ImageLayer> &extra_layers) {
    using namespace image_format;
    if (extension == ".png")
        return encode_png(image, exposure);
    if (extension == ".jpg" || extension == ".jpeg")
        return encode_jpeg(image, exposure);
    if (extension == ".hdr")
        return encode_hdr(image);
    if (extension == ".pfm")
        return encode_pfm(image);
    return encode_exr(image, metadata, extra_layers);
}

} // namespace

void write_image(const std::string &path, const Image &image, double exposure,
                 const std::map<std::string, std::string> &metadata,
                 const std::vector<ImageLayer> &extra_layers) {
    if (!is_writable_image_path(path))
        throw InputError({path, 0}, "unknown extension, expected .png, .jpg, .hdr, .exr or .pfm");
    if (image.type != PixelType::f32 || image.f32.empty())
        throw InputError({path, 0}, "no linear pixels to write");
    std::string bytes;
    try {
        bytes = encode(lower_extension(path), image, exposure, metadata, extra_layers);
    } catch (const std::exception &error) {
        throw OutputError(path, std::string("cannot be encoded (") + error.what() + ")");
    }
    write_output_file(path, bytes);
}

bool is_writable_image_path(const std::string &path) {
    constexpr std::array<std::string_view, 6> known = {".png", ".jpg", ".jpeg",
                                                       ".hdr", ".exr", ".pfm"};
    return std::find(known.begin(), known.end(), lower_extension(path)) != known.end();
}

} // namespace clrender
