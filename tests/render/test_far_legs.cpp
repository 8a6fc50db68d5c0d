/// Camera rays that come from far away in several legs, at the device's width, against the same
/// picture in double precision, with one lane: lanes are in different legs where some see a ball
/// and others the sky.

#include "render_adapter.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace clrender;
using namespace clrender::test;

namespace {

constexpr int block = 8;

std::string sphere(const glm::dvec3 &center, double radius, const std::string &surface = "") {
    return fmt::format(R"(<shape type="sphere"><point name="center" x="{:.17g}" y="{:.17g}"
        z="{:.17g}"/><float name="radius" value="{:.17g}"/>{}</shape>)",
                       center.x, center.y, center.z, radius, surface);
}

std::string lamp(double radiance) {
    return fmt::format(
        R"(<emitter type="area"><rgb name="radiance" value="{0} {0} {1}"/></emitter>)", radiance,
        0.7 * radiance);
}

/// Balls, of glass and as small as .02, and a cube beside the origin; seen from `eye`, where
/// `width` of them fills the picture.
std::string near_things(const glm::dvec3 &eye, double width) {
    const double distance = glm::length(eye - glm::dvec3(0, 0.4, 0));
    return fmt::format(R"(<integrator type="path"><integer name="max_depth" value="5"/></integrator>
        <sensor type="perspective"><float name="fov" value="{:.17g}"/>
        <transform name="to_world"><lookat origin="{:.17g} {:.17g} {:.17g}" target="0 .4 0"
        up="0 1 0"/></transform><film type="hdrfilm"><integer name="width" value="48"/>
        <integer name="height" value="32"/><rfilter type="box"/></film></sensor>
        <shape type="cube"><transform name="to_world"><scale value=".2"/><rotate y="1" angle="30"/>
        <translate x="1" y=".2" z="-.3"/></transform></shape>
        <emitter type="constant"><rgb name="radiance" value=".3 .4 .6"/></emitter>)",
                       2 * std::atan(width / 2 / distance) * 180 / std::numbers::pi, eye.x, eye.y,
                       eye.z) +
           sphere({0, 0.5, 0}, 0.5) + sphere({0.8, 0.02, 0.6}, 0.02) +
           sphere({-0.9, 0.3, 0.4}, 0.3, R"(<bsdf type="dielectric"/>)");
}

/// The largest difference of the means of 8x8 blocks, relative to the exact one; infinite where
/// anything is not finite or a block is black.
double worst_block(const Image &image, const Image &exact) {
    double worst = 0;
    for (int y = 0; y + block <= image.height; y += block)
        for (int x = 0; x + block <= image.width; x += block)
            for (int c = 0; c < 3; ++c) {
                double sum = 0, sum_exact = 0;
                for (int i = 0; i < block * block; ++i) {
                    sum += value_at(image, x + i % block, y + i / block, c);
                    sum_exact += value_at(exact, x + i % block, y + i / block, c);
                }
                const double error = std::abs(sum / sum_exact - 1);
                worst = std::isfinite(error) ? std::max(worst, error) : INFINITY;
            }
    return worst;
}

/// The figure of one scene, which the bar is 10% for; what is left is a few paths that part.
void check_against_oracle(const std::string &xml) {
    const Scene scene = scene_from_xml(xml);
    const Image single = render_measured(scene, {.spp = 16}).mean;
    const Image exact = render_measured(scene, {.spp = 16, .double_precision = true}).mean;
    const double worst = worst_block(single, exact);
    INFO("worst block " << worst);
    CHECK(worst < 0.02);
}

} // namespace

TEST_CASE("a narrow view from far away keeps its picture") {
    const double far = GENERATE(1e4, 1e8);
    INFO(far);
    check_against_oracle(near_things({0, 0.3 * far, far}, 2.9) + sphere({2, 3, 2}, 0.2, lamp(60)) +
                         R"(<shape type="rectangle"><transform name="to_world"><scale value="6"/>
        <rotate x="1" angle="-90"/></transform></shape>)");
}
