#include "flatten_parts.h"

#include <algorithm>
#include <cmath>

namespace clrender::inline CLR_PRECISION {

namespace {

/// Byte `channel` of pixel `at`, grey images giving the same for all.
uint byte_of(const Image &image, std::size_t at, int channel) {
    const int channels = image.channels;
    const int source = channels >= 3 ? channel : 0;
    return image.u8[at * static_cast<std::size_t>(channels) + static_cast<std::size_t>(source)];
}

clr_real float_of(const Image &image, std::size_t at, int channel) {
    const int channels = image.channels;
    const int source = channels >= 3 ? channel : 0;
    return image.f32[at * static_cast<std::size_t>(channels) + static_cast<std::size_t>(source)];
}

/// Appends the pixels of an image, once however many textures share it; returns its offset.
uint append_texels(const Image &image, FlatScene &flat) {
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
    for (std::size_t i = 0; i < count; ++i)
        for (int c = 0; c < 3; ++c)
            flat.texels_f32.push_back(float_of(image, i, c));
    return offset;
}

/// The offset of an image that an earlier texture has appended, or a new one.
uint offset_of_image(const std::shared_ptr<const Image> &image, Flattening &work) {
    for (const auto &[other, index] : work.texture_index) {
        const Texture &before = work.scene.textures[static_cast<std::size_t>(other)];
        if (before.kind == TextureKind::bitmap && before.bitmap == image)
            return work.flat.textures[index].offset;
    }
    return append_texels(*image, work.flat);
}

TextureInfo describe(const Texture &source, uint offset) {
    TextureInfo t{};
    for (int row = 0; row < 2; ++row)
        for (int column = 0; column < 3; ++column)
            t.to_uv[3 * row + column] = static_cast<clr_real>(source.to_uv[column][row]);
    if (source.kind == TextureKind::checkerboard) {
        t.kind = CLR_TEXTURE_CHECKERBOARD;
        store(t.color0, source.color0);
        store(t.color1, source.color1);
        return t;
    }
    const Image &image = *source.bitmap;
    t.kind = image.type == PixelType::u8 ? CLR_TEXTURE_BITMAP_U8 : CLR_TEXTURE_BITMAP_F32;
    t.wrap = source.wrap == TextureWrap::repeat   ? CLR_WRAP_REPEAT
             : source.wrap == TextureWrap::mirror ? CLR_WRAP_MIRROR
                                                  : CLR_WRAP_CLAMP;
    t.width = static_cast<uint>(image.width);
    t.height = static_cast<uint>(image.height);
    t.offset = offset;
    t.nearest = source.filter == TextureFilter::nearest ? 1 : 0;
    t.decode = source.raw ? 0 : 1;
    return t;
}

/// 256 linear values, then the same through the sRGB transfer function.
std::vector<clr_real> decode_table() {
    std::vector<clr_real> table(512);
    for (std::size_t i = 0; i < 256; ++i) {
        const double value = static_cast<double>(i) / 255;
        table[i] = static_cast<clr_real>(value);
        table[256 + i] = static_cast<clr_real>(srgb_decode(value));
    }
    return table;
}

Material flatten_bsdf(Flattening &work, const Bsdf &bsdf) {
    Material m{};
    m.texture = m.texture2 = CLR_NONE;
    const Rgb one{1.0};
    switch (bsdf.kind) {
    case BsdfKind::diffuse:
        m.kind = CLR_BSDF_DIFFUSE;
        m.texture = flatten_texture(work, bsdf.reflectance, Rgb{0.5}, m.color);
        break;
    case BsdfKind::conductor:
        m.kind = bsdf.perfect_mirror ? CLR_BSDF_MIRROR : CLR_BSDF_CONDUCTOR;
        m.texture = flatten_texture(work, bsdf.specular_reflectance, one, m.color);
        store(m.eta, bsdf.eta);
        store(m.k, bsdf.k);
        break;
    case BsdfKind::dielectric:
        m.kind = CLR_BSDF_DIELECTRIC;
        m.texture = flatten_texture(work, bsdf.specular_reflectance, one, m.color);
        m.texture2 = flatten_texture(work, bsdf.specular_transmittance, one, m.color2);
        store(m.eta, Rgb{bsdf.int_ior / bsdf.ext_ior, bsdf.ext_ior / bsdf.int_ior, 0});
        break;
    case BsdfKind::twosided:
        break;
    }
    return m;
}

/// Where all dielectrics have the same tint, or the same index, every material gets it, and the
/// kernel need not ask which one it has hit.
void share_dielectric_fields(FlatScene &flat) {
    const auto is_dielectric = [](const Material &m) { return m.kind == CLR_BSDF_DIELECTRIC; };
    const auto first = std::find_if(flat.materials.begin(), flat.materials.end(), is_dielectric);
    if (first == flat.materials.end())
        return;
    const Material model = *first;
    const int shades = dielectric_shades(flat.materials);
    for (Material &m : flat.materials) {
        if ((shades & CLR_SHADES_TINTS) == 0)
            std::copy_n(model.color2, 3, m.color2);
        if ((shades & CLR_SHADES_INDICES) == 0 && m.kind != CLR_BSDF_CONDUCTOR)
            std::copy_n(model.eta, 3, m.eta);
    }
}

} // namespace

int dielectric_shades(const std::vector<Material> &materials) {
    const Material *model = nullptr;
    int shades = 0;
    for (const Material &m : materials) {
        if (m.kind != CLR_BSDF_DIELECTRIC)
            continue;
        if (model == nullptr)
            model = &m;
        if (!std::equal(m.color2, m.color2 + 3, model->color2))
            shades |= CLR_SHADES_TINTS;
        if (m.eta[0] != model->eta[0])
            shades |= CLR_SHADES_INDICES;
    }
    return shades;
}

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
        offset = offset_of_image(source->bitmap, work);
    if (flat.decode.empty())
        flat.decode = decode_table();
    const auto index = static_cast<uint>(flat.textures.size());
    flat.textures.push_back(describe(*source, offset));
    work.texture_index[texture] = index;
    return index;
}

void flatten_materials(Flattening &work) {
    const Scene &scene = work.scene;
    FlatScene &flat = work.flat;
    // Only BSDFs that some shape shows are flattened; equal sides share one material.
    const auto material_of = [&](int bsdf) -> uint {
        if (bsdf == none)
            return CLR_NO_MATERIAL;
        const auto known = work.material_index.find(bsdf);
        if (known != work.material_index.end())
            return known->second;
        const auto index = static_cast<uint>(flat.materials.size());
        flat.materials.push_back(flatten_bsdf(work, scene.bsdfs[static_cast<std::size_t>(bsdf)]));
        work.material_index[bsdf] = index;
        return index;
    };
    for (const Shape &shape : scene.shapes) {
        const Bsdf &bsdf = scene.bsdfs[static_cast<std::size_t>(shape.bsdf)];
        uint front = CLR_NO_MATERIAL;
        uint back = CLR_NO_MATERIAL;
        if (bsdf.kind == BsdfKind::twosided) {
            front = material_of(bsdf.front);
            back = material_of(bsdf.back);
        } else {
            front = material_of(shape.bsdf);
            if (bsdf.kind == BsdfKind::dielectric)
                back = front;
        }
        if (flat.materials.size() >= CLR_NO_MATERIAL)
            throw InputError(shape.where, "more than 65534 different BSDFs are not supported");
        work.sides_of_bsdf[shape.bsdf] = front | back << 16;
    }
    share_dielectric_fields(flat);
}

} // namespace clrender::inline CLR_PRECISION
