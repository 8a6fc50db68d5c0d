/// Light over mirrors and through balls of glass: the same pictures whether it is found by
/// connections or by BSDF sampling alone, and less noise.

#include "render_adapter.h"

#include <catch2/catch.hpp>
#include <numeric>

using namespace clrender;
using namespace clrender::test;

namespace {

const std::string head = R"(<scene version="3.0.0"><integrator type="path">
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

double mean_variance(const MeasuredImage &image) {
    return std::accumulate(image.variance.f32.begin(), image.variance.f32.end(), 0.0);
}

/// The same picture with connections, by MIS and by light sampling alone, as by BSDF sampling;
/// of at most this share of its variance.
void check_connections(const std::string &name, const std::string &shapes, double share) {
    const Scene scene = scene_from_xml(head + shapes + "</scene>");
    const MeasuredImage without =
        render_measured(scene, {.spp = 2048, .seed = 1, .specular_connections = false});
    const MeasuredImage with = render_measured(scene, {.spp = 512, .seed = 2});
    const NamedVerdict verdict = compare_or_save(name, with, without);
    INFO(verdict.summary);
    CHECK(verdict.passes);
    CHECK(mean_variance(with) < 4 * share * mean_variance(without));
    const MeasuredImage alone =
        render_measured(scene, {.spp = 512, .seed = 3, .strategy = Strategy::light});
    const NamedVerdict light = compare_or_save(name + "_light", alone, with);
    INFO(light.summary);
    CHECK(light.passes);
}

} // namespace

TEST_CASE("light over a mirror ball is connected") {
    check_connections("connections_mirror",
                      sphere("0,1,0", 1, mirror) + sphere("2,2.5,1", 0.3, lamp), 0.2);
}

TEST_CASE("light through a ball of glass is connected") {
    check_connections("connections_glass",
                      sphere("0,1.1,0", 1, glass) + sphere("2,3.5,1", 0.3, lamp), 0.5);
}

TEST_CASE("light over two-sided plane mirrors is connected") {
    check_connections(
        "connections_planes",
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
    check_connections("connections_several",
                      sphere("-1.3,0.6,0", 0.6, mirror) + sphere("0.2,0.7,0.6", 0.7, glass) +
                          sphere("0.3,0.6,0.6", 0.3, "<bsdf type=\"diffuse\"/>") +
                          sphere("1.6,0.5,0.4", 0.5, gold) + sphere("-0.4,0.5,2", 0.5, glass) +
                          sphere("-0.4,0.6,2", 0.1, lamp) + sphere("2,2.5,1", 0.3, lamp),
                      1.2);
}
