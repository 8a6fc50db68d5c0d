#include "bsdf_packing.h"
#include "plastic_boundary.h"

#include <algorithm>

namespace clrender::inline CLR_PRECISION {

namespace {

/// Appends the table of a boundary to the scene's; returns its start.
std::size_t append_table(FlatScene &flat, const RoughBoundary &boundary) {
    const std::size_t start = flat.bsdf_tables.size();
    for (const double share : boundary.transmittance)
        flat.bsdf_tables.push_back(static_cast<clr_real>(share));
    return start;
}

} // namespace

PackedBsdf pack_bsdf(MaterialPacker &packer, const RoughPlasticBsdf &bsdf, BsdfSide) {
    const bool beckmann = bsdf.microfacets == MicrofacetKind::beckmann;
    const double alpha = std::max(bsdf.alpha, 1e-4);
    const RoughBoundary boundary =
        rough_boundary(beckmann, alpha, bsdf.plastic.ior.interior / bsdf.plastic.ior.exterior);
    PackedBsdf packed(CLR_BSDF_ROUGHPLASTIC | (beckmann ? CLR_BSDF_BECKMANN : CLR_BSDF_GGX));
    pack_plastic(packer, bsdf.plastic, boundary.internal_reflectance, packed);
    const std::size_t start = append_table(packer.work.flat, boundary);
    packed.parameters.push_back(
        {{static_cast<clr_real>(alpha), static_cast<clr_real>(start), 0}, CLR_NONE});
    return packed;
}

} // namespace clrender::inline CLR_PRECISION
