/// The kernels' BSDFs: values against an oracle in double precision, samples against their density,
/// integrals of densities.

#include "bsdf_oracle.h"
#include "bsdf_probe.h"
#include "flatten/plastic_boundary.h"
#include "selftest/check.h"
#include "sphere_cells.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <numeric>
#include <string>

using namespace clrender;
using namespace clrender::test;
using glm::dvec3;
using selftest::Random;

namespace {

/// A material for both sides of the comparison.
struct Tested {
    std::string description;
    ProbedBsdf probed;
    std::function<dvec3(const dvec3 &wi, const dvec3 &wo)> value; ///< the oracle's
    double narrow;   ///< width of its narrowest lobe, radians
    double bend = 0; ///< index of refraction of what it transmits, 0 if nothing
};

/// Parameters of one material, drawn from a sequence; `widest` holds them to the ends of the ranges
/// that pictures are promised for.
struct Draw {
    Random &random;
    bool widest;

    double share() const { return random.between(0, 1); }
    /// Often 0, often 1.
    double rate() const {
        const double u = random.between(-0.3, 1.2);
        return std::clamp(u, 0.0, 1.0);
    }
    double alpha() const {
        if (widest && share() < 0.2)
            return share() < 0.5 ? 0 : 1;
        return std::pow(10, random.between(widest ? -4 : -2, 0));
    }
    double eta() const {
        const double eta = widest ? std::exp(random.between(std::log(0.2), std::log(5)))
                                  : random.between(0.6, 2.5);
        return std::abs(eta - 1) < 0.02 ? 1.3 : eta;
    }
    /// Below 1 reflection is total at some angles: samples of transmission with weight 0, which the
    /// test of densities would take for rejected.
    double eta_of_sheet() const {
        const double any = eta();
        return widest ? any : std::max(any, 1 / any);
    }
    dvec3 colour() const {
        const double r = share(), g = share();
        return {r, g, share()};
    }
};

constexpr double least_alpha = 1e-4;

uint microfacet_flags(bool beckmann) {
    return beckmann ? CLR_BSDF_BECKMANN : CLR_BSDF_GGX;
}

MicrofacetOracle microfacets(const Draw &draw) {
    const bool beckmann = draw.share() < 0.5;
    const double alpha_u = draw.alpha();
    return {beckmann, alpha_u, draw.share() < 0.5 ? alpha_u : draw.alpha()};
}

MicrofacetOracle held(MicrofacetOracle m) {
    m.alpha_u = std::max(m.alpha_u, least_alpha);
    m.alpha_v = std::max(m.alpha_v, least_alpha);
    return m;
}

dvec3 number(double x) {
    return {x, 0, 0};
}

dvec3 ratio(double eta) {
    return {eta, 1 / eta, 0};
}

Tested roughconductor(const Draw &draw) {
    const MicrofacetOracle m = microfacets(draw);
    const RoughConductorOracle oracle{held(m), 3.0 * draw.colour() + 0.1, 4.0 * draw.colour(),
                                      draw.colour()};
    return {fmt::format("roughconductor {} {} {}", m.beckmann, m.alpha_u, m.alpha_v),
            {CLR_BSDF_ROUGHCONDUCTOR | microfacet_flags(m.beckmann),
             {number(m.alpha_u), number(m.alpha_v), oracle.reflectance, oracle.eta, oracle.k}},
            [=](const dvec3 &wi, const dvec3 &wo) { return oracle.value(wi, wo); },
            std::min(oracle.microfacets.alpha_u, oracle.microfacets.alpha_v)};
}

Tested roughdielectric(const Draw &draw) {
    const MicrofacetOracle m = microfacets(draw);
    const RoughDielectricOracle oracle{held(m), draw.eta(), draw.colour(), draw.colour()};
    return {fmt::format("roughdielectric {} {} {} eta {}", m.beckmann, m.alpha_u, m.alpha_v,
                        oracle.eta),
            {CLR_BSDF_ROUGHDIELECTRIC | microfacet_flags(m.beckmann),
             {number(m.alpha_u), number(m.alpha_v), oracle.reflectance, oracle.transmittance,
              ratio(oracle.eta)}},
            [=](const dvec3 &wi, const dvec3 &wo) { return oracle.value(wi, wo); },
            std::min(oracle.microfacets.alpha_u, oracle.microfacets.alpha_v),
            oracle.eta};
}

PlasticOracle plastic_oracle(const Draw &draw) {
    PlasticOracle oracle;
    oracle.diffuse = draw.colour();
    oracle.specular = draw.colour();
    oracle.eta = draw.eta_of_sheet();
    oracle.nonlinear = draw.share() < 0.5;
    oracle.internal = internal_reflectance(oracle.eta);
    return oracle;
}

Tested plastic(const Draw &draw) {
    const PlasticOracle oracle = plastic_oracle(draw);
    return {fmt::format("plastic eta {}", oracle.eta),
            {CLR_BSDF_PLASTIC | (oracle.nonlinear ? CLR_BSDF_NONLINEAR : 0U),
             {oracle.diffuse, oracle.specular, {oracle.eta, 1 / oracle.eta, oracle.internal}}},
            [=](const dvec3 &wi, const dvec3 &wo) { return oracle.value(wi, wo); },
            0.3};
}

Tested roughplastic(const Draw &draw) {
    PlasticOracle oracle = plastic_oracle(draw);
    const double alpha = draw.alpha();
    const bool beckmann = draw.share() < 0.5;
    oracle.microfacets = held({beckmann, alpha, alpha});
    const RoughBoundary boundary = rough_boundary(beckmann, oracle.microfacets.alpha_u, oracle.eta);
    oracle.transmittance = boundary.transmittance;
    oracle.internal = boundary.internal_reflectance;
    return {fmt::format("roughplastic {} {} eta {}", beckmann, alpha, oracle.eta),
            {CLR_BSDF_ROUGHPLASTIC | microfacet_flags(beckmann) |
                 (oracle.nonlinear ? CLR_BSDF_NONLINEAR : 0U),
             {oracle.diffuse,
              oracle.specular,
              {oracle.eta, 1 / oracle.eta, oracle.internal},
              number(alpha)},
             boundary.transmittance},
            [=](const dvec3 &wi, const dvec3 &wo) { return oracle.value(wi, wo); },
            oracle.microfacets.alpha_u};
}

Tested principled(const Draw &draw) {
    PrincipledOracle o{draw.colour(), draw.alpha(), draw.rate(), draw.rate(),
                       draw.rate(),   draw.eta(),   draw.rate(), draw.rate(),
                       draw.rate(),   draw.rate(),  draw.rate(), draw.rate()};
    const double narrowest = std::min(1e-3 + 0.1 * (1 - o.clearcoat_gloss),
                                      std::max(1e-3, o.roughness * o.roughness * 0.3));
    return {fmt::format("principled roughness {} anisotropic {} metallic {} spec_trans {} eta {} "
                        "clearcoat {} {}",
                        o.roughness, o.anisotropic, o.metallic, o.spec_trans, o.eta, o.clearcoat,
                        o.clearcoat_gloss),
            {CLR_BSDF_PRINCIPLED | CLR_BSDF_GGX,
             {o.base, number(o.roughness), number(o.anisotropic), number(o.metallic),
              number(o.spec_trans), ratio(o.eta), number(o.spec_tint), number(o.sheen),
              number(o.sheen_tint), number(o.flatness), number(o.clearcoat),
              number(o.clearcoat_gloss)}},
            [=](const dvec3 &wi, const dvec3 &wo) { return o.value(wi, wo); },
            narrowest,
            // Metal has no back.
            o.spec_trans > 0 && o.metallic < 1 ? o.eta : 0};
}

Tested principledthin(const Draw &draw) {
    PrincipledThinOracle o{draw.colour(),       draw.alpha(),   draw.rate(), draw.rate(),
                           draw.eta_of_sheet(), draw.rate(),    draw.rate(), draw.rate(),
                           draw.rate(),         2 * draw.rate()};
    return {fmt::format("principledthin roughness {} anisotropic {} spec_trans {} eta {}",
                        o.roughness, o.anisotropic, o.spec_trans, o.eta),
            {CLR_BSDF_PRINCIPLEDTHIN | CLR_BSDF_GGX,
             {o.base, number(o.roughness), number(o.anisotropic), number(o.spec_trans),
              number(o.eta), number(o.spec_tint), number(o.sheen), number(o.sheen_tint),
              number(o.flatness), number(o.diff_trans)}},
            [=](const dvec3 &wi, const dvec3 &wo) { return o.value(wi, wo); },
            std::max(1e-3, o.roughness * o.roughness * 0.1),
            1};
}

const std::vector<Tested (*)(const Draw &)> materials{
    roughconductor, roughdielectric, plastic, roughplastic, principled, principledthin};

BsdfProbe &probe() {
    static BsdfProbe *const all = new BsdfProbe;
    return *all;
}

dvec3 direction(double cosine, double turn) {
    const double sine = std::sqrt(1 - cosine * cosine);
    return {sine * std::cos(turn), sine * std::sin(turn), cosine};
}

/// Where a smooth surface would send what comes from wi: mirrored, and refracted (into the other
/// side, straight on where reflection is total).
dvec3 mirrored(const dvec3 &wi) {
    return {-wi.x, -wi.y, wi.z};
}
dvec3 refracted(const dvec3 &wi, double eta) {
    const double ratio = wi.z > 0 ? eta : 1 / eta;
    const dvec3 across = dvec3(-wi.x, -wi.y, 0) / ratio;
    const double cosine2 = 1 - glm::dot(across, across);
    if (!(cosine2 > 0))
        return -wi;
    return across + dvec3(0, 0, std::copysign(std::sqrt(cosine2), -wi.z));
}

dvec3 rounded(const dvec3 &v, bool is_double) {
    return is_double ? v : dvec3(glm::vec3(v));
}

/// Pairs of directions, most of them within the lobes, down to cosines of 1e-6.
std::vector<BsdfQuery> queries(const Tested &tested, Random &random, std::size_t count,
                               bool is_double) {
    std::vector<BsdfQuery> all;
    for (std::size_t i = 0; i < count; ++i) {
        const double cosine =
            i % 5 == 0 ? std::pow(10, random.between(-6, 0)) : random.between(0.02, 1);
        const bool from_back = tested.bend > 0 && i % 2 == 1;
        const dvec3 wi = direction(from_back ? -cosine : cosine, random.between(0, 6.3));
        dvec3 wo = tested.bend > 0 && i % 3 == 0 ? refracted(wi, tested.bend) : mirrored(wi);
        const double off = i % 7 == 0 ? 1 : tested.narrow * random.between(0, 3);
        wo = glm::normalize(wo + off * random.direction());
        all.push_back({rounded(wi, is_double),
                       rounded(wo, is_double),
                       {random.unit(), random.unit(), random.unit()}});
    }
    return all;
}

/// What a change of each coordinate by one unit in the last place changes the oracle's value by.
dvec3 wobble(const Tested &tested, const BsdfQuery &query, bool is_double) {
    const dvec3 here = tested.value(query.wi, query.wo);
    dvec3 sum(0);
    for (const bool of_wo : {false, true})
        for (int c = 0; c < 3; ++c) {
            BsdfQuery moved = query;
            double &x = of_wo ? moved.wo[c] : moved.wi[c];
            x += is_double ? selftest::ulp(x) * 0x1p-29 : selftest::ulp(x);
            sum += glm::abs(tested.value(moved.wi, moved.wo) - here);
        }
    return sum;
}

void expect_oracle(Tested (*material)(const Draw &), int lanes, bool is_double) {
    Random random(21);
    const double bar = is_double ? 1e-9 : 1e-4;
    for (int set = 0; set < (small_tests() ? 2 : 40); ++set) {
        const Tested tested = material({random, set % 2 == 0});
        const auto asked = queries(tested, random, small_tests() ? 16 : 500, is_double);
        const auto answers = probe().run(tested.probed, asked, lanes, is_double);
        INFO(tested.description << ", " << lanes << " lanes" << (is_double ? ", double" : ""));
        for (std::size_t i = 0; i < asked.size(); ++i) {
            const BsdfQuery &q = asked[i];
            const BsdfAnswer &a = answers[i];
            const dvec3 exact = tested.value(q.wi, q.wo);
            const dvec3 allowed = bar * exact + 8.0 * wobble(tested, q, is_double) + 1e-12;
            const dvec3 error = glm::abs(a.value - exact);
            const bool close = error.x <= allowed.x && error.y <= allowed.y && error.z <= allowed.z;
            const bool finite = std::isfinite(a.pdf) &&
                                std::isfinite(glm::dot(a.weight, a.weight)) &&
                                std::abs(glm::length(a.sampled) - 1) < 1e-5 && a.pdf >= 0 &&
                                a.sampled_pdf >= 0 && std::isfinite(a.eta);
            if (!close || !finite) {
                INFO(fmt::format("wi {} {} {} wo {} {} {}: {} {} {}, expected {} {} {}, pdf {}, "
                                 "weight {} {} {}",
                                 q.wi.x, q.wi.y, q.wi.z, q.wo.x, q.wo.y, q.wo.z, a.value.x,
                                 a.value.y, a.value.z, exact.x, exact.y, exact.z, a.pdf, a.weight.x,
                                 a.weight.y, a.weight.z));
                CHECK(close);
                CHECK(finite);
                return;
            }
        }
        CHECK(asked.size() == answers.size());
    }
}

/// Samples of one material seen from `wi` against its density.
void expect_density(const Tested &tested, const dvec3 &wi, Random &random) {
    constexpr int lanes = 8;
    const std::size_t count = small_tests() ? 1000 : 100000;
    std::vector<BsdfQuery> asked;
    for (std::size_t i = 0; i < count; ++i)
        asked.push_back({wi, mirrored(wi), {random.unit(), random.unit(), random.unit()}});
    const dvec3 reflection = mirrored(wi);
    const dvec3 transmission = refracted(wi, tested.bend > 0 ? tested.bend : 1);
    const SphereCells cells(wi.z > 0 ? reflection : transmission,
                            wi.z > 0 ? transmission : reflection, tested.narrow);
    std::vector<double> counts(cells.count());
    double rejected = 0, delta = 0;
    for (const BsdfAnswer &a : probe().run(tested.probed, asked, lanes)) {
        if (std::isinf(a.sampled_pdf))
            ++delta;
        else if (a.weight == dvec3(0))
            ++rejected;
        else
            ++counts[cells.cell_of(a.sampled)];
    }
    const auto densities = [&](const std::vector<dvec3> &directions) {
        std::vector<BsdfQuery> at;
        at.reserve(directions.size());
        for (const dvec3 &wo : directions)
            at.push_back({wi, wo});
        std::vector<double> values;
        for (const BsdfAnswer &a : probe().run(tested.probed, at, lanes))
            values.push_back(a.pdf);
        return values;
    };
    std::vector<double> expected = cells.integrate(densities, 3e-6);
    const double integral = std::accumulate(expected.begin(), expected.end(), 0.0);
    const auto n = static_cast<double>(count);
    for (double &value : expected)
        value *= n;
    const double lost = (rejected + delta) / n;
    INFO(tested.description << ", wi " << wi.x << ' ' << wi.y << ' ' << wi.z << ", rejected "
                            << rejected / n << ", delta " << delta / n << ", integral "
                            << integral);
    // One in a hundred suites of a thousand such tests goes beyond this.
    CHECK(selftest::chi_square_deviation(counts, expected) < 4.4);
    CHECK(std::abs(integral + lost - 1) < 1e-3 + 4 * std::sqrt(lost * (1 - lost) / n));
}

} // namespace

TEST_CASE("BSDFs have the values of an oracle, and are finite for all parameters", "[oclgrind]") {
    const auto material = GENERATE(range(std::size_t{0}, materials.size()));
    for (const int lanes : {1, 16})
        expect_oracle(materials[material], lanes, false);
    expect_oracle(materials[material], 1, true);
}

TEST_CASE("samples of BSDFs have their density") {
    const auto material = GENERATE(range(std::size_t{0}, materials.size()));
    Random random(4 + static_cast<std::uint32_t>(material));
    for (int set = 0; set < (small_tests() ? 1 : 20); ++set) {
        const Tested tested = materials[material]({random, false});
        for (const double cosine : {1.0, 0.8, 0.4, 0.1, 0.01}) {
            const bool back = tested.bend > 0 && (set + (cosine < 0.5 ? 1 : 0)) % 2 == 1;
            expect_density(tested, rounded(direction(back ? -cosine : cosine, 1 + set), false),
                           random);
        }
    }
}

TEST_CASE("BSDFs without transmission are reciprocal") {
    Random random(8);
    for (const auto material : {roughconductor, plastic, roughplastic, principled, principledthin})
        for (int set = 0; set < 50; ++set) {
            const Tested tested = material({random, true});
            const dvec3 wi = direction(random.between(0.05, 1), random.between(0, 6.3));
            const dvec3 wo = direction(random.between(0.05, 1), random.between(0, 6.3));
            const auto answers = probe().run(tested.probed, {{wi, wo}, {wo, wi}}, 1, true);
            const dvec3 there = answers[0].value / wo.z, back = answers[1].value / wi.z;
            INFO(tested.description);
            CHECK(glm::length(there - back) <= 1e-9 * glm::length(there) + 1e-12);
        }
}
