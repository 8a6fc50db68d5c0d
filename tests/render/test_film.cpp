/// What the film makes of samples that no picture should hold.

#include "render/render.h"
#include "render_adapter.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace clrender;
using namespace clrender::test;

namespace {

/// A ball before a sky, both of these grey radiances, in the middle of 16 x 16 pixels; what the
/// ball scatters is the sky's light. Scene files may not state radiances as large as some here.
Scene ball_scene(double ball, double sky) {
    Scene scene = scene_from_xml(
        R"(<integrator type="path"><integer name="max_depth" value="2"/></integrator>
        <sensor type="perspective"><float name="fov" value="40"/><transform name="to_world">
        <lookat origin="0 0 5" target="0 0 0" up="0 1 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/>
        <rfilter type="box"/></film></sensor>
        <shape type="sphere"><float name="radius" value=".5"/>
        <bsdf type="diffuse"><rgb name="reflectance" value="1"/></bsdf>
        <emitter type="area"><rgb name="radiance" value="1"/></emitter></shape>
        <emitter type="constant"><rgb name="radiance" value="1"/></emitter>)");
    for (const Emitter &emitter : scene.emitters)
        scene.textures.at(static_cast<std::size_t>(emitter.radiance)).value =
            Rgb(emitter.kind == EmitterKind::area ? ball : sky);
    return scene;
}

} // namespace

TEST_CASE("samples that are not finite are counted, located and black, and harm no other") {
    // The largest float and a little more.
    RenderOptions options;
    options.spp = 16;
    const RenderResult result = render_scene(ball_scene(3.4e38, 1e36), options);
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
    const RenderResult result = render_scene(ball_scene(1e30, 3e38), options);
    CHECK(result.stats.clamped_pixels > 200);
    CHECK(result.stats.clamped_x == 0);
    CHECK(result.stats.clamped_y == 0);
    CHECK(std::ranges::none_of(result.image.f32, [](float v) { return std::isnan(v); }));
}

TEST_CASE("a picture of N samples is that of the first N of a longer render, to the bit") {
    Scene scene = ball_scene(2, 0.7);
    for (const FilterKind filter : {FilterKind::box, FilterKind::gaussian}) {
        scene.film.filter.kind = filter;
        RenderOptions options;
        options.spp = 200; // not where a block ends
        options.with_variance = options.with_samples = true;
        const auto render = start_render(Scene(scene), options);
        CHECK(render->samples() == 0);
        for (const int samples : {16, 32, 128, 200}) {
            INFO(samples << " samples");
            REQUIRE(render->advance(samples));
            CHECK(render->samples() == samples);
            const RenderResult seen = render->read();
            RenderOptions short_options = options;
            short_options.spp = samples;
            const RenderResult whole = render_scene(scene, short_options);
            CHECK(seen.image.f32 == whole.image.f32);
            CHECK(seen.variance.f32 == whole.variance.f32);
            CHECK(seen.samples.f32 == whole.samples.f32);
            CHECK(seen.samples.f32.at(40) == static_cast<float>(samples));
            CHECK(seen.error.relative_variance == whole.error.relative_variance);
            CHECK(seen.stats.rays == whole.stats.rays);
        }
    }
}

TEST_CASE("the stated error is that between seeds, with independent and with Sobol' points") {
    // A penumbra, whose noise Sobol' points reduce, and the sky's light.
    const Scene scene = scene_from_xml(
        R"(<integrator type="path"><integer name="max_depth" value="2"/></integrator>
        <sensor type="perspective"><float name="fov" value="40"/><transform name="to_world">
        <lookat origin="0 3 6" target="0 0 0" up="0 1 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="32"/><integer name="height" value="32"/>
        </film></sensor>
        <shape type="sphere"><point name="center" value="0 -100 0"/>
        <float name="radius" value="99.5"/></shape>
        <shape type="sphere"><float name="radius" value=".5"/></shape>
        <shape type="sphere"><point name="center" value="3 5 0"/><float name="radius" value=".7"/>
        <emitter type="area"><rgb name="radiance" value="9 8 7"/></emitter></shape>
        <emitter type="constant"><rgb name="radiance" value=".3 .4 .5"/></emitter>)");
    constexpr unsigned runs = 12;
    for (const bool independent : {true, false}) {
        for (const int spp : {32, 128}) {
            double stated = 0;
            std::vector<double> sums, squares;
            for (unsigned run = 0; run < runs; ++run) {
                RenderOptions options;
                options.spp = spp;
                options.seed = 50 + run;
                options.sampling.independent_sampler = independent;
                options.with_variance = true;
                const RenderResult result = render_scene(scene, options);
                stated += result.error.relative_variance / runs;
                sums.resize(result.image.f32.size());
                squares.resize(result.image.f32.size());
                for (std::size_t i = 0; i < sums.size(); ++i) {
                    const double value = double{result.image.f32[i]};
                    sums[i] += value;
                    squares[i] += value * value;
                }
            }
            double measured = 0;
            for (std::size_t i = 0; i < sums.size(); ++i) {
                const double mean = sums[i] / runs;
                const double variance = (squares[i] - runs * mean * mean) / (runs - 1);
                measured += variance / (mean * mean + 0.01) / static_cast<double>(sums.size());
            }
            CAPTURE(independent, spp, stated, measured);
            CHECK(stated / measured > 0.8);
            CHECK(stated / measured < 1.25);
        }
    }
}
