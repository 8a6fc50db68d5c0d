/// What the film makes of samples that no picture should hold.

#include "render/render.h"
#include "render_adapter.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace clrender;
using namespace clrender::test;

namespace {

/// A ball before a sky, both of these radiances, in the middle of 16 x 16 pixels; what the ball
/// scatters is the sky's light.
Scene ball_scene(const std::string &ball, const std::string &sky) {
    return scene_from_xml(
        R"(<integrator type="path"><integer name="max_depth" value="2"/></integrator>
        <sensor type="perspective"><float name="fov" value="40"/><transform name="to_world">
        <lookat origin="0 0 5" target="0 0 0" up="0 1 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/>
        <rfilter type="box"/></film></sensor>
        <shape type="sphere"><float name="radius" value=".5"/>
        <bsdf type="diffuse"><rgb name="reflectance" value="1"/></bsdf>
        <emitter type="area"><rgb name="radiance" value=")" +
        ball + R"("/></emitter></shape><emitter type="constant"><rgb name="radiance" value=")" +
        sky + R"("/></emitter>)");
}

} // namespace

TEST_CASE("samples that are not finite are counted, located and black, and harm no other") {
    // The largest float and a little more.
    RenderOptions options;
    options.spp = 16;
    const RenderResult result = render_scene(ball_scene("3.4e38", "1e36"), options);
    const RenderStats &stats = result.stats;
    // The ball covers about 11 pixels: its radius is 2.2 of them.
    CHECK(stats.nonfinite_samples > 16 * 10);
    CHECK(stats.nonfinite_samples < 16 * 25);
    CHECK(std::hypot(stats.nonfinite_x - 7.5, stats.nonfinite_y - 7.5) < 4);
    CHECK(std::ranges::all_of(result.image.f32, [](float v) { return std::isfinite(v); }));
    CHECK(double{result.image.f32[0]} == Approx(1e36).epsilon(1e-6));
    CHECK(value_at(result.image, 7, 7) == 0);
    CHECK(stats.clamped_pixels == 0);
}

TEST_CASE("sums beyond the film's range are clamped, counted and located") {
    // Sixteen samples of 3e38 are no float any more.
    RenderOptions options;
    options.spp = 16;
    const RenderResult result = render_scene(ball_scene("1e30", "3e38"), options);
    CHECK(result.stats.clamped_pixels > 200);
    CHECK(result.stats.clamped_x == 0);
    CHECK(result.stats.clamped_y == 0);
    CHECK(std::ranges::none_of(result.image.f32, [](float v) { return std::isnan(v); }));
}
