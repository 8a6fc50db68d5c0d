#include "bsdf_packing.h"

namespace clrender::inline CLR_PRECISION {

void pack_microfacets(MaterialPacker &packer, const MicrofacetModel &model, PackedBsdf &packed) {
    packed.material.kind |= model.kind == MicrofacetKind::ggx ? CLR_BSDF_GGX : CLR_BSDF_BECKMANN;
    packed.material.kind |= model.alpha_u != model.alpha_v ? CLR_BSDF_TANGENTS : 0u;
    packed.parameters[CLR_MICROFACETS_ALPHA_U] = packer.colour(model.alpha_u);
    packed.parameters[CLR_MICROFACETS_ALPHA_V] = packer.colour(model.alpha_v);
}

PackedBsdf pack_bsdf(MaterialPacker &packer, const RoughConductorBsdf &bsdf, BsdfSide) {
    PackedBsdf packed(CLR_BSDF_ROUGHCONDUCTOR);
    packed.parameters.resize(CLR_ROUGHCONDUCTOR_PARAMETERS);
    pack_microfacets(packer, bsdf.microfacets, packed);
    packed.parameters[CLR_ROUGHCONDUCTOR_REFLECTANCE] = packer.colour(bsdf.specular_reflectance);
    packed.parameters[CLR_ROUGHCONDUCTOR_ETA] = packer.colour(bsdf.eta, Rgb{0.0});
    packed.parameters[CLR_ROUGHCONDUCTOR_K] = packer.colour(bsdf.k);
    return packed;
}

} // namespace clrender::inline CLR_PRECISION
