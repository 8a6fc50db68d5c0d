#include "bsdf_packing.h"

namespace clrender::inline CLR_PRECISION {

/// The children are the nested BSDF and nothing: light passes as by `null`.
PackedBsdf pack_bsdf(MaterialPacker &packer, const MaskBsdf &bsdf, BsdfSide side) {
    PackedBsdf packed(CLR_BSDF_BLEND);
    packed.parameters = {packer.colour(bsdf.opacity),
                         MaterialPacker::children(packer.material_of(NullBsdf{}),
                                                  packer.material_of(bsdf.nested, side))};
    return packed;
}

} // namespace clrender::inline CLR_PRECISION
