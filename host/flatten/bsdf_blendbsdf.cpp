#include "bsdf_packing.h"

namespace clrender::inline CLR_PRECISION {

PackedBsdf pack_bsdf(MaterialPacker &packer, const BlendBsdf &bsdf, BsdfSide side) {
    PackedBsdf packed(CLR_BSDF_BLEND);
    packed.parameters = {packer.colour(bsdf.weight),
                         MaterialPacker::children(packer.material_of(bsdf.first, side),
                                                  packer.material_of(bsdf.second, side))};
    return packed;
}

} // namespace clrender::inline CLR_PRECISION
