#include "bsdf_packing.h"

namespace clrender::inline CLR_PRECISION {

PackedBsdf pack_bsdf(MaterialPacker &packer, const RoughDielectricBsdf &bsdf, BsdfSide) {
    PackedBsdf packed(CLR_BSDF_ROUGHDIELECTRIC | CLR_BSDF_TRANSMITS);
    packed.parameters.resize(CLR_ROUGHDIELECTRIC_PARAMETERS);
    pack_microfacets(packer, bsdf.microfacets, packed);
    packed.parameters[CLR_ROUGHDIELECTRIC_REFLECTANCE] = packer.colour(bsdf.specular_reflectance);
    packed.parameters[CLR_ROUGHDIELECTRIC_TRANSMITTANCE] =
        packer.colour(bsdf.specular_transmittance);
    packed.parameters[CLR_ROUGHDIELECTRIC_ETA] = MaterialPacker::eta(bsdf.ior);
    return packed;
}

} // namespace clrender::inline CLR_PRECISION
