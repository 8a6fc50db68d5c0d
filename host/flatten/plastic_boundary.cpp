#include "plastic_boundary.h"

#include "shared/bsdf_parameters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace clrender::inline CLR_PRECISION {

namespace {

/// Points along the slope's size, and around half of a turn: the other half mirrors it.
constexpr int sizes = 64, turns = 48;

/// Reflectance; `ct` becomes the cosine of the refracted direction, 0 where all is reflected.
double fresnel(double c, double eta, double &ct) {
    const double ct2 = 1 - (1 - c * c) / (eta * eta);
    ct = std::sqrt(std::max(ct2, 0.0));
    if (!(ct2 > 0))
        return 1;
    const double s = (c - eta * ct) / (c + eta * ct), p = (eta * c - ct) / (eta * c + ct);
    return (s * s + p * p) / 2;
}

/// Smith's G1 of a direction of cosine z, Beckmann's by the approximation of Walter et al. 2007.
double masking(bool beckmann, double alpha, double z) {
    const double a = z / (alpha * std::sqrt(std::max(1 - z * z, 1e-30)));
    if (!beckmann)
        return 2 / (1 + std::sqrt(1 + 1 / (a * a)));
    return a >= 1.6 ? 1 : a * (3.535 + 2.181 * a) / (1 + a * (2.276 + 2.577 * a));
}

struct Shares {
    double reflected = 0, transmitted = 0;
};

/// The shares of light from cosine z that leave the boundary after one reflection or refraction.
/// Normals are taken by the density of their slopes, times how much of each is visible (Heitz 2014,
/// equation 14), with more points where slopes are steep.
Shares shares(bool beckmann, double alpha, double eta, double z) {
    const double sine = std::sqrt(1 - z * z);
    Shares sum;
    double visible = 0;
    for (int i = 0; i < sizes; ++i) {
        // The distribution function of the slope's size is 1 - rest^2.
        const double rest = (i + 0.5) / sizes;
        const double r =
            alpha * (beckmann ? std::sqrt(-2 * std::log(rest)) : std::sqrt(1 - rest * rest) / rest);
        const double height = 1 / std::sqrt(1 + r * r); // h.z
        for (int j = 0; j < turns; ++j) {
            const double facing = z + sine * r * std::cos(std::numbers::pi * (j + 0.5) / turns);
            if (facing <= 0)
                continue;
            const double weight = rest * facing, c = std::min(facing * height, 1.0);
            double ct = 0;
            const double f = fresnel(c, eta, ct);
            visible += weight;
            const double up = 2 * c * height - z, down = (z - c * height) / eta + ct * height;
            if (up > 0)
                sum.reflected += weight * f * masking(beckmann, alpha, std::min(up, 1.0));
            if (down > 0)
                sum.transmitted += weight * (1 - f) * masking(beckmann, alpha, std::min(down, 1.0));
        }
    }
    return {sum.reflected / visible, sum.transmitted / visible};
}

} // namespace

double diffuse_fresnel_reflectance(double eta) {
    const double x = 1 / eta;
    if (eta < 1)
        return 0.6681 + eta * (0.7099 - 1.4399 * eta) + 0.0636 * x;
    return 0.919317 + x * (-3.4793 + x * (6.75335 + x * (-7.80989 + x * (4.98554 - 1.36881 * x))));
}

double internal_reflectance(double eta) {
    const double fit = diffuse_fresnel_reflectance(1 / eta);
    return fit < 0.97 ? fit : 1 - (1 - diffuse_fresnel_reflectance(eta)) / (eta * eta);
}

RoughBoundary rough_boundary(bool beckmann, double alpha, double eta) {
    RoughBoundary boundary;
    double internal = 0;
    for (int i = 0; i < CLR_BOUNDARY_COSINES; ++i) {
        const double z = std::max(1e-6, static_cast<double>(i) / (CLR_BOUNDARY_COSINES - 1));
        boundary.transmittance.push_back(shares(beckmann, alpha, eta, z).transmitted);
        internal += z * shares(beckmann, alpha, 1 / eta, z).reflected;
    }
    boundary.internal_reflectance = 2 * internal / CLR_BOUNDARY_COSINES;
    return boundary;
}

} // namespace clrender::inline CLR_PRECISION
