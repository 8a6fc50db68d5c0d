#include "bsdf_packing.h"
#include "plastic_boundary.h"

namespace clrender::inline CLR_PRECISION {

void pack_plastic(MaterialPacker &packer, const PlasticBsdf &bsdf, double internal_reflectance,
                  PackedBsdf &packed) {
    packed.parameters.resize(CLR_PLASTIC_PARAMETERS);
    packed.parameters[CLR_PLASTIC_DIFFUSE] = packer.colour(bsdf.diffuse_reflectance, Rgb{0.5});
    packed.parameters[CLR_PLASTIC_SPECULAR] = packer.colour(bsdf.specular_reflectance);
    BsdfParameter &eta = packed.parameters[CLR_PLASTIC_ETA] = MaterialPacker::eta(bsdf.ior);
    eta.value[2] = static_cast<clr_real>(internal_reflectance);
    packed.material.kind |= bsdf.nonlinear ? CLR_BSDF_NONLINEAR : 0U;
}

PackedBsdf pack_bsdf(MaterialPacker &packer, const PlasticBsdf &bsdf, BsdfSide) {
    PackedBsdf packed(CLR_BSDF_PLASTIC);
    pack_plastic(packer, bsdf, internal_reflectance(bsdf.ior.interior / bsdf.ior.exterior), packed);
    return packed;
}

} // namespace clrender::inline CLR_PRECISION
