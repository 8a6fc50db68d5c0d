#include "bsdf_packing.h"

#include <stdexcept>

namespace clrender::inline CLR_PRECISION {

PackedBsdf pack_bsdf(MaterialPacker &, const TwosidedBsdf &, BsdfSide) {
    throw std::logic_error("twosided BSDFs are resolved by MaterialPacker::material_of");
}

} // namespace clrender::inline CLR_PRECISION
