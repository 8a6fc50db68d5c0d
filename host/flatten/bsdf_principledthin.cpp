#include "bsdf_packing.h"

namespace clrender::inline CLR_PRECISION {

PackedBsdf pack_bsdf(MaterialPacker &packer, const PrincipledThinBsdf &bsdf, BsdfSide) {
    PackedBsdf packed(CLR_BSDF_PRINCIPLEDTHIN | CLR_BSDF_TRANSMITS |
                      burley_flags(packer, bsdf.anisotropic));
    packed.parameters.resize(CLR_PRINCIPLEDTHIN_PARAMETERS);
    const auto set = [&](int parameter, int texture) {
        packed.parameters[static_cast<std::size_t>(parameter)] = packer.colour(texture, Rgb{0.5});
    };
    set(CLR_PRINCIPLEDTHIN_BASE_COLOR, bsdf.base_color);
    set(CLR_PRINCIPLEDTHIN_ROUGHNESS, bsdf.roughness);
    set(CLR_PRINCIPLEDTHIN_ANISOTROPIC, bsdf.anisotropic);
    set(CLR_PRINCIPLEDTHIN_SPEC_TRANS, bsdf.spec_trans);
    set(CLR_PRINCIPLEDTHIN_ETA, bsdf.eta);
    set(CLR_PRINCIPLEDTHIN_SPEC_TINT, bsdf.spec_tint);
    set(CLR_PRINCIPLEDTHIN_SHEEN, bsdf.sheen);
    set(CLR_PRINCIPLEDTHIN_SHEEN_TINT, bsdf.sheen_tint);
    set(CLR_PRINCIPLEDTHIN_FLATNESS, bsdf.flatness);
    set(CLR_PRINCIPLEDTHIN_DIFF_TRANS, bsdf.diff_trans);
    return packed;
}

} // namespace clrender::inline CLR_PRECISION
