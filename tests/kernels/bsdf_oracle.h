#pragma once
/// BSDFs in double precision, written from their papers, for comparison with the kernels' functions
/// and with values of Mitsuba 3. Directions are unit vectors of the shading frame and point away
/// from the surface; a negative wi.z is the back.

#include "microfacet_oracle.h"

#include <vector>

namespace clrender::test {

/// Reflectance of a dielectric boundary for light that arrives with cosine `c` > 0; `eta` is the
/// index of the far side over that of the near one. 1 where reflection is total.
double dielectric_reflectance(double c, double eta);

/// Reflectance of a conductor with index eta + i k, from Fresnel's complex amplitudes.
double conductor_reflectance(double c, double eta, double k);

/// The value times |wo.z| of all but delta lobes, for light that leaves along wi (`from` where that
/// may be the back) and arrives from wo (`to`).
struct RoughConductorOracle {
    MicrofacetOracle microfacets;
    glm::dvec3 eta{0}, k{1}, reflectance{1};
    [[nodiscard]] glm::dvec3 value(const glm::dvec3 &wi, const glm::dvec3 &wo) const;
};

struct RoughDielectricOracle {
    MicrofacetOracle microfacets;
    double eta = 1.5; ///< interior over exterior
    glm::dvec3 reflectance{1}, transmittance{1};
    [[nodiscard]] glm::dvec3 value(const glm::dvec3 &from, const glm::dvec3 &to) const;
};

/// A diffuse base under a smooth or rough boundary of reflectance `internal` from within, averaged
/// over directions. `transmittance` holds what passes the boundary from outside at evenly spaced
/// cosines from 0 to 1; where it is empty the boundary is smooth and shows in no value.
struct PlasticOracle {
    MicrofacetOracle microfacets;
    glm::dvec3 diffuse{0.5}, specular{1};
    double eta = 1.49, internal = 0;
    bool nonlinear = false;
    std::vector<double> transmittance;
    [[nodiscard]] glm::dvec3 value(const glm::dvec3 &wi, const glm::dvec3 &wo) const;
    /// What passes the boundary at this cosine.
    [[nodiscard]] double transmitted(double cosine) const;
};

/// Burley's two papers, "Physically Based Shading at Disney" (2012) and "Extending the Disney BRDF
/// to a BSDF with Integrated Subsurface Scattering" (2015), as Mitsuba 3 composes them.
struct PrincipledOracle {
    glm::dvec3 base{0.5};
    double roughness = 0.5, anisotropic = 0, metallic = 0, spec_trans = 0, eta = 1.5;
    double spec_tint = 0, sheen = 0, sheen_tint = 0, flatness = 0, clearcoat = 0;
    double clearcoat_gloss = 0;
    [[nodiscard]] glm::dvec3 value(const glm::dvec3 &from, const glm::dvec3 &to) const;
};

struct PrincipledThinOracle {
    glm::dvec3 base{0.5};
    double roughness = 0.5, anisotropic = 0, spec_trans = 0, eta = 1.5;
    double spec_tint = 0, sheen = 0, sheen_tint = 0, flatness = 0, diff_trans = 0;
    [[nodiscard]] glm::dvec3 value(const glm::dvec3 &from, const glm::dvec3 &to) const;
};

} // namespace clrender::test
