#include "bsdf_packing.h"

namespace clrender::inline CLR_PRECISION {

PackedBsdf pack_bsdf(MaterialPacker &packer, const ThinDielectricBsdf &bsdf, BsdfSide) {
    PackedBsdf packed(CLR_BSDF_THINDIELECTRIC);
    packed.parameters.resize(CLR_THINDIELECTRIC_PARAMETERS);
    packed.parameters[CLR_THINDIELECTRIC_REFLECTANCE] = packer.colour(bsdf.specular_reflectance);
    packed.parameters[CLR_THINDIELECTRIC_TRANSMITTANCE] =
        packer.colour(bsdf.specular_transmittance);
    packed.parameters[CLR_THINDIELECTRIC_ETA] = MaterialPacker::eta(bsdf.ior);
    return packed;
}

} // namespace clrender::inline CLR_PRECISION
