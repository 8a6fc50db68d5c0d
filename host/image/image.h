#pragma once
/// A picture in memory and the one pair of functions that reads and writes the file formats.

#include "../error.h"

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace clrender {

/// Pixels of the files with 8 bits a channel stay 8 bits (four times less memory for textures).
enum class PixelType { u8, f32 };

/// What the three colours of a linear picture are.
enum class ColorSpace { srgb, xyz };

/// `width * height * channels` values, row-major, the top row first, channels interleaved.
/// `channels` is 1 (grey), 2 (grey, alpha), 3 (RGB) or 4 (RGB, alpha). Exactly one of `u8` and
/// `f32` holds data, as `type` says. u8 data are as stored in the file (sRGB-encoded unless the
/// user declares them raw); f32 data are linear.
struct Image {
    int width = 0;
    int height = 0;
    int channels = 0;
    PixelType type = PixelType::f32;
    ColorSpace color_space = ColorSpace::srgb; ///< f32; what is read is always linear sRGB
    bool is_converted = false; ///< from other primaries: colours outside of sRGB are negative
    std::vector<std::uint8_t> u8;
    std::vector<float> f32;
};

/// Reads .png .jpg .jpeg .tga .bmp .hdr .exr .pfm (by content where the format has a signature,
/// else by extension). 16-bit PNGs become f32, decoded from sRGB unless `raw`. EXR: see
/// exr_channels.h; colours of other primaries become linear sRGB; warns of layers that are left
/// out. The header is checked against the length of the file before anything is allocated; at most
/// 2^28 pixels. Throws InputError with `referrer`'s place in front of what is wrong with the file
/// if `referrer` has a file name, else with the image's own name.
Image read_image(const std::string &path, const SourceLocation &referrer = {}, bool raw = false);

/// The same of `bytes` in memory, which `name` says where they are from.
Image decode_image(std::string_view bytes, const std::string &name,
                   const SourceLocation &referrer = {}, bool raw = false);

/// One named 32-bit float plane set of an EXR file: `name` is "" for the main layer (channels
/// R G B [A], X Y Z [A] or Y [A]), else the layer prefix ("variance" gives variance.R ...).
struct ImageLayer {
    std::string name;
    const Image *image = nullptr;        ///< f32, all layers of the same size
    std::vector<std::string> channels{}; ///< their whole names, where they are others
};

/// Writes `image` (linear f32) by the extension of `path`: .png .jpg (sRGB, clamped, multiplied by
/// 2^exposure), .hdr .pfm (RGB) .exr (32-bit float, all channels, `metadata` as string attributes,
/// `extra_layers` as further channels). XYZ stays so in .exr only. `fast`: .png and .exr take a
/// fraction of the time and more space. Written as write_output_file() does. Throws InputError for
/// an unknown extension or a picture without pixels, else OutputError.
void write_image(const std::string &path, const Image &image, double exposure = 0,
                 const std::map<std::string, std::string> &metadata = {},
                 const std::vector<ImageLayer> &extra_layers = {}, bool fast = false);

/// Encodes as write_image() does and leaves no file: for the time it takes. What fails then fails
/// when the picture is written.
void try_write_image(const std::string &path, const Image &image, double exposure = 0);

/// So many rows of a picture of floats, from its middle; all where it has no more.
Image middle_rows(const Image &image, int rows);

/// True if `write_image` knows the extension of `path`.
bool is_writable_image_path(const std::string &path);

/// Why a picture of this size cannot be written in the format of `path`, or "". `channels` are the
/// picture's.
std::string why_too_large(const std::string &path, int width, int height, int channels);

/// The IEC 61966-2-1 transfer function and its inverse, on [0, 1].
double srgb_encode(double linear);
double srgb_decode(double encoded);

} // namespace clrender
