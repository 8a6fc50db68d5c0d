#include "flatten_parts.h"

#include <cmath>

namespace clrender::inline CLR_PRECISION {

namespace {

/// Byte `channel` of pixel `at`, grey images giving the same for all.
uint byte_of(const Image &image, std::size_t at, int channel) {
    const int channels = image.channels;
    const int source = channels >= 3 ? channel : 0;
    return image.u8[at * static_cast<std::size_t>(channels) + static_cast<std::size_t>(source)];
}

/// Appends the pixels of an image; returns its offset. Bytes are decoded on the device.
uint append_texels(const Image &image, TexelFormat format, FlatScene &flat) {
    const auto count =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    if (image.type == PixelType::u8) {
        const auto offset = static_cast<uint>(flat.texels_u8.size());
        flat.texels_u8.reserve(flat.texels_u8.size() + count);
        for (std::size_t i = 0; i < count; ++i)
            flat.texels_u8.push_back(byte_of(image, i, 0) | byte_of(image, i, 1) << 8 |
                                     byte_of(image, i, 2) << 16);
        return offset;
    }
    const auto offset = static_cast<uint>(flat.texels_f32.size() / 3);
    flat.texels_f32.reserve(flat.texels_f32.size() + 3 * count);
    for (std::size_t i = 0; i < count; ++i) {
        const Rgb color = texel_color(image, i, format);
        for (int c = 0; c < 3; ++c)
            flat.texels_f32.push_back(static_cast<clr_real>(color[c]));
    }
    return offset;
}

/// The offset of the texels that an earlier texture has appended, or of new ones.
uint offset_of_image(const Texture &texture, Flattening &work) {
    for (const auto &[other, index] : work.texture_index) {
        const Texture &before = work.scene.textures[static_cast<std::size_t>(other)];
        if (before.kind == TextureKind::bitmap && before.bitmap == texture.bitmap &&
            (before.bitmap->type == PixelType::u8 || before.format.half == texture.format.half))
            return work.flat.textures[index].offset;
    }
    return append_texels(*texture.bitmap, texture.format, work.flat);
}

uint wrap_of(TextureWrap wrap) {
    return wrap == TextureWrap::repeat   ? CLR_WRAP_REPEAT
           : wrap == TextureWrap::mirror ? CLR_WRAP_MIRROR
                                         : CLR_WRAP_CLAMP;
}

/// What becomes of the value of a bitmap or an attribute.
void describe_factors(const Texture &source, const Flattening &work, TextureInfo &t) {
    const auto number_of = [&](const std::string &attribute) {
        return attribute.empty() ? CLR_NONE : work.attribute_index.at(attribute);
    };
    store(t.color0, source.scale);
    t.attributes = static_cast<uint>(work.attribute_index.size());
    t.product = number_of(source.product);
    t.coordinates = number_of(source.coordinates);
    t.is_cut = source.cutoff ? 1 : 0;
    t.color1[0] = static_cast<clr_real>(source.cutoff.value_or(0));
}

TextureInfo describe(const Texture &source, uint offset, const Flattening &work) {
    TextureInfo t{};
    for (int row = 0; row < 2; ++row)
        for (int column = 0; column < 3; ++column)
            t.to_uv[3 * row + column] = static_cast<clr_real>(source.to_uv[column][row]);
    if (source.kind == TextureKind::checkerboard) {
        t.kind = CLR_TEXTURE_CHECKERBOARD;
        store(t.color0, source.color0);
        store(t.color1, source.color1);
        t.product = t.coordinates = CLR_NONE;
        return t;
    }
    describe_factors(source, work, t);
    if (source.kind == TextureKind::attribute) {
        t.kind = CLR_TEXTURE_ATTRIBUTE;
        t.offset = work.attribute_index.at(source.attribute);
        t.nearest = is_face_attribute(source.attribute) ? 1 : 0;
        return t;
    }
    const Image &image = *source.bitmap;
    t.kind = image.type == PixelType::u8 ? CLR_TEXTURE_BITMAP_U8 : CLR_TEXTURE_BITMAP_F32;
    t.wrap = wrap_of(source.wrap);
    t.wrap_v = wrap_of(source.wrap_v.value_or(source.wrap));
    t.width = static_cast<uint>(image.width);
    t.height = static_cast<uint>(image.height);
    t.offset = offset;
    t.nearest = source.filter == TextureFilter::nearest ? 1 : 0;
    t.decode = (source.format.raw ? CLR_DECODE_LINEAR : CLR_DECODE_SRGB) +
               (source.format.half ? CLR_DECODE_HALF : 0u);
    if (source.is_number)
        t.number = source.channel == none ? CLR_TEXEL_LUMINANCE
                                          : CLR_TEXEL_RED + static_cast<uint>(source.channel);
    return t;
}

/// The tables of TextureInfo::decode, one after the other.
std::vector<clr_real> decode_tables() {
    std::vector<clr_real> tables;
    for (const TexelFormat format :
         {TexelFormat{.raw = true}, TexelFormat{}, TexelFormat{.raw = true, .half = true},
          TexelFormat{.half = true}})
        for (const double value : decode_bytes(format))
            tables.push_back(static_cast<clr_real>(value));
    return tables;
}

} // namespace

uint flatten_texture(Flattening &work, int texture, Rgb absent, clr_real *constant) {
    FlatScene &flat = work.flat;
    Rgb value = absent;
    const Texture *source = nullptr;
    if (texture != none) {
        source = &work.scene.textures[static_cast<std::size_t>(texture)];
        value = source->value;
    }
    if (source == nullptr || source->kind == TextureKind::constant) {
        for (int c = 0; c < 3; ++c)
            constant[c] = static_cast<clr_real>(value[c]);
        return CLR_NONE;
    }

    // The same texture under two materials is described once.
    const auto known = work.texture_index.find(texture);
    if (known != work.texture_index.end())
        return known->second;
    uint offset = 0;
    if (source->kind == TextureKind::bitmap)
        offset = offset_of_image(*source, work);
    if (flat.decode.empty())
        flat.decode = decode_tables();
    const auto index = static_cast<uint>(flat.textures.size());
    flat.textures.push_back(describe(*source, offset, work));
    work.texture_index[texture] = index;
    return index;
}

} // namespace clrender::inline CLR_PRECISION
