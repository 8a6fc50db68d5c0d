#include "bsdf_packing.h"

#include <algorithm>

namespace clrender::inline CLR_PRECISION {

PackedBsdf pack_bsdf(MaterialPacker &packer, const DielectricBsdf &bsdf, BsdfSide) {
    PackedBsdf packed(CLR_BSDF_DIELECTRIC);
    Material &m = packed.material;
    m.texture = flatten_texture(packer.work, bsdf.specular_reflectance, Rgb{1.0}, m.color);
    m.texture2 = flatten_texture(packer.work, bsdf.specular_transmittance, Rgb{1.0}, m.color2);
    std::copy_n(MaterialPacker::eta(bsdf.ior).value, 3, m.eta);
    return packed;
}

} // namespace clrender::inline CLR_PRECISION
