#include "gltf_images.h"

#include "../memory_limit.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace clrender::gltf {

namespace {

std::size_t pixels_of(const Image &image) {
    return static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
}

/// A picture of the same size.
Image like(const Image &image, int channels, PixelType type) {
    Image other;
    other.width = image.width;
    other.height = image.height;
    other.channels = channels;
    other.type = type;
    return other;
}

/// The last channel of `image`, as values from 0 to 1 or bytes.
template <typename T>
std::vector<T> last_channel(const std::vector<T> &values, std::size_t stride) {
    std::vector<T> channel;
    channel.reserve(values.size() / stride);
    for (std::size_t i = stride - 1; i < values.size(); i += stride)
        channel.push_back(values[i]);
    return channel;
}

} // namespace

int Images::source_of(int texture) const {
    const std::string place = place_of("textures", texture);
    const int source =
        element(document_, document_.model.textures, texture, "texture", place).source;
    if (source >= 0)
        (void)element(document_, document_.images, source, "image", place);
    return source;
}

void Images::want(const TextureUse &use, bool raw) {
    if (!use.is_there())
        return;
    const int source = source_of(use.texture);
    if (source < 0) {
        document_.warn(place_of("textures", use.texture),
                       "has no PNG or JPEG picture, a plain colour is used");
        return;
    }
    std::shared_ptr<const Image> &image = images_[{source, raw}];
    if (image)
        return;
    const ImageSource &from = document_.images[static_cast<std::size_t>(source)];
    const std::string place = place_of("images", source);
    const SourceLocation where{document_.path, 0};
    const ImageUse how{.raw = raw, .is_optional = true};
    if (!from.file.empty())
        image = files_.image(from.file, where, how);
    else if (from.buffer_view >= 0)
        image = files_.image_in_memory(document_.view(from.buffer_view, place), place, where, how);
    else
        image = files_.image_in_memory(from.data, place, where, how);
}

void Images::want(const Material &material) {
    want(material.base_texture, false);
    want(material.emission_texture, false);
    for (const TextureUse &use : {material.metallic_roughness, material.normal,
                                  material.transmission_texture, material.clearcoat_texture})
        want(use, true);
}

std::shared_ptr<const Image> Images::get(int texture, bool raw) const {
    const auto found = images_.find({source_of(texture), raw});
    return found == images_.end() || found->second->width == 0 ? nullptr : found->second;
}

void Images::claim(const Image &image, std::size_t bytes_per_pixel) const {
    if (const std::string reason = claim_memory(pixels_of(image) * bytes_per_pixel);
        !reason.empty())
        throw document_.error("", "a picture made of another " + reason);
}

std::shared_ptr<const Image> Images::alpha(int texture) {
    const int source = source_of(texture);
    if (const auto known = alphas_.find(source); known != alphas_.end())
        return known->second;
    std::shared_ptr<const Image> &alpha = alphas_[source];
    const std::shared_ptr<const Image> image = get(texture, false);
    if (!image || image->channels % 2 != 0)
        return alpha;
    claim(*image, image->type == PixelType::u8 ? 1 : sizeof(float));
    Image grey = like(*image, 1, image->type);
    const auto stride = static_cast<std::size_t>(image->channels);
    grey.u8 = last_channel(image->u8, stride);
    grey.f32 = last_channel(image->f32, stride);
    const bool is_opaque =
        std::all_of(grey.u8.begin(), grey.u8.end(), [](std::uint8_t a) { return a == 255; }) &&
        std::all_of(grey.f32.begin(), grey.f32.end(), [](float a) { return a >= 1; });
    if (!is_opaque)
        alpha = std::make_shared<const Image>(std::move(grey));
    return alpha;
}

std::shared_ptr<const Image> Images::normals(int texture, double scale, bool flips) {
    std::shared_ptr<const Image> image = get(texture, true);
    if (!image || (scale == 1 && !flips))
        return image;
    std::shared_ptr<const Image> &normals = normals_[{source_of(texture), scale, flips}];
    if (normals)
        return normals;
    const bool keeps_bytes = image->type == PixelType::u8 && scale == 1;
    claim(*image, keeps_bytes ? 3 : 3 * sizeof(float));
    Image changed = like(*image, 3, keeps_bytes ? PixelType::u8 : PixelType::f32);
    const std::size_t count = pixels_of(*image);
    for (std::size_t i = 0; i < count; ++i) {
        const glm::dvec3 n = 2.0 * texel_color(*image, i, {.raw = true}) - 1.0;
        const glm::dvec3 scaled(n.x * scale, n.y * (flips ? -scale : scale), n.z);
        for (int c = 0; c < 3; ++c)
            if (keeps_bytes)
                changed.u8.push_back(
                    static_cast<std::uint8_t>(std::lround(255 * (0.5 * scaled[c] + 0.5))));
            else
                changed.f32.push_back(static_cast<float>(0.5 * scaled[c] + 0.5));
    }
    normals = std::make_shared<const Image>(std::move(changed));
    return normals;
}

} // namespace clrender::gltf
