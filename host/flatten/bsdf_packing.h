#pragma once
/// How BSDFs become materials of the device: a function for each kind of BSDF (bsdf_<kind>.cpp).

#include "flatten_parts.h"
#include "shared/bsdf_parameters.h"

#include <map>
#include <tuple>
#include <vector>

namespace clrender::inline CLR_PRECISION {

/// The side of a BSDF that is seen. `mirrored`: it is a front that `twosided` shows on the back of
/// the surface, whose normal therefore points the other way.
struct BsdfSide {
    bool back = false, mirrored = false;
};

/// A material and what it has in the pool of parameters, in the order of bsdf_parameters.h.
struct PackedBsdf {
    Material material{};
    std::vector<BsdfParameter> parameters{};

    explicit PackedBsdf(uint kind) {
        material.kind = kind;
        material.texture = material.texture2 = CLR_NONE;
    }
};

/// Packs BSDFs, each side once.
class MaterialPacker {
public:
    explicit MaterialPacker(Flattening &flattening) : work(flattening) {}

    /// The index of the material, CLR_NO_MATERIAL for a side that reflects nothing.
    uint material_of(int bsdf, BsdfSide side);
    /// The material that lets all light pass.
    uint material_of(const NullBsdf &null);

    /// A colour or a texture; `absent` for none.
    BsdfParameter colour(int texture, const Rgb &absent = Rgb{1.0});
    /// CLR_NODE_CHILDREN.
    static BsdfParameter children(uint first, uint second);
    /// The relative index of refraction, and its inverse.
    static BsdfParameter eta(const IndicesOfRefraction &ior);

    Flattening &work;
    std::vector<PackedBsdf> packed{}; ///< by material

private:
    uint append(PackedBsdf result);

    uint null_ = CLR_NO_MATERIAL;
    std::map<std::tuple<int, bool, bool>, uint> index_{};
};

#define CLR_PLUGIN(type, Model)                                                                    \
    PackedBsdf pack_bsdf(MaterialPacker &packer, const Model &bsdf, BsdfSide side);
#include "scene/bsdf_plugins.def"
#undef CLR_PLUGIN

/// Sets the parameters of a plastic whose boundary reflects this share of diffuse light from
/// inside.
void pack_plastic(MaterialPacker &packer, const PlasticBsdf &bsdf, double internal_reflectance,
                  PackedBsdf &packed);
/// The flags of a principled BSDF with this texture of anisotropy.
uint burley_flags(const MaterialPacker &packer, int anisotropic);
/// The flags that a microfacet model gives a material.
uint flags_of(const MicrofacetModel &model);
/// Those that the map of a side gives it, `nested` being what the map turns.
uint flags_of(const MaterialPacker &packer, const PerturbedNormals &normals, int nested,
              BsdfSide side);

} // namespace clrender::inline CLR_PRECISION
