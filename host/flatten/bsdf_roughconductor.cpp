#include "bsdf_packing.h"

namespace clrender::inline CLR_PRECISION {

uint flags_of(const MicrofacetModel &model) {
    return (model.kind == MicrofacetKind::ggx ? CLR_BSDF_GGX : CLR_BSDF_BECKMANN) |
           (model.alpha_u != model.alpha_v ? CLR_BSDF_TANGENTS : 0u);
}

PackedBsdf pack_bsdf(MaterialPacker &packer, const RoughConductorBsdf &bsdf, BsdfSide) {
    PackedBsdf packed(CLR_BSDF_ROUGHCONDUCTOR | flags_of(bsdf.microfacets));
    packed.parameters.resize(CLR_ROUGHCONDUCTOR_PARAMETERS);
    packed.parameters[CLR_ROUGHCONDUCTOR_ALPHA_U] = packer.colour(bsdf.microfacets.alpha_u);
    packed.parameters[CLR_ROUGHCONDUCTOR_ALPHA_V] = packer.colour(bsdf.microfacets.alpha_v);
    packed.parameters[CLR_ROUGHCONDUCTOR_REFLECTANCE] = packer.colour(bsdf.specular_reflectance);
    packed.parameters[CLR_ROUGHCONDUCTOR_ETA] = packer.colour(bsdf.eta, Rgb{0.0});
    packed.parameters[CLR_ROUGHCONDUCTOR_K] = packer.colour(bsdf.k);
    return packed;
}

} // namespace clrender::inline CLR_PRECISION
