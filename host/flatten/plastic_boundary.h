#pragma once
/// How the dielectric boundary of `plastic` and `roughplastic` reflects, averaged over directions.

#include "shared/shared_types.h"

#include <vector>

namespace clrender::inline CLR_PRECISION {

/// The share of diffuse light that a smooth boundary reflects; `eta` is the index of the far side
/// over that of the near one. The fits that Mitsuba 3 takes, to .2% from 1 on and to .1% between
/// 1 / 1.5 and 1: Egan and Hilgeman, "Optical Properties of Inhomogeneous Materials" (1973), below
/// 1; d'Eon and Irving, "A Quantized-Diffusion Model for Rendering Translucent Materials" (SIGGRAPH
/// 2011), above.
double diffuse_fresnel_reflectance(double eta);

/// The same from inside of a boundary with index `eta`, interior over exterior. Where that fit
/// leaves its range (eta of 4), from the reflectance of the outside, to which it is reciprocal.
double internal_reflectance(double eta);

/// A rough boundary.
struct RoughBoundary {
    /// What is refracted from outside, at cosines i / (n - 1).
    std::vector<double> transmittance;
    /// What is reflected of diffuse light from inside.
    double internal_reflectance = 0;
};

/// Single scattering by microfacets with Smith's masking; `eta` is interior over exterior index.
RoughBoundary rough_boundary(bool beckmann, double alpha, double eta);

} // namespace clrender::inline CLR_PRECISION
