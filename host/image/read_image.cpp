#include "../input_file.h"
#include "../log.h"
#include "formats.h"
#include "image.h"
#include "layers.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <new>

namespace clrender {

namespace {

constexpr std::string_view exr_signature = "\x76\x2f\x31\x01";

Image decode(std::string_view bytes, const std::string &path, bool raw,
             std::vector<std::string> &remarks) {
    using namespace image_format;
    if (bytes.empty())
        throw FormatError("the file is empty, expected an image");
    if (bytes.starts_with(exr_signature))
        return decode_exr(bytes, remarks);
    if (bytes.starts_with("#?"))
        return decode_hdr(bytes);
    if (bytes.size() > 2 && (bytes.starts_with("PF") || bytes.starts_with("Pf")) &&
        std::isspace(static_cast<unsigned char>(bytes[2])) != 0)
        return decode_pfm(bytes);
    if (bytes.starts_with("\x89PNG") || bytes.starts_with("\xFF\xD8") || bytes.starts_with("BM"))
        return decode_8bit(bytes, raw);

    // TGA has no signature.
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension == ".tga")
        return decode_8bit(bytes, raw);
    throw FormatError("unknown format, expected PNG, JPEG, TGA, BMP, HDR, EXR or PFM");
}

} // namespace

Image read_image(const std::string &path, const SourceLocation &referrer, bool raw) {
    return decode_image(read_input_file(path, referrer), path, referrer, raw);
}

Image decode_image(std::string_view bytes, const std::string &name, const SourceLocation &referrer,
                   bool raw) {
    const bool is_named = !referrer.file.empty();
    std::string reason;
    try {
        std::vector<std::string> remarks;
        Image image = decode(bytes, name, raw, remarks);
        for (const std::string &remark : remarks)
            log::warn(is_named ? referrer : SourceLocation{name, 0},
                      is_named ? name + ": " + remark : remark);
        return image;
    } catch (const image_format::FormatError &error) {
        reason = error.what();
    } catch (const std::bad_alloc &) {
        reason = "does not fit into memory";
    }
    if (!is_named)
        throw InputError({name, 0}, reason);
    throw InputError(referrer, name + ": " + reason);
}

std::optional<Image> read_exr_layer(const std::string &path, const std::string &name) {
    const std::string bytes = read_input_file(path, {});
    if (!bytes.starts_with(exr_signature))
        return std::nullopt;
    try {
        return image_format::decode_exr_layer(bytes, name);
    } catch (const image_format::FormatError &error) {
        throw InputError({path, 0}, error.what());
    } catch (const std::bad_alloc &) {
        throw InputError({path, 0}, "does not fit into memory");
    }
}

double srgb_encode(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

double srgb_decode(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

} // namespace clrender
