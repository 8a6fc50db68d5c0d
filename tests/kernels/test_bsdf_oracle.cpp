/// The oracle of the BSDFs against values that Mitsuba 3 has computed (data/make_bsdf_values.py).

#include "bsdf_oracle.h"
#include "flatten/plastic_boundary.h"

#include <catch2/catch.hpp>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

using namespace clrender;
using namespace clrender::test;
using glm::dvec3;

namespace {

/// A line of the table: the material and its numbers, taken one after the other.
class Line {
public:
    explicit Line(const std::string &text) : in_(text) { std::getline(in_, material_, ','); }

    [[nodiscard]] const std::string &material() const { return material_; }
    double number() {
        std::string text;
        REQUIRE(std::getline(in_, text, ','));
        return std::stod(text);
    }
    dvec3 vector() {
        const double x = number(), y = number();
        return {x, y, number()};
    }

private:
    std::istringstream in_;
    std::string material_;
};

struct Situation {
    dvec3 wi, wo, expected;
};

Situation situation(Line &line) {
    const dvec3 wi = line.vector(), wo = line.vector();
    return {wi, wo, line.vector()};
}

MicrofacetOracle anisotropic(Line &line) {
    const bool beckmann = line.number() > 0.5;
    const double alpha_u = line.number();
    return {beckmann, alpha_u, line.number()};
}

RoughConductorOracle roughconductor(Line &line) {
    RoughConductorOracle bsdf{anisotropic(line)};
    bsdf.eta = line.vector();
    bsdf.k = line.vector();
    bsdf.reflectance = line.vector();
    return bsdf;
}

RoughDielectricOracle roughdielectric(Line &line) {
    RoughDielectricOracle bsdf{anisotropic(line), line.number()};
    bsdf.reflectance = line.vector();
    bsdf.transmittance = line.vector();
    return bsdf;
}

PlasticOracle plastic(Line &line) {
    PlasticOracle bsdf;
    bsdf.diffuse = line.vector();
    bsdf.specular = line.vector();
    bsdf.eta = line.number();
    bsdf.nonlinear = line.number() > 0.5;
    bsdf.internal = internal_reflectance(bsdf.eta);
    return bsdf;
}

PlasticOracle roughplastic(Line &line) {
    const bool beckmann = line.number() > 0.5;
    const double alpha = line.number();
    PlasticOracle bsdf = plastic(line);
    bsdf.microfacets = {beckmann, alpha, alpha};
    const RoughBoundary boundary = rough_boundary(beckmann, alpha, bsdf.eta);
    bsdf.internal = boundary.internal_reflectance;
    bsdf.transmittance = boundary.transmittance;
    return bsdf;
}

PrincipledOracle principled(Line &line) {
    PrincipledOracle bsdf{line.vector()};
    for (double PrincipledOracle::*parameter :
         {&PrincipledOracle::roughness, &PrincipledOracle::anisotropic, &PrincipledOracle::metallic,
          &PrincipledOracle::spec_trans, &PrincipledOracle::eta, &PrincipledOracle::spec_tint,
          &PrincipledOracle::sheen, &PrincipledOracle::sheen_tint, &PrincipledOracle::flatness,
          &PrincipledOracle::clearcoat, &PrincipledOracle::clearcoat_gloss})
        bsdf.*parameter = line.number();
    return bsdf;
}

PrincipledThinOracle principledthin(Line &line) {
    using Thin = PrincipledThinOracle;
    Thin bsdf{line.vector()};
    for (double Thin::*parameter :
         {&Thin::roughness, &Thin::anisotropic, &Thin::spec_trans, &Thin::eta, &Thin::spec_tint,
          &Thin::sheen, &Thin::sheen_tint, &Thin::flatness, &Thin::diff_trans})
        bsdf.*parameter = line.number();
    return bsdf;
}

} // namespace

TEST_CASE("the BSDFs' oracle has the values of Mitsuba 3") {
    std::ifstream file(std::string(CLRENDER_TEST_DIR) + "/kernels/data/bsdf_values.csv");
    std::map<std::string, int> seen;
    const auto check = [&](Line &line, const auto &bsdf, double bar) {
        const Situation s = situation(line);
        const dvec3 found = bsdf.value(s.wi, s.wo);
        for (int c = 0; c < 3; ++c) {
            CHECK(std::abs(found[c] - s.expected[c]) <= bar * std::abs(s.expected[c]) + 1e-7);
            seen[line.material()] += s.expected[c] > 0 ? 1 : 0;
        }
    };
    for (std::string text; std::getline(file, text);) {
        Line line(text);
        INFO(text);
        const std::string &material = line.material();
        // In single precision, with 7 digits; the rough boundary's table is integrated otherwise.
        if (material == "roughconductor")
            check(line, roughconductor(line), 3e-5);
        else if (material == "roughdielectric")
            check(line, roughdielectric(line), 3e-5);
        else if (material == "plastic")
            check(line, plastic(line), 3e-5);
        else if (material == "roughplastic")
            check(line, roughplastic(line), 1e-3);
        else if (material == "principled")
            check(line, principled(line), 3e-5);
        else
            check(line, principledthin(line), 3e-5);
    }
    for (const char *material : {"roughconductor", "roughdielectric", "plastic", "roughplastic",
                                 "principled", "principledthin"})
        CHECK(seen[material] > 100);
}
