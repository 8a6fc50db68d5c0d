#include "bsdf_packing.h"

namespace clrender::inline CLR_PRECISION {

PackedBsdf pack_bsdf(MaterialPacker &packer, const BumpMapBsdf &bsdf, BsdfSide side) {
    PackedBsdf packed(CLR_BSDF_BUMPMAP | flags_of(packer, bsdf.normals, bsdf.nested, side));
    packed.parameters = {packer.colour(bsdf.height),
                         MaterialPacker::children(packer.material_of(bsdf.nested, side), 0)};
    // Heights are in units of the scene.
    packed.parameters[CLR_NODE_CHILDREN].value[2] =
        static_cast<clr_real>(bsdf.scale * packer.work.flat.placement.scale);
    return packed;
}

} // namespace clrender::inline CLR_PRECISION
