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

} // namespace

bool lets_light_through(const Scene &scene, int bsdf) {
    return bsdf != none &&
           std::visit(LetsThrough{scene}, scene.bsdfs.at(static_cast<std::size_t>(bsdf)).model);
}

} // namespace clrender
