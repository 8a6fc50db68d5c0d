/// Light over mirrors and through balls of glass: the same pictures whether it is found by
/// connections or by BSDF sampling alone, and less noise.

#include "render_adapter.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

using namespace clrender;
using namespace clrender::test;

namespace {

const std::string head = R"(<integrator type="path">
    <integer name="max_depth" value="6"/><integer name="rr_depth" value="1000"/></integrator>
    <sensor type="perspective"><float name="fov" value="50"/><transform name="to_world">
    <lookat origin="0,3,6" target="0,0.5,0" up="0,1,0"/></transform><film type="hdrfilm">
    <integer name="width" value="48"/><integer name="height" value="36"/><rfilter type="box"/>
    </film></sensor><shape type="rectangle"><transform name="to_world"><scale value="6"/>
    <rotate x="1" angle="-90"/></transform><bsdf type="diffuse"/></shape>)";

std::string sphere(const std::string &center, double radius, const std::string &surface) {
    return "<shape type=\"sphere\"><point name=\"center\" value=\"" + center +
           "\"/><float name=\"radius\" value=\"" + std::to_string(radius) + "\"/>" + surface +
           "</shape>";
}

std::string rectangle(const std::string &place, const std::string &surface) {
    return "<shape type=\"rectangle\"><transform name=\"to_world\">" + place + "</transform>" +
           surface + "</shape>";
}

const std::string mirror = R"(<bsdf type="conductor"><string name="material" value="none"/>
    <rgb name="specular_reflectance" value="0.9,0.8,0.7"/></bsdf>)";
const std::string gold = R"(<bsdf type="conductor"><string name="material" value="Au"/></bsdf>)";
const std::string glass = R"(<bsdf type="dielectric"><float name="int_ior" value="1.5"/>
    <float name="ext_ior" value="1"/>
    <rgb name="specular_transmittance" value="0.9,1,0.8"/></bsdf>)";
const std::string lamp =
    R"(<emitter type="area"><rgb name="radiance" value="20,18,15"/></emitter>)";

/// Of each block of 8x6 pixels and channel: the mean over some seeds and the square of its
/// standard error. Light that BSDF sampling finds rarely is in few pixels, so single pixels are
/// far from normally distributed.
struct Blocks {
    std::vector<double> mean, error2;
};

Blocks render_blocks(const Scene &scene, TestRender how, unsigned seeds) {
    constexpr int width = 48, across = 6, pixels = 48;
    Blocks blocks;
    std::vector<double> squares;
    for (unsigned k = 0; k < seeds; ++k, ++how.seed) {
        const Image image = render_measured(scene, how).mean;
        std::vector<double> sums(across * 6 * 3);
        for (std::size_t i = 0; i < image.f32.size(); ++i) {
            const auto pixel = static_cast<int>(i / 3);
            const int block = pixel / width / 6 * across + pixel % width / 8;
            sums[static_cast<std::size_t>(block) * 3 + i % 3] += double{image.f32[i]} / pixels;
        }
        blocks.mean.resize(sums.size());
        squares.resize(sums.size());
        for (std::size_t i = 0; i < sums.size(); ++i) {
            blocks.mean[i] += sums[i] / seeds;
            squares[i] += sums[i] * sums[i] / seeds;
        }
    }
    for (std::size_t i = 0; i < squares.size(); ++i)
        blocks.error2.push_back(std::max(squares[i] - blocks.mean[i] * blocks.mean[i], 0.0) /
                                (seeds - 1));
    return blocks;
}

/// The root of the mean z^2 of the blocks' differences, and the largest |z|.
void check_same_blocks(const Blocks &a, const Blocks &b) {
    double sum = 0, worst = 0;
    for (std::size_t i = 0; i < a.mean.size(); ++i) {
        const double z =
            std::abs(a.mean[i] - b.mean[i]) / std::sqrt(a.error2[i] + b.error2[i] + 1e-12);
        sum += z * z / static_cast<double>(a.mean.size());
        worst = z <= worst ? worst : z; // NaN stays
    }
    INFO("mean z^2 " << sum << ", worst |z| " << worst);
    CHECK(sum < 1.6);
    CHECK(worst < 6);
}

/// The mean over the blocks of the square of the relative error.
double mean_error2(const Blocks &blocks) {
    double sum = 0;
    for (std::size_t i = 0; i < blocks.mean.size(); ++i)
        sum += blocks.error2[i] / (blocks.mean[i] * blocks.mean[i] + 1e-4);
    return sum / static_cast<double>(blocks.mean.size());
}

/// The same picture with connections, by MIS and by light sampling alone, as by BSDF sampling;
/// of at most this share of its variance.
void check_connections(const std::string &shapes, double share) {
    const Scene scene = scene_from_xml(head + shapes);
    constexpr unsigned seeds = 24;
    const Blocks without =
        render_blocks(scene, {.spp = 1024, .seed = 1, .specular_connections = false}, seeds);
    const Blocks with = render_blocks(scene, {.spp = 256, .seed = 101}, seeds);
    check_same_blocks(with, without);
    CHECK(mean_error2(with) < 4 * share * mean_error2(without));
    const Blocks alone =
        render_blocks(scene, {.spp = 256, .seed = 201, .strategy = Strategy::light}, seeds);
    check_same_blocks(alone, with);
}

} // namespace

TEST_CASE("light over a mirror ball is connected") {
    check_connections(sphere("0,1,0", 1, mirror) + sphere("2,2.5,1", 0.3, lamp), 0.8);
}

TEST_CASE("light through a ball of glass is connected") {
    check_connections(sphere("0,1.1,0", 1, glass) + sphere("2,3.5,1", 0.8, lamp), 0.85);
}

TEST_CASE("light over two-sided plane mirrors is connected") {
    check_connections(
        rectangle(R"(<scale x="1" y="1.5"/><rotate y="1" angle="60"/>
            <translate x="-2" y="1.2" z="-1"/>)",
                  "<bsdf type=\"twosided\">" + mirror + "</bsdf>") +
            rectangle(R"(<scale value="0.2"/><rotate x="1" angle="90"/><translate x="1" y="3"/>)",
                      lamp) +
            rectangle(R"(<scale value="0.1"/><rotate y="1" angle="90"/>
                <translate x="-4" y="1" z="0.5"/>)",
                      lamp),
        0.2);
}

TEST_CASE("several balls and lamps are connected, but for what lies within a ball") {
    check_connections(sphere("-1.3,0.6,0", 0.6, mirror) + sphere("0.2,0.7,0.6", 0.7, glass) +
                          sphere("0.3,0.6,0.6", 0.3, "<bsdf type=\"diffuse\"/>") +
                          sphere("1.6,0.5,0.4", 0.5, gold) + sphere("-0.4,0.5,2", 0.5, glass) +
                          sphere("-0.4,0.6,2", 0.1, lamp) + sphere("2,2.5,1", 0.3, lamp),
                      1.2);
}
