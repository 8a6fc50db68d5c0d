/// Pictures in double precision: against closed forms, against themselves at another scale, and as
/// what single precision is measured by.

#include "render_adapter.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

using namespace clrender;
using namespace clrender::test;

namespace {

constexpr int size = 16;

std::string camera(const std::string &origin, const std::string &target, const std::string &up,
                   int fov = 40, const std::string &then = "") {
    return fmt::format(R"(<sensor type="perspective"><float name="fov" value="{}"/>
        <transform name="to_world"><lookat origin="{}" target="{}" up="{}"/>{}</transform>
        <film type="hdrfilm"><integer name="width" value="{}"/><integer name="height" value="{}"/>
        <rfilter type="box"/></film></sensor>)",
                       fov, origin, target, up, then, size, size);
}

/// How far the pictures are apart, pixel by pixel: the largest difference of a channel, relative to
/// the pixel's brightest one. Infinite where one of them is not finite.
std::vector<double> relative_differences(const Image &a, const Image &b) {
    std::vector<double> differences;
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x) {
            double largest = 0, brightest = 0;
            bool finite = true;
            for (int c = 0; c < 3; ++c) {
                const double va = value_at(a, x, y, c), vb = value_at(b, x, y, c);
                finite = finite && std::isfinite(va) && std::isfinite(vb);
                largest = std::max(largest, std::abs(va - vb));
                brightest = std::max({brightest, std::abs(va), std::abs(vb)});
            }
            differences.push_back(!finite ? INFINITY : brightest > 0 ? largest / brightest : 0);
        }
    std::sort(differences.begin(), differences.end());
    return differences;
}

/// The share of the pixels that are apart by more than `tolerance`.
double share_above(const std::vector<double> &sorted, double tolerance) {
    const auto first = std::upper_bound(sorted.begin(), sorted.end(), tolerance);
    return static_cast<double>(sorted.end() - first) / static_cast<double>(sorted.size());
}

/// The camera within a cluster of mirrors and glass, mostly balls: each reflection by one magnifies
/// what rounding has changed of a direction by about the distance over the radius. Among them a
/// rectangle, a disk, a cube and a mesh with vertex normals. All of it scaled by `s` and turned by
/// an `angle`, the sky as well.
Scene hall_of_mirrors(double s, double angle) {
    const std::string mirror =
        R"(<bsdf type="conductor"><string name="material" value="none"/></bsdf>)";
    const std::string glass = R"(<bsdf type="dielectric"/>)";
    const std::string turned = fmt::format(R"(<rotate x=".6" y=".8" angle="{}"/>)", angle);
    const std::string placed = fmt::format(R"(<scale value="{:.17g}"/>)", s) + turned;
    const std::map<int, std::string> others = {
        {3, R"(<shape type="rectangle">)"},
        {5, R"(<shape type="cube">)"},
        {8, R"(<shape type="disk">)"},
        {10, R"(<shape type="obj"><string name="filename" value="data/blob.obj"/>)"}};
    std::string xml = R"(<integrator type="path"><integer name="max_depth" value="20"/>
        <integer name="rr_depth" value="1000"/></integrator>)" +
                      camera("0 0 0", ".3 .4 1", "0 1 0", 110, turned) +
                      R"(<emitter type="envmap"><string name="filename" value="data/waves.jpg"/>
        <transform name="to_world">)" +
                      turned + "</transform></emitter>";
    for (int i = 0; i < 14; ++i) {
        // On a sphere around the camera, where they nearly touch.
        const double turn = 2.39996 * i, height = 1 - (2 * i + 1) / 14.0;
        const double around = std::sqrt(1 - height * height);
        const auto other = others.find(i);
        xml += other != others.end() ? other->second : R"(<shape type="sphere">)";
        xml += fmt::format(R"(<transform name="to_world"><scale value="{}"/>
            <rotate x="1" angle="{}"/><rotate y="1" angle="{}"/>
            <translate x="{:.17g}" y="{:.17g}" z="{:.17g}"/>{}</transform>{}</shape>)",
                           other != others.end() ? 0.35 : 0.45, 25 * i, 40 * i,
                           around * std::cos(turn), height, around * std::sin(turn), placed,
                           i % 4 == 1 && i != 5 ? glass : mirror);
    }
    return scene_from_xml(xml);
}

} // namespace

TEST_CASE("a point light on a floor is right to the last bit of a float in double precision") {
    // Radiance albedo / pi * I cos / d^2; the floor and all else moved far from the origin.
    constexpr double x0 = 100000, height = 1.25, intensity = 7, albedo = 0.6;
    const Scene scene = scene_from_xml(
        R"(<integrator type="path"><integer name="max_depth" value="2"/></integrator>)" +
        camera("100000 5 0", "100000 0 0", "0 0 1") +
        R"(<shape type="rectangle"><transform name="to_world"><scale value="20"/>
        <rotate x="1" angle="-90"/><translate x="100000"/></transform>
        <bsdf type="diffuse"><rgb name="reflectance" value=".6"/></bsdf></shape>
        <emitter type="point"><point name="position" x="100000.3" y="1.25" z="-.4"/>
        <rgb name="intensity" value="7"/></emitter>)");
    const auto largest_error = [&](bool double_precision) {
        const Image image =
            render_measured(
                scene,
                {.spp = 1, .lanes = 1, .double_precision = double_precision, .pixel_centers = true})
                .mean;
        double largest = 0;
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const auto slope = [](int pixel) {
                    return (2 * (pixel + 0.5) / size - 1) * std::tan(std::numbers::pi / 9);
                };
                const glm::dvec3 way = glm::dvec3(100000.3 - x0, height, -0.4) -
                                       glm::dvec3(-5 * slope(x), 0, -5 * slope(y));
                const double d2 = glm::dot(way, way);
                const double exact =
                    albedo / std::numbers::pi * intensity * height / (d2 * std::sqrt(d2));
                const double error = std::abs(value_at(image, x, y) / exact - 1);
                largest = std::isfinite(error) ? std::max(largest, error) : INFINITY;
            }
        return largest;
    };
    constexpr double half_ulp = 0x1p-24;
    CHECK(largest_error(true) < 1.001 * half_ulp);
    CHECK(largest_error(false) > 1.5 * half_ulp); // or the bar above would tell nothing
}

TEST_CASE("a hall of mirrors magnifies no rounding of single precision in double precision") {
    // Turned, and three times as large, it is the same picture where nothing is rounded: the scale
    // of the placement is a power of two, so all numbers are others. No diffuse surface is among
    // them, from which directions depend on the axes.
    const auto apart = [&](bool double_precision) {
        const TestRender how = {
            .spp = 1, .lanes = 1, .double_precision = double_precision, .pixel_centers = true};
        return relative_differences(render_measured(hall_of_mirrors(1, 0), how).mean,
                                    render_measured(hall_of_mirrors(3, 37), how).mean);
    };
    const std::vector<double> exact = apart(true), rounded = apart(false);
    INFO(exact.back() << " " << share_above(rounded, 1e-6));
    CHECK(exact.back() < 2e-7); // the film is float
    CHECK(share_above(rounded, 1e-6) > 0.02);
}

TEST_CASE("single and double precision trace the same paths until rounding parts them") {
    // Of the pixels with four samples half agree to rounding, and few are parted, most where a tree
    // of many lights magnifies what is left of a number. A mistake in either precision shows in all
    // pixels that it touches.
    const auto name =
        GENERATE(as<std::string>(), "lights_shapes", "texture_shapes", "envmap_sun", "dielectrics");
    INFO(name);
    Scene scene = load_scene(std::string(CLRENDER_TEST_DIR) + "/references/" + name + ".xml");
    const auto picture = [&](bool double_precision) {
        return render_measured(scene, {.spp = 4, .lanes = 1, .double_precision = double_precision})
            .mean;
    };
    const std::vector<double> apart = relative_differences(picture(false), picture(true));
    const double median = apart[apart.size() / 2];
    INFO(median << " " << share_above(apart, 1e-3));
    CHECK(apart.back() > 0); // the two are not the same program
    CHECK(median < 1e-6);
    CHECK(share_above(apart, 1e-3) < 0.04);
}
