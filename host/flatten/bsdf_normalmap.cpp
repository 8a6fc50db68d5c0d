#include "bsdf_packing.h"

namespace clrender::inline CLR_PRECISION {

uint flags_of(const MaterialPacker &packer, const PerturbedNormals &normals, int nested,
              BsdfSide side) {
    return CLR_BSDF_TANGENTS |
           (lets_light_through(packer.work.scene, nested) ? CLR_BSDF_LETS_THROUGH : 0u) |
           (normals.flip_invalid ? CLR_BSDF_FLIPS_NORMALS : 0u) |
           (normals.shadow ? CLR_BSDF_SHADOWS_NORMALS : 0u) |
           (side.mirrored ? CLR_BSDF_MIRRORED : 0u);
}

PackedBsdf pack_bsdf(MaterialPacker &packer, const NormalMapBsdf &bsdf, BsdfSide side) {
    PackedBsdf packed(CLR_BSDF_NORMALMAP | flags_of(packer, bsdf.normals, bsdf.nested, side));
    packed.parameters = {packer.colour(bsdf.normalmap),
                         MaterialPacker::children(packer.material_of(bsdf.nested, side), 0)};
    return packed;
}

} // namespace clrender::inline CLR_PRECISION
