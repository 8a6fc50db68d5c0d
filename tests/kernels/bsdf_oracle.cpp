#include "bsdf_oracle.h"

#include <algorithm>
#include <complex>

namespace clrender::test {

namespace {

constexpr double inv_pi = std::numbers::inv_pi;
using glm::dot;
using glm::dvec3;

/// The same situation seen with wi above the surface.
dvec3 turned(const dvec3 &v, const dvec3 &wi) {
    return wi.z < 0 ? -v : v;
}

/// Schlick's (1 - c)^5.
double schlick(double c) {
    return std::pow(std::clamp(1 - c, 0.0, 1.0), 5);
}

double luminance(const dvec3 &rgb) {
    return dot(rgb, dvec3(0.212671, 0.715160, 0.072169));
}

/// The hue of a colour: its multiple of luminance 1.
dvec3 tint_of(const dvec3 &base) {
    const double l = luminance(base);
    return l > 0 ? base / l : dvec3(1);
}

/// The cosine that Schlick's approximation takes: on the less dense side.
double schlick_cosine(double c, double eta) {
    return eta > 1 ? c : std::sqrt(std::max(0.0, 1 - (1 - c * c) / (eta * eta)));
}

dvec3 schlick_reflectance(const dvec3 &r0, double c, double eta) {
    return glm::mix(r0, dvec3(1), schlick(schlick_cosine(c, eta)));
}

MicrofacetOracle burley_ggx(double roughness, double anisotropic) {
    const double aspect = std::sqrt(1 - 0.9 * anisotropic);
    return {false, std::max(1e-3, roughness * roughness / aspect),
            std::max(1e-3, roughness * roughness * aspect)};
}

/// Torrance-Sparrow without its Fresnel factor: D G / (4 cos_i).
double reflected(const MicrofacetOracle &m, const dvec3 &wi, const dvec3 &wo, const dvec3 &h) {
    return m.d(h) * m.g1(wi, h) * m.g1(wo, h) / (4 * wi.z);
}

/// Burley's diffuse lobe with retro-reflection and its flat variant, times cos / pi; h is between
/// the two directions, on one side of the surface.
double burley_diffuse(double cos_i, double cos_o, double cos_d, double roughness, double flatness) {
    const double fi = schlick(cos_i), fo = schlick(cos_o);
    const double retro = 2 * roughness * cos_d * cos_d;
    const double rough = (1 - fi / 2) * (1 - fo / 2) + retro * (fo + fi + fo * fi * (retro - 1));
    const double fss = std::lerp(1, retro / 2, fo) * std::lerp(1, retro / 2, fi);
    const double flat = 1.25 * (fss * (1 / (cos_o + cos_i) - 0.5) + 0.5);
    return cos_o * inv_pi * std::lerp(rough, flat, flatness);
}

dvec3 burley_sheen(const dvec3 &base, double cos_d, double cos_o, double sheen, double tint) {
    return sheen * schlick(std::abs(cos_d)) * cos_o * glm::mix(dvec3(1), tint_of(base), tint);
}

} // namespace

double dielectric_reflectance(double c, double eta) {
    const double sine2 = (1 - c * c) / (eta * eta);
    if (sine2 >= 1)
        return 1;
    const double ct = std::sqrt(1 - sine2);
    const double s = (c - eta * ct) / (c + eta * ct), p = (eta * c - ct) / (eta * c + ct);
    return (s * s + p * p) / 2;
}

double conductor_reflectance(double c, double eta, double k) {
    const std::complex<double> index(eta, k);
    const std::complex<double> ct = std::sqrt(1.0 - (1 - c * c) / (index * index));
    const auto s = (c - index * ct) / (c + index * ct), p = (index * c - ct) / (index * c + ct);
    return (std::norm(s) + std::norm(p)) / 2;
}

dvec3 RoughConductorOracle::value(const dvec3 &wi, const dvec3 &wo) const {
    if (!(wi.z > 0 && wo.z > 0))
        return dvec3(0);
    const dvec3 h = glm::normalize(wi + wo);
    const double c = dot(wi, h);
    const dvec3 f(conductor_reflectance(c, eta.x, k.x), conductor_reflectance(c, eta.y, k.y),
                  conductor_reflectance(c, eta.z, k.z));
    return reflectance * f * reflected(microfacets, wi, wo, h);
}

dvec3 RoughDielectricOracle::value(const dvec3 &from, const dvec3 &to) const {
    const dvec3 wi = turned(from, from), wo = turned(to, from);
    const double ratio = from.z < 0 ? 1 / eta : eta;
    if (wo.z > 0) {
        const dvec3 h = glm::normalize(wi + wo);
        return reflectance * dielectric_reflectance(dot(wi, h), ratio) *
               reflected(microfacets, wi, wo, h);
    }
    dvec3 h = glm::normalize(wi + ratio * wo);
    h = h.z < 0 ? -h : h;
    const double ci = dot(wi, h), co = dot(wo, h);
    if (!(ci > 0 && co < 0))
        return dvec3(0);
    // Walter et al., equation 21, times cos_o; radiance carries 1 / eta^2.
    const double focus = ci + ratio * co;
    return transmittance * (1 - dielectric_reflectance(ci, ratio)) * microfacets.d(h) *
           microfacets.g1(wi, h) * microfacets.g1(wo, h) * std::abs(ci * co / wi.z) /
           (focus * focus);
}

double PlasticOracle::transmitted(double cosine) const {
    if (transmittance.empty())
        return 1 - dielectric_reflectance(cosine, eta);
    const double x = cosine * static_cast<double>(transmittance.size() - 1);
    const auto i = std::min(static_cast<std::size_t>(x), transmittance.size() - 2);
    return std::lerp(transmittance[i], transmittance[i + 1], x - static_cast<double>(i));
}

dvec3 PlasticOracle::value(const dvec3 &wi, const dvec3 &wo) const {
    if (!(wi.z > 0 && wo.z > 0))
        return dvec3(0);
    const dvec3 base = diffuse / (1.0 - (nonlinear ? diffuse * internal : dvec3(internal)));
    dvec3 sum = base * transmitted(wi.z) * transmitted(wo.z) * wo.z * inv_pi / (eta * eta);
    if (!transmittance.empty()) {
        const dvec3 h = glm::normalize(wi + wo);
        sum +=
            specular * dielectric_reflectance(dot(wi, h), eta) * reflected(microfacets, wi, wo, h);
    }
    return sum;
}

dvec3 PrincipledOracle::value(const dvec3 &from, const dvec3 &to) const {
    const bool front = from.z > 0;
    const dvec3 wi = turned(from, from), wo = turned(to, from);
    const double ratio = front ? eta : 1 / eta;
    const double glass = (1 - metallic) * spec_trans, opaque = (1 - metallic) * (1 - spec_trans);
    const MicrofacetOracle ggx = burley_ggx(roughness, anisotropic);
    if (wo.z < 0) {
        dvec3 h = glm::normalize(wi + ratio * wo);
        h = h.z < 0 ? -h : h;
        const double ci = dot(wi, h), co = dot(wo, h), focus = ci + ratio * co;
        if (!(ci > 0 && co < 0))
            return dvec3(0);
        return glm::sqrt(base) * glass * (1 - dielectric_reflectance(ci, ratio)) * ggx.d(h) *
               ggx.g1(wi, h) * ggx.g1(wo, h) * std::abs(ci * co / wi.z) / (focus * focus);
    }
    const dvec3 h = glm::normalize(wi + wo);
    const double c = dot(wi, h), fresnel = dielectric_reflectance(c, ratio);
    if (!front)
        return dvec3(glass * fresnel * reflected(ggx, wi, wo, h));

    const double r0 = std::pow((eta - 1) / (eta + 1), 2);
    const dvec3 tinted =
        (1 - metallic) * spec_tint * schlick_reflectance(tint_of(base) * r0, c, eta);
    const dvec3 metal = metallic * schlick_reflectance(base, c, eta);
    const dvec3 main = (1 - metallic) * (1 - spec_tint) * fresnel + metal + tinted;
    dvec3 sum = main * reflected(ggx, wi, wo, h);

    // The clearcoat: GTR1 (Burley 2012, appendix B), masked as GGX with alpha 1/4.
    const double a2 = std::pow(std::lerp(0.1, 0.001, clearcoat_gloss), 2);
    const double gtr1 = (a2 - 1) / (std::numbers::pi * std::log(a2) * (1 + (a2 - 1) * h.z * h.z));
    const MicrofacetOracle quarter{false, 0.25, 0.25};
    sum += clearcoat / 4 * schlick_reflectance(dvec3(0.04), c, eta).x * gtr1 * quarter.g1(wi, h) *
           quarter.g1(wo, h) * wo.z;

    sum += opaque * base * burley_diffuse(wi.z, wo.z, c, roughness, flatness);
    return sum + (1 - metallic) * burley_sheen(base, c, wo.z, sheen, sheen_tint);
}

dvec3 PrincipledThinOracle::value(const dvec3 &from, const dvec3 &to) const {
    const dvec3 wi = turned(from, from), wo = turned(to, from);
    const dvec3 mirrored(wo.x, wo.y, std::abs(wo.z));
    const dvec3 h = glm::normalize(wi + mirrored);
    const double c = dot(wi, h), fresnel = dielectric_reflectance(c, eta);
    const double through = diff_trans / 2;
    if (wo.z < 0) {
        // Scaled roughness: Burley 2015, figure 15.
        const MicrofacetOracle ggx = burley_ggx((0.65 * eta - 0.35) * roughness, anisotropic);
        dvec3 sum = (1 - spec_trans) * through * base * inv_pi * -wo.z;
        if (dot(wo, h) < 0)
            sum += spec_trans * base * (1 - fresnel) * reflected(ggx, wi, mirrored, h);
        return sum;
    }
    const double r0 = std::pow((eta - 1) / (eta + 1), 2);
    const dvec3 f =
        glm::mix(dvec3(fresnel), schlick_reflectance(tint_of(base) * r0, c, eta), spec_tint);
    dvec3 sum = spec_trans * f * reflected(burley_ggx(roughness, anisotropic), wi, wo, h);
    const dvec3 diffuse = base * burley_diffuse(wi.z, wo.z, c, roughness, flatness) +
                          burley_sheen(base, c, wo.z, sheen, sheen_tint);
    return sum + (1 - spec_trans) * (1 - through) * diffuse;
}

} // namespace clrender::test
