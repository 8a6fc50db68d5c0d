#include "bsdf_packing.h"

namespace clrender::inline CLR_PRECISION {

PackedBsdf pack_bsdf(MaterialPacker &packer, const ConductorBsdf &bsdf, BsdfSide) {
    PackedBsdf packed(bsdf.perfect_mirror ? CLR_BSDF_MIRROR : CLR_BSDF_CONDUCTOR);
    Material &m = packed.material;
    m.texture = flatten_texture(packer.work, bsdf.specular_reflectance, Rgb{1.0}, m.color);
    store(m.eta, bsdf.eta);
    store(m.k, bsdf.k);
    return packed;
}

} // namespace clrender::inline CLR_PRECISION
