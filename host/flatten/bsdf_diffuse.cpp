#include "bsdf_packing.h"

namespace clrender::inline CLR_PRECISION {

PackedBsdf pack_bsdf(MaterialPacker &packer, const DiffuseBsdf &bsdf, BsdfSide) {
    PackedBsdf packed(CLR_BSDF_DIFFUSE);
    Material &m = packed.material;
    m.texture = flatten_texture(packer.work, bsdf.reflectance, Rgb{0.5}, m.color);
    return packed;
}

} // namespace clrender::inline CLR_PRECISION
