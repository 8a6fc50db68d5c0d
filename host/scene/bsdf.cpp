#include "scene.h"

namespace clrender {

namespace {

/// Whether light passes, for each kind of BSDF.
struct LetsThrough {
    const Scene &scene;

    [[nodiscard]] bool nested(int bsdf) const { return lets_light_through(scene, bsdf); }

    bool operator()(const DiffuseBsdf &) const { return false; }
    bool operator()(const ConductorBsdf &) const { return false; }
    bool operator()(const RoughConductorBsdf &) const { return false; }
    bool operator()(const DielectricBsdf &) const { return true; }
    bool operator()(const RoughDielectricBsdf &) const { return true; }
    bool operator()(const ThinDielectricBsdf &) const { return true; }
    bool operator()(const PlasticBsdf &) const { return false; }
    bool operator()(const RoughPlasticBsdf &) const { return false; }
    bool operator()(const PrincipledBsdf &b) const { return b.spec_trans != none; }
    bool operator()(const PrincipledThinBsdf &) const { return true; }
    bool operator()(const NullBsdf &) const { return true; }
    bool operator()(const MaskBsdf &) const { return true; }
    bool operator()(const BlendBsdf &b) const { return nested(b.first) || nested(b.second); }
    bool operator()(const NormalMapBsdf &b) const { return nested(b.nested); }
    bool operator()(const BumpMapBsdf &b) const { return nested(b.nested); }
    bool operator()(const TwosidedBsdf &) const { return false; }
};

/// See is_mirror_like().
struct MirrorLike {
    const Scene &scene;

    /// Whether a roughness is this small everywhere.
    [[nodiscard]] bool is_below(int texture, double most) const {
        if (texture == none)
            return false;
        const Texture &t = scene.textures.at(static_cast<std::size_t>(texture));
        return t.kind == TextureKind::constant && t.value.x <= most;
    }
    static constexpr double least_alpha = 0.01; ///< from where on lobes count as rough
    [[nodiscard]] bool of(const MicrofacetModel &m) const {
        return is_below(m.alpha_u, least_alpha) && is_below(m.alpha_v, least_alpha);
    }

    bool operator()(const ConductorBsdf &) const { return true; }
    bool operator()(const DielectricBsdf &) const { return true; }
    bool operator()(const ThinDielectricBsdf &) const { return true; }
    bool operator()(const PlasticBsdf &) const { return true; }
    bool operator()(const RoughConductorBsdf &b) const { return of(b.microfacets); }
    bool operator()(const RoughDielectricBsdf &b) const { return of(b.microfacets); }
    bool operator()(const RoughPlasticBsdf &b) const { return b.alpha <= least_alpha; }
    /// Their alpha is the square of the roughness.
    bool operator()(const BurleyBsdf &b) const { return is_below(b.roughness, 0.1); }
    bool operator()(const DiffuseBsdf &) const { return false; }
    bool operator()(const NullBsdf &) const { return false; }
    bool operator()(const MaskBsdf &) const { return false; }
    bool operator()(const BlendBsdf &) const { return false; }
    bool operator()(const NormalMapBsdf &) const { return false; }
    bool operator()(const BumpMapBsdf &) const { return false; }
    bool operator()(const TwosidedBsdf &) const { return false; }
};

} // namespace

bool is_mirror_like(const Scene &scene, const Bsdf &bsdf) {
    return std::visit(MirrorLike{scene}, bsdf.model);
}

bool lets_light_through(const Scene &scene, int bsdf) {
    return bsdf != none &&
           std::visit(LetsThrough{scene}, scene.bsdfs.at(static_cast<std::size_t>(bsdf)).model);
}

} // namespace clrender
