#include "bsdf_packing.h"

namespace clrender::inline CLR_PRECISION {

PackedBsdf pack_bsdf(MaterialPacker &, const NullBsdf &, BsdfSide) {
    return PackedBsdf(CLR_BSDF_NULL);
}

} // namespace clrender::inline CLR_PRECISION
