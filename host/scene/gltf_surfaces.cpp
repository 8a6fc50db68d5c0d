#include "gltf_surfaces.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace clrender::gltf {

struct SurfaceMaker::Work {
    const Material &material;
    const SurfaceNeeds &needs;
    Surface surface;
    int normal_map = none; ///< a texture
};

namespace {

TextureWrap wrap_of(int mode) {
    switch (mode) {
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
        return TextureWrap::clamp;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
        return TextureWrap::mirror;
    default:
        return TextureWrap::repeat;
    }
}

bool is_grey(const Rgb &c) {
    return c.r == c.g && c.g == c.b;
}

double largest(const Rgb &c) {
    return std::max({c.r, c.g, c.b});
}

/// The index of refraction whose reflectance straight on is that of the material's dielectric, with
/// KHR_materials_specular.
double eta_of(const Material &material) {
    if (material.specular == 1 && material.specular_color == Rgb(1))
        return material.ior;
    const double root = (material.ior - 1) / (material.ior + 1);
    const double r0 = std::min(root * root * largest(material.specular_color), 1.0);
    const double root0 = std::sqrt(std::min(r0 * material.specular, 0.99));
    return (1 + root0) / (1 - root0);
}

/// What a way through the whole volume lets pass.
Rgb transmittance(const Material &material) {
    if (material.attenuation_distance == 0 || material.thickness == 0)
        return Rgb(1);
    return glm::pow(material.attenuation_color,
                    Rgb(material.thickness / material.attenuation_distance));
}

} // namespace

std::string coordinates_attribute(int set) {
    return "vertex_texcoord_" + std::to_string(set);
}

const Material &SurfaceMaker::material(int index) {
    const auto known = materials_.find(index);
    if (known != materials_.end())
        return known->second;
    return materials_.emplace(index, read_material(document_, index)).first->second;
}

const Surface &SurfaceMaker::surface(const SurfaceNeeds &needs) {
    const auto known = surfaces_.find(needs);
    if (known != surfaces_.end())
        return known->second;
    Work work{material(needs.material), needs, {}, none};
    const Material &m = work.material;
    choose_sets(work);
    if (m.normal.is_there() && !m.is_unlit)
        if (const auto normals =
                images_.normals(m.normal.texture, m.normal_scale, needs.flips_normals)) {
            work.normal_map = bitmap(work, m.normal, normals, true, Rgb(1), "");
            work.surface.has_normal_map = true;
        }
    int bsdf = none;
    if (m.is_unlit) {
        const int black = add(DiffuseBsdf{constant(Rgb(0))}, m.name);
        bsdf = add(TwosidedBsdf{black, black});
    } else if (m.transmission > 0) {
        bsdf = transmitting(work);
    } else {
        bsdf = opaque(work, 1);
    }
    if (const int alpha = opacity(work); alpha != none)
        bsdf = add(MaskBsdf{alpha, bsdf});
    work.surface.bsdf = bsdf;
    work.surface.radiance = emission(work);
    return surfaces_.emplace(needs, std::move(work.surface)).first->second;
}

/// The normal map decides which set (u, v) are, since its tangents follow them; else the base
/// colour, else any. Others become attributes.
void SurfaceMaker::choose_sets(Work &work) const {
    const Material &m = work.material;
    bool is_chosen = false;
    for (const TextureUse &use :
         {m.normal, m.base_texture, m.metallic_roughness, m.emission_texture,
          m.transmission_texture, m.clearcoat_texture}) {
        if (!use.is_there())
            continue;
        if (!std::exchange(is_chosen, true))
            work.surface.set = use.set;
        work.surface.sets.insert(use.set);
    }
}

int SurfaceMaker::add(const BsdfModel &model, const std::string &id) {
    scene_.bsdfs.push_back({model, id, {document_.path, 0}});
    return static_cast<int>(scene_.bsdfs.size()) - 1;
}

int SurfaceMaker::add(Texture texture) {
    scene_.textures.push_back(std::move(texture));
    return static_cast<int>(scene_.textures.size()) - 1;
}

int SurfaceMaker::constant(const Rgb &value) {
    Texture texture;
    texture.value = value;
    return add(std::move(texture));
}

int SurfaceMaker::number(double value) {
    Texture texture;
    texture.value = Rgb(value);
    texture.is_number = true;
    return add(std::move(texture));
}

int SurfaceMaker::bitmap(Work &work, const TextureUse &use, std::shared_ptr<const Image> image,
                         bool raw, const Rgb &scale, const std::string &product) {
    Texture texture;
    texture.kind = TextureKind::bitmap;
    texture.bitmap = std::move(image);
    texture.format.raw = raw;
    texture.scale = scale;
    texture.product = product;
    texture.to_uv = use.to_uv;
    if (use.set != work.surface.set)
        texture.coordinates = coordinates_attribute(use.set);
    const int sampler = document_.model.textures[static_cast<std::size_t>(use.texture)].sampler;
    if (sampler >= 0) {
        const tinygltf::Sampler &how = element(document_, document_.model.samplers, sampler,
                                               "sampler", place_of("textures", use.texture));
        texture.wrap = wrap_of(how.wrapS);
        texture.wrap_v = wrap_of(how.wrapT);
        if (how.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST)
            texture.filter = TextureFilter::nearest;
    }
    const bool has_attributes = !texture.product.empty() || !texture.coordinates.empty();
    const int index = add(std::move(texture));
    if (has_attributes)
        work.surface.attribute_textures.push_back(index);
    return index;
}

int SurfaceMaker::base_color(Work &work, const Rgb &scale) {
    const Material &m = work.material;
    const std::string colors = work.needs.has_colors ? color_attribute : "";
    if (m.base_texture.is_there())
        if (const auto image = images_.get(m.base_texture.texture, false))
            return bitmap(work, m.base_texture, image, false, m.base * scale, colors);
    if (colors.empty())
        return constant(m.base * scale);
    Texture texture;
    texture.kind = TextureKind::attribute;
    texture.attribute = colors;
    texture.scale = m.base * scale;
    const int index = add(std::move(texture));
    work.surface.attribute_textures.push_back(index);
    return index;
}

int SurfaceMaker::channel(Work &work, const TextureUse &use, int channel, double factor) {
    const auto image = use.is_there() && factor != 0 ? images_.get(use.texture, true) : nullptr;
    if (!image)
        return number(factor);
    const int index = bitmap(work, use, image, true, Rgb(factor), "");
    Texture &texture = scene_.textures.back();
    texture.is_number = true;
    texture.channel = channel;
    return index;
}

/// The texture of the opacity; none where the surface is opaque.
int SurfaceMaker::opacity(Work &work) {
    const Material &m = work.material;
    if (m.alpha_mode == AlphaMode::opaque)
        return none;
    const std::string alphas = work.needs.has_alphas ? alpha_attribute : "";
    const auto image = m.base_texture.is_there() ? images_.alpha(m.base_texture.texture) : nullptr;
    const bool is_cut = m.alpha_mode == AlphaMode::mask;
    int index = none;
    if (image) {
        index = bitmap(work, m.base_texture, image, true, Rgb(m.alpha), alphas);
    } else if (!alphas.empty()) {
        Texture texture;
        texture.kind = TextureKind::attribute;
        texture.attribute = alphas;
        texture.scale = Rgb(m.alpha);
        index = add(std::move(texture));
        work.surface.attribute_textures.push_back(index);
    } else {
        const double alpha = is_cut ? (m.alpha < m.cutoff ? 0 : 1) : m.alpha;
        return alpha < 1 ? number(alpha) : none;
    }
    Texture &texture = scene_.textures[static_cast<std::size_t>(index)];
    texture.is_number = true;
    if (is_cut)
        texture.cutoff = m.cutoff;
    return index;
}

/// `bsdf` with the material's normal map.
int SurfaceMaker::turned(Work &work, int bsdf) {
    return work.normal_map == none ? bsdf : add(NormalMapBsdf{work.normal_map, {}, bsdf});
}

/// The parameters of the principled BSDF without metal and without glass.
PrincipledBsdf SurfaceMaker::principled_of(Work &work) {
    const Material &m = work.material;
    PrincipledBsdf bsdf;
    bsdf.base_color = base_color(work, Rgb(1));
    bsdf.roughness = channel(work, m.metallic_roughness, 1, m.roughness);
    bsdf.metallic = bsdf.anisotropic = bsdf.spec_tint = bsdf.flatness = number(0);
    bsdf.clearcoat = channel(work, m.clearcoat_texture, 0, m.clearcoat);
    // The coat's alpha is roughness^2 here, and lies between .1 and .001 there.
    const double alpha = m.clearcoat_roughness * m.clearcoat_roughness;
    bsdf.clearcoat_gloss = number(std::clamp((0.1 - alpha) / 0.099, 0.0, 1.0));
    bsdf.sheen = number(largest(m.sheen));
    bsdf.sheen_tint = number(0);
    bsdf.eta = eta_of(m);
    if (!is_grey(m.sheen) || !is_grey(m.specular_color))
        document_.warn(m.place, "the hue of its sheen or specular colour is ignored, its largest "
                                "channel is taken");
    return bsdf;
}

int SurfaceMaker::principled(Work &work, const PrincipledBsdf &bsdf) {
    const int side = turned(work, add(bsdf, work.material.name));
    return add(TwosidedBsdf{side, side});
}

/// What is opaque, the share of metal times `metallic`.
int SurfaceMaker::opaque(Work &work, double metallic) {
    PrincipledBsdf bsdf = principled_of(work);
    bsdf.metallic =
        channel(work, work.material.metallic_roughness, 2, metallic * work.material.metallic);
    return principled(work, bsdf);
}

/// Of metal nothing passes: it is mixed with what transmits.
int SurfaceMaker::transmitting(Work &work) {
    const Material &m = work.material;
    if (m.thickness > 0)
        return solid(work);
    if (m.metallic == 0)
        return thin(work);
    const int weight = channel(work, m.metallic_roughness, 2, m.metallic);
    const Texture &share = scene_.textures[static_cast<std::size_t>(weight)];
    if (share.kind == TextureKind::constant && share.value.r == 1)
        return opaque(work, 1);
    const int dielectric = thin(work);
    PrincipledBsdf metal = principled_of(work);
    metal.metallic = number(1);
    return add(BlendBsdf{weight, dielectric, principled(work, metal)});
}

/// A sheet: without KHR_materials_volume the standard has surfaces infinitely thin.
int SurfaceMaker::thin(Work &work) {
    const Material &m = work.material;
    const bool is_clear =
        m.transmission == 1 && !m.transmission_texture.is_there() && m.roughness == 0;
    if (is_clear)
        return turned(work,
                      add(ThinDielectricBsdf{{m.ior, 1}, none, base_color(work, Rgb(1))}, m.name));
    PrincipledThinBsdf bsdf;
    bsdf.base_color = base_color(work, Rgb(1));
    bsdf.roughness = channel(work, m.metallic_roughness, 1, m.roughness);
    bsdf.spec_trans = channel(work, m.transmission_texture, 0, m.transmission);
    bsdf.anisotropic = bsdf.spec_tint = bsdf.flatness = bsdf.diff_trans = number(0);
    bsdf.sheen = number(largest(m.sheen));
    bsdf.sheen_tint = number(0);
    bsdf.eta = number(m.ior);
    if (m.clearcoat > 0)
        document_.warn(m.place, "a coat on a thin surface that transmits is ignored");
    return turned(work, add(bsdf, m.name));
}

/// A volume of glass. What it absorbs is taken at its surface, half where light enters and half
/// where it leaves, for a way as long as the material states its thickness.
int SurfaceMaker::solid(Work &work) {
    const Material &m = work.material;
    const bool is_glass =
        m.transmission == 1 && !m.transmission_texture.is_there() && m.metallic == 0;
    const bool has_plain_roughness = m.roughness == 0 || !m.metallic_roughness.is_there();
    const Rgb passing = transmittance(m);
    if (passing != Rgb(1))
        document_.warn(m.place, "what the volume absorbs is taken at its surface, for ways as long "
                                "as thicknessFactor");
    if (is_glass && has_plain_roughness) {
        const int tint = base_color(work, glm::sqrt(passing));
        if (m.roughness == 0)
            return turned(work, add(DielectricBsdf{{m.ior, 1}, none, tint}, m.name));
        RoughDielectricBsdf bsdf;
        bsdf.microfacets.kind = MicrofacetKind::ggx;
        bsdf.microfacets.alpha_u = bsdf.microfacets.alpha_v =
            number(std::max(m.roughness * m.roughness, 1e-3));
        bsdf.ior = {m.ior, 1};
        bsdf.specular_transmittance = tint;
        return turned(work, add(bsdf, m.name));
    }
    PrincipledBsdf bsdf = principled_of(work);
    bsdf.base_color = base_color(work, passing);
    bsdf.metallic = channel(work, m.metallic_roughness, 2, m.metallic);
    bsdf.spec_trans = channel(work, m.transmission_texture, 0, m.transmission);
    if (bsdf.eta == 1)
        bsdf.eta = 1.001; // glass without a difference of indices has no direction of refraction
    return turned(work, add(bsdf, m.name));
}

/// The texture of what it shines; none where it is dark.
int SurfaceMaker::emission(Work &work) {
    const Material &m = work.material;
    if (m.is_unlit)
        return base_color(work, Rgb(1));
    if (!(largest(m.emission) > 0))
        return none;
    if (m.emission_texture.is_there())
        if (const auto image = images_.get(m.emission_texture.texture, false))
            return bitmap(work, m.emission_texture, image, false, m.emission, "");
    return constant(m.emission);
}

} // namespace clrender::gltf
