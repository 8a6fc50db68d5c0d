#include "bsdf_packing.h"

namespace clrender::inline CLR_PRECISION {

uint burley_flags(const MaterialPacker &packer, int anisotropic) {
    const Texture &texture = packer.work.scene.textures[static_cast<std::size_t>(anisotropic)];
    const bool isotropic = texture.kind == TextureKind::constant && texture.value.x == 0;
    return CLR_BSDF_GGX | (isotropic ? 0U : CLR_BSDF_TANGENTS);
}

PackedBsdf pack_bsdf(MaterialPacker &packer, const PrincipledBsdf &bsdf, BsdfSide) {
    PackedBsdf packed(CLR_BSDF_PRINCIPLED | burley_flags(packer, bsdf.anisotropic));
    packed.material.kind |= bsdf.spec_trans == none ? 0U : CLR_BSDF_TRANSMITS;
    packed.parameters.resize(CLR_PRINCIPLED_PARAMETERS);
    const auto set = [&](int parameter, int texture, const Rgb &absent = Rgb{0.0}) {
        packed.parameters[static_cast<std::size_t>(parameter)] = packer.colour(texture, absent);
    };
    set(CLR_PRINCIPLED_BASE_COLOR, bsdf.base_color, Rgb{0.5});
    set(CLR_PRINCIPLED_ROUGHNESS, bsdf.roughness);
    set(CLR_PRINCIPLED_ANISOTROPIC, bsdf.anisotropic);
    set(CLR_PRINCIPLED_METALLIC, bsdf.metallic);
    set(CLR_PRINCIPLED_SPEC_TRANS, bsdf.spec_trans);
    set(CLR_PRINCIPLED_SPEC_TINT, bsdf.spec_tint);
    set(CLR_PRINCIPLED_SHEEN, bsdf.sheen);
    set(CLR_PRINCIPLED_SHEEN_TINT, bsdf.sheen_tint);
    set(CLR_PRINCIPLED_FLATNESS, bsdf.flatness);
    set(CLR_PRINCIPLED_CLEARCOAT, bsdf.clearcoat);
    set(CLR_PRINCIPLED_CLEARCOAT_GLOSS, bsdf.clearcoat_gloss);
    packed.parameters[CLR_PRINCIPLED_ETA] = MaterialPacker::eta({bsdf.eta, 1});
    return packed;
}

} // namespace clrender::inline CLR_PRECISION
