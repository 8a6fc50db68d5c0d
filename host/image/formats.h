#pragma once
/// The file formats behind read_image and write_image. All work on bytes in memory; the readers
/// throw FormatError, to which read_image adds the file's name.

#include "../output_file.h"
#include "../scene/limits.h"
#include "image.h"

#include <cstdint>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace clrender::image_format {

/// What is wrong with the bytes of an image, without the file's name.
class FormatError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

inline constexpr std::uint64_t max_pixels = max_picture_pixels;

/// Throws unless both sizes are positive and there are at most max_pixels, and `bytes` is at
/// least the least number of bytes that so many pixels take: pixels / `max_pixels_per_byte`.
void check_size(std::int64_t width, std::int64_t height, std::uint64_t bytes,
                double max_pixels_per_byte);

/// Claims the memory that decoding takes, `bytes_per_pixel` at its peak. Throws where it is not to
/// be had, before it is taken.
void claim_pixels(int width, int height, std::size_t bytes_per_pixel);

/// Throw if the file ends before its last pixel: the decoder fills what is missing with zeros.
void check_png_complete(std::string_view bytes);
void check_jpeg_complete(std::string_view bytes);
void check_bmp_complete(std::string_view bytes);
void check_tga_complete(std::string_view bytes);

/// Throws if the headers of an EXR file make the library take more memory than the file's length
/// can justify, or if an attribute's size is not what its type has.
void check_exr_header(std::string_view bytes);

/// PNG, JPEG, BMP and TGA, by content. 8 bits stay; 16 bits become f32, from sRGB unless `raw`.
Image decode_8bit(std::string_view bytes, bool raw);
/// Radiance RGBE, run-length encoded or flat, top row first.
Image decode_hdr(std::string_view bytes);
/// Portable float map, both byte orders, times the absolute value of its scale.
Image decode_pfm(std::string_view bytes);
/// OpenEXR: the first part over the data window, in linear sRGB or grey. Adds to `remarks` what
/// else the person should know of the file.
Image decode_exr(std::string_view bytes, std::vector<std::string> &remarks);
/// One layer of it, in the colours that are stored; none where it has no such layer.
std::optional<Image> decode_exr_layer(std::string_view bytes, const std::string &layer);

/// Write `image` to `file`, piece by piece: no copy of a large picture in memory but for its 8-bit
/// values, and for HDR the clamped ones. 8-bit formats: sRGB, clamped, times 2^exposure. `fast`:
/// larger files in a fraction of the time.
void encode_png(const Image &image, double exposure, bool fast, AtomicFile &file);
void encode_jpeg(const Image &image, double exposure, AtomicFile &file);
void encode_hdr(const Image &image, AtomicFile &file);
void encode_pfm(const Image &image, AtomicFile &file);
void encode_exr(const Image &image, const std::map<std::string, std::string> &metadata,
                const std::vector<ImageLayer> &extra_layers, bool fast, AtomicFile &file);

} // namespace clrender::image_format
