#include "../log.h"
#include "../output_file.h"
#include "color.h"
#include "formats.h"
#include "image.h"

#include <png.h>
#include <stb/stb_image_write.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>

namespace clrender {

namespace image_format {

namespace {

/// A file as a C library's callback sees it: what fails is thrown once the library has returned.
struct CallbackFile {
    AtomicFile &file;
    std::exception_ptr failure;

    bool write(const void *data, std::size_t size) {
        try {
            if (!failure)
                file.write({static_cast<const char *>(data), size});
        } catch (...) {
            failure = std::current_exception();
        }
        return !failure;
    }
    void finish(bool encoded) const {
        if (failure)
            std::rethrow_exception(failure);
        if (!encoded)
            throw FormatError("cannot be encoded");
    }
};

void append(void *target, void *data, int size) {
    static_cast<CallbackFile *>(target)->write(data, static_cast<std::size_t>(size));
}

ssize_t append_cookie(void *target, const char *data, std::size_t size) {
    return static_cast<CallbackFile *>(target)->write(data, size) ? static_cast<ssize_t>(size) : 0;
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
    const auto width = static_cast<std::size_t>(image.width);
    std::vector<std::uint8_t> bytes(image.f32.size() / channels * kept);
    tbb::parallel_for(0, image.height, [&](int row) {
        const std::size_t first = static_cast<std::size_t>(row) * width;
        for (std::size_t i = first; i < first + width; ++i)
            for (std::size_t c = 0; c < kept; ++c) {
                const double value = image.f32[i * channels + c];
                const bool is_alpha = has_alpha && c == channels - 1;
                bytes[i * kept + c] =
                    to_8bit(is_alpha ? value : srgb_encode(std::min(value * factor, 1.0)));
            }
    });
    return bytes;
}

} // namespace

void encode_png(const Image &image, double exposure, bool fast, AtomicFile &file) {
    const auto channels = static_cast<std::size_t>(image.channels);
    const auto pixels = quantise(image, exposure, channels);
    constexpr std::array<png_uint_32, 4> formats = {PNG_FORMAT_GRAY, PNG_FORMAT_GA, PNG_FORMAT_RGB,
                                                    PNG_FORMAT_RGBA};
    png_image png = {};
    png.version = PNG_IMAGE_VERSION;
    png.width = static_cast<png_uint_32>(image.width);
    png.height = static_cast<png_uint_32>(image.height);
    png.format = formats[channels - 1];
    png.flags = fast ? PNG_IMAGE_FLAG_FAST : 0;

    CallbackFile target{file, {}};
    std::FILE *stream = fopencookie(&target, "w", {nullptr, append_cookie, nullptr, nullptr});
    if (stream == nullptr)
        throw std::bad_alloc();
    const bool encoded = png_image_write_to_stdio(&png, stream, 0, pixels.data(), 0, nullptr) != 0;
    const bool closed = std::fclose(stream) == 0;
    target.finish(encoded && closed);
}

void encode_jpeg(const Image &image, double exposure, AtomicFile &file) {
    constexpr int quality = 95;
    const int kept = image.channels <= 2 ? 1 : 3;
    const auto pixels = quantise(image, exposure, static_cast<std::size_t>(kept));
    CallbackFile target{file, {}};
    target.finish(stbi_write_jpg_to_func(append, &target, image.width, image.height, kept,
                                         pixels.data(), quality) != 0);
}

void encode_hdr(const Image &image, AtomicFile &file) {
    // RGBE has no sign, no infinity and ends near 2^127.
    std::vector<float> rgb;
    const auto channels = static_cast<std::size_t>(image.channels);
    rgb.reserve(image.f32.size() / channels * 3);
    for (std::size_t i = 0; i < image.f32.size(); i += channels)
        for (std::size_t c = 0; c < 3; ++c) {
            const float value = image.f32[i + (channels <= 2 ? 0 : c)];
            rgb.push_back(value > 0 ? std::min(value, 1e38F) : 0.0F);
        }
    CallbackFile target{file, {}};
    target.finish(
        stbi_write_hdr_to_func(append, &target, image.width, image.height, 3, rgb.data()) != 0);
}

} // namespace image_format

namespace {

std::string lower_extension(const std::string &path) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

void encode(const std::string &extension, const Image &image, double exposure,
            const std::map<std::string, std::string> &metadata,
            const std::vector<ImageLayer> &extra_layers, bool fast, AtomicFile &file) {
    using namespace image_format;
    if (image.color_space == ColorSpace::xyz && extension != ".exr")
        return encode(extension, in_linear_srgb(image), exposure, metadata, extra_layers, fast,
                      file);
    if (extension == ".png")
        encode_png(image, exposure, fast, file);
    else if (extension == ".jpg" || extension == ".jpeg")
        encode_jpeg(image, exposure, file);
    else if (extension == ".hdr")
        encode_hdr(image, file);
    else if (extension == ".pfm")
        encode_pfm(image, file);
    else
        encode_exr(image, metadata, extra_layers, fast, file);
}

} // namespace

void write_image(const std::string &path, const Image &image, double exposure,
                 const std::map<std::string, std::string> &metadata,
                 const std::vector<ImageLayer> &extra_layers, bool fast) {
    if (!is_writable_image_path(path))
        throw InputError({path, 0}, "unknown extension, expected .png, .jpg, .hdr, .exr or .pfm");
    if (image.type != PixelType::f32 || image.f32.empty())
        throw InputError({path, 0}, "no linear pixels to write");
    const std::string extension = lower_extension(path);
    if (image.color_space == ColorSpace::xyz && (extension == ".hdr" || extension == ".pfm"))
        log::warn({path, 0}, "the XYZ of the film is written as linear sRGB, as only .exr can say "
                             "that it holds XYZ");
    write_encoded_file(path, [&](AtomicFile &file) {
        encode(extension, image, exposure, metadata, extra_layers, fast, file);
    });
}

void try_write_image(const std::string &path, const Image &image, double exposure) {
    try {
        AtomicFile file(path);
        encode(lower_extension(path), image, exposure, {}, {}, false, file);
    } catch (const std::exception &) {
        return;
    }
}

Image middle_rows(const Image &image, int rows) {
    Image part;
    part.width = image.width;
    part.height = std::min(rows, image.height);
    part.channels = image.channels;
    part.color_space = image.color_space;
    const auto row = static_cast<std::ptrdiff_t>(image.width) * image.channels;
    const auto first = image.f32.begin() + row * ((image.height - part.height) / 2);
    part.f32.assign(first, first + row * part.height);
    return part;
}

bool is_writable_image_path(const std::string &path) {
    constexpr std::array<std::string_view, 6> known = {".png", ".jpg", ".jpeg",
                                                       ".hdr", ".exr", ".pfm"};
    return std::find(known.begin(), known.end(), lower_extension(path)) != known.end();
}

} // namespace clrender
