#pragma once
/// Microfacet distributions in double precision, written from the papers: Walter et al. 2007 and
/// Heitz 2014. Unit vectors of the shading frame.

#include <glm/glm.hpp>

#include <cmath>
#include <numbers>

namespace clrender::test {

struct MicrofacetOracle {
    bool beckmann = false;
    double alpha_u = 0.1, alpha_v = 0.1;

    /// The density of slopes of a rough surface (P22), from which D follows by D = P22 / cos^4.
    [[nodiscard]] double d(const glm::dvec3 &h) const {
        if (!(h.z > 0))
            return 0;
        const double slope_u = h.x / h.z / alpha_u, slope_v = h.y / h.z / alpha_v;
        const double r2 = slope_u * slope_u + slope_v * slope_v;
        const double p22 = beckmann ? std::exp(-r2) : 1 / ((1 + r2) * (1 + r2));
        return p22 / (std::numbers::pi * alpha_u * alpha_v * std::pow(h.z, 4));
    }

    /// Heitz's Lambda of the Smith profile, from a = 1 / (alpha tan theta).
    [[nodiscard]] double lambda(const glm::dvec3 &v) const {
        const double a = inverse_slope(v);
        if (std::isinf(a))
            return 0;
        if (!beckmann)
            return (std::sqrt(1 + 1 / (a * a)) - 1) / 2;
        return std::exp(-a * a) / (2 * a * std::sqrt(std::numbers::pi)) - std::erfc(a) / 2;
    }

    /// G1 as renderers have it: Beckmann's by Walter's rational approximation.
    [[nodiscard]] double g1(const glm::dvec3 &v, const glm::dvec3 &h) const {
        if (!(glm::dot(v, h) * v.z > 0))
            return 0;
        if (!beckmann)
            return 1 / (1 + lambda(v));
        const double a = inverse_slope(v);
        return a >= 1.6 ? 1 : (3.535 * a + 2.181 * a * a) / (1 + 2.276 * a + 2.577 * a * a);
    }

    /// The density of visible normals.
    [[nodiscard]] double visible(const glm::dvec3 &wi, const glm::dvec3 &h) const {
        return d(h) * std::max(glm::dot(wi, h), 0.0) / (wi.z * (1 + lambda(wi)));
    }

private:
    [[nodiscard]] double inverse_slope(const glm::dvec3 &v) const {
        return std::abs(v.z) / std::hypot(alpha_u * v.x, alpha_v * v.y);
    }
};

} // namespace clrender::test
