/// Changes that must not change the picture: to the bit, or but for the noise.

#include "render_adapter.h"

#include "render/render.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>

#include <unistd.h>

using namespace clrender;
using namespace clrender::test;

namespace {

/// A scene with every kind of shape and light, scaled by `s` and then moved by `t`. Its horizon
/// lies on a border of tiles, which share the pixels of a bright edge.
Scene small_scene(double s, double t = 0) {
    const auto at = [&](double x, double y, double z) {
        return fmt::format("{:.17g} {:.17g} {:.17g}", s * x + t, s * y + t, s * z + t);
    };
    const auto place = [&](double size, const std::string &turn, const std::string &where) {
        return fmt::format(R"(<transform name="to_world"><scale value="{:.17g}"/>{}
            <translate value="{}"/></transform>)",
                           s * size, turn, where);
    };
    std::string xml =
        R"(<integrator type="path"><integer name="max_depth" value="5"/></integrator>)";
    xml += fmt::format(R"(<sensor type="perspective"><float name="fov" value="40"/>
        <transform name="to_world"><lookat origin="{}" target="{}" up="0 1 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="48"/><integer name="height" value="32"/>
        <rfilter type="tent"/></film></sensor>)",
                       at(0, 1, 6), at(0, 0, 0));
    xml +=
        R"(<shape type="rectangle">)" + place(6, R"(<rotate x="1" angle="-90"/>)", at(0, -1, 0)) +
        R"(<bsdf type="diffuse"><texture type="checkerboard" name="reflectance"/></bsdf></shape>)";
    xml += fmt::format(R"(<shape type="sphere"><transform name="to_world"><scale value="{:.17g}"/>
        <translate value="{}"/></transform><bsdf type="dielectric"/></shape>)",
                       s * 0.75, at(-1.25, -0.25, 0));
    xml += R"(<shape type="obj"><string name="filename" value="data/blob.obj"/>)" +
           place(0.75, R"(<rotate y="1" angle="30"/>)", at(1, -0.25, 0)) +
           R"(<bsdf type="diffuse"><rgb name="reflectance" value=".3 .5 .8"/></bsdf></shape>)";
    xml += R"(<shape type="disk">)" + place(0.5, R"(<rotate x="1" angle="90"/>)", at(0, 3, 0)) +
           R"(<emitter type="area"><rgb name="radiance" value="9 8 7"/></emitter></shape>)";
    xml += fmt::format(R"(<emitter type="point"><point name="position" value="{}"/>
        <rgb name="intensity" value="{:.17g}"/></emitter>)",
                       at(2, 2, 3), 4 * s * s);
    xml += R"(<emitter type="constant"><rgb name="radiance" value=".2 .25 .3"/></emitter>)";
    return scene_from_xml(xml);
}

/// A floor and a ball below a map, brighter upwards and towards one side, without a sun, which BSDF
/// sampling would hardly find.
Scene sky_scene(double scale) {
    Image sky;
    sky.width = 64;
    sky.height = 32;
    sky.channels = 3;
    sky.type = PixelType::f32;
    for (int row = sky.height - 1; row >= 0; --row)
        for (int column = 0; column < sky.width; ++column)
            for (const float tint : {0.7f, 0.8f, 1.0f})
                sky.f32.push_back(tint * (0.2f + 0.03f * static_cast<float>(row)) *
                                  (column < sky.width / 2 ? 1.0f : 3.0f));
    const auto map = std::filesystem::temp_directory_path() /
                     ("clrender_sky_" + std::to_string(getpid()) + ".pfm");
    write_image(map.string(), sky);
    Scene scene = scene_from_xml(fmt::format(
        R"(<integrator type="path"><integer name="max_depth" value="3"/></integrator>
        <sensor type="perspective"><float name="fov" value="40"/><transform name="to_world">
        <lookat origin="0 1 6" target="0 0 0" up="0 1 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="32"/><integer name="height" value="32"/>
        <rfilter type="box"/></film></sensor>
        <emitter type="envmap"><string name="filename" value="{}"/>
        <float name="scale" value="{:.17g}"/></emitter>
        <shape type="rectangle"><transform name="to_world"><scale value="6"/>
        <rotate x="1" angle="-90"/><translate value="0 -1 0"/></transform></shape>
        <shape type="sphere"/>)",
        map.string(), scale));
    std::filesystem::remove(map);
    return scene;
}

void check_same_by_z_test(const std::string &name, const MeasuredImage &a, const MeasuredImage &b) {
    const auto verdict = compare_or_save(name, a, b);
    INFO(verdict.summary);
    CHECK(verdict.passes);
}

void check_strategies(const std::string &name, const Scene &scene) {
    const auto both = render_measured(scene, {.spp = 1024});
    for (const Strategy strategy : {Strategy::light, Strategy::bsdf})
        check_same_by_z_test(fmt::format("{}_strategy_{}", name, static_cast<int>(strategy)),
                             render_measured(scene, {.spp = 1024, .seed = 2, .strategy = strategy}),
                             both);
}

} // namespace

TEST_CASE("a scene scaled by a power of two gives the same picture to the bit") {
    const auto original = render_measured(small_scene(1), {.spp = 16});
    for (const int exponent : {-10, 10}) {
        const auto scaled = render_measured(small_scene(std::ldexp(1, exponent)), {.spp = 16});
        INFO("scaled by 2^" << exponent);
        CHECK(scaled.mean.f32 == original.mean.f32);
    }
}

TEST_CASE("a scene that is scaled or moved elsewhere gives the same picture but for the noise") {
    const auto original = render_measured(small_scene(1), {.spp = 512});
    check_same_by_z_test("moved", render_measured(small_scene(1, 123.4), {.spp = 512, .seed = 2}),
                         original);
    check_same_by_z_test("scaled_up", render_measured(small_scene(1e5), {.spp = 512, .seed = 3}),
                         original);
    check_same_by_z_test("scaled_down", render_measured(small_scene(1e-5), {.spp = 512, .seed = 4}),
                         original);
}

TEST_CASE("all lane widths give the same picture but for the noise") {
    const Scene scene = small_scene(1);
    const std::array widths{1, 4, 8, 16};
    std::vector<MeasuredImage> pictures;
    for (const int lanes : widths)
        pictures.push_back(render_measured(
            scene, {.spp = 512, .seed = static_cast<std::uint32_t>(lanes), .lanes = lanes}));
    for (std::size_t i = 1; i < widths.size(); ++i)
        check_same_by_z_test(fmt::format("lanes_{}_and_1", widths[i]), pictures[i], pictures[0]);
}

TEST_CASE("the number of light samples does not change the picture but for the noise") {
    const Scene scene = small_scene(1);
    const auto one = render_measured(scene, {.spp = 512, .light_samples = 1});
    for (const int count : {2, 8})
        for (const bool sobol : {false, true})
            check_same_by_z_test(
                fmt::format("light_samples_{}_{}", count, sobol ? "sobol" : "independent"),
                render_measured(scene, {.spp = 512,
                                        .seed = static_cast<std::uint32_t>(count),
                                        .light_samples = count,
                                        .sobol = sobol}),
                one);
}

TEST_CASE("light and BSDF sampling alone and together find the same light of a sky") {
    check_strategies("sky", sky_scene(1));
}

TEST_CASE("a sky brighter by a power of two gives the same picture, brighter to the bit") {
    const auto plain = render_measured(sky_scene(1), {.spp = 64});
    for (const int exponent : {-90, 90}) {
        auto bright = render_measured(sky_scene(std::ldexp(1.0, exponent)), {.spp = 64});
        for (float &value : bright.mean.f32)
            value = std::ldexp(value, -exponent);
        INFO("2^" << exponent);
        CHECK(bright.mean.f32 == plain.mean.f32);
    }
}

TEST_CASE("light and BSDF sampling alone and together find the same light of surfaces") {
    // Broad ones, of every shape, so that BSDF sampling finds them.
    const Scene scene = scene_from_xml(
        R"(<integrator type="path"><integer name="max_depth" value="3"/></integrator>
        <sensor type="perspective"><float name="fov" value="40"/><transform name="to_world">
        <lookat origin="0 1 6" target="0 0 0" up="0 1 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="32"/><integer name="height" value="32"/>
        <rfilter type="box"/></film></sensor>
        <shape type="rectangle"><transform name="to_world"><scale value="6"/>
        <rotate x="1" angle="-90"/><translate value="0 -1 0"/></transform></shape>
        <shape type="sphere"><float name="radius" value=".7"/></shape>
        <shape type="sphere"><point name="center" value="-2.5 1 0"/>
        <emitter type="area"><rgb name="radiance" value="2 1 1"/></emitter></shape>
        <shape type="rectangle"><transform name="to_world"><scale value="1.5"/>
        <rotate x="1" angle="90"/><translate value="0 3 0"/></transform>
        <emitter type="area"><rgb name="radiance" value="1 2 1"/></emitter></shape>
        <shape type="obj"><string name="filename" value="data/blob.obj"/>
        <transform name="to_world"><translate value="2.5 1 0"/></transform>
        <emitter type="area"><rgb name="radiance" value="1 1 2"/></emitter></shape>)");
    check_strategies("surfaces", scene);
}

TEST_CASE("the same seed gives the same picture to the bit, another seed another one") {
    const Scene scene = small_scene(1);
    const TestRender how{.spp = 64, .seed = 5};
    const auto first = render_measured(scene, how);
    CHECK(render_measured(scene, how).mean.f32 == first.mean.f32);
    CHECK(render_measured(scene, {.spp = 64, .seed = 6}).mean.f32 != first.mean.f32);
}

TEST_CASE("batches and tiles do not change a bit of the picture") {
    // Nine blocks of samples and a part of one. Filters that are splatted have no batches.
    Scene scene = small_scene(1);
    for (const FilterKind filter : {FilterKind::box, FilterKind::tent}) {
        scene.film.filter.kind = filter;
        constexpr int spp = 600;
        const auto whole = render_measured(scene, {.spp = spp});
        for (const int batch : {1, 2, 7}) {
            INFO("batches of " << batch << " blocks of samples");
            CHECK(render_measured(scene, {.spp = spp, .batch_blocks = batch}).mean.f32 ==
                  whole.mean.f32);
        }
        for (const int tile : {8, 32, 1000}) {
            INFO("tiles of " << tile << " work-items");
            CHECK(render_measured(scene, {.spp = spp, .tile_items = tile}).mean.f32 ==
                  whole.mean.f32);
        }
    }
}

TEST_CASE("bands and a preview do not change a bit of the picture") {
    Scene scene = small_scene(1);
    for (const FilterKind filter : {FilterKind::box, FilterKind::tent}) {
        scene.film.filter.kind = filter;
        constexpr int spp = 100;
        const auto whole = render_measured(scene, {.spp = spp});
        for (const int rows : {1, 3})
            for (const bool preview : {false, true}) {
                INFO("bands of " << rows << " rows of tiles" << (preview ? ", a preview" : ""));
                const auto bands =
                    render_measured(scene, {.spp = spp, .band_rows = rows, .preview = preview});
                const bool same_mean = bands.mean.f32 == whole.mean.f32;
                const bool same_variance = bands.variance.f32 == whole.variance.f32;
                CHECK(same_mean);
                CHECK(same_variance);
            }
    }
}

TEST_CASE("a render that is stopped in its first pass leaves a picture without holes") {
    // What has no sample yet shows its neighbours: the picture is rough but nowhere black.
    Scene scene = small_scene(1);
    for (const FilterKind filter : {FilterKind::box, FilterKind::tent}) {
        scene.film.filter.kind = filter;
        const auto whole = render_measured(scene, {.spp = 64});
        const double floor = 0.2 * channel_mean(whole.mean, 1);
        for (const int bands : {0, 2})
            for (const int launches : {1, 3, 7}) {
                INFO("stopped after " << launches << " launches, bands of " << bands);
                int left = launches;
                RenderOptions options;
                options.spp = 6400;
                options.tile = 2;
                options.band_rows = bands;
                options.preview = bands > 0;
                options.with_variance = true;
                options.should_stop = [&] { return --left <= 0; };
                const RenderResult stopped = render_scene(scene, options);
                CHECK(stopped.interrupted);
                CHECK(stopped.gaps > 0);
                CHECK(stopped.gaps < stopped.image.f32.size() / 3);
                CHECK(channel_mean(stopped.image, 1) > floor);
                std::size_t dark = 0, unknown = 0;
                for (std::size_t i = 0; i < stopped.image.f32.size(); i += 3) {
                    dark += stopped.image.f32[i + 1] > 0 ? 0 : 1;
                    unknown += std::isinf(stopped.variance.f32[i]) ? 1 : 0;
                }
                CHECK(dark == 0);
                // And of pixels whose neighbours have none, or that have a single one.
                CHECK(unknown >= stopped.gaps);
            }
    }
}

TEST_CASE("a render that is stopped later has the samples of its passes everywhere") {
    Scene scene = small_scene(1);
    scene.film.filter.kind = FilterKind::tent;
    const auto whole = render_measured(scene, {.spp = 1024, .sobol = true});
    for (const int bands : {0, 2}) {
        INFO("bands of " << bands);
        int left = bands > 0 ? 10 : 40;
        RenderOptions options;
        options.spp = 1 << 20;
        options.tile = bands > 0 ? 1000 : 2;
        options.band_rows = bands;
        options.preview = true;
        options.with_variance = true;
        options.should_stop = [&] { return --left <= 0; };
        const RenderResult stopped = render_scene(scene, options);
        CHECK(stopped.interrupted);
        CHECK(stopped.gaps == 0);
        CHECK(channel_mean(stopped.image, 1) == Approx(channel_mean(whole.mean, 1)).epsilon(0.1));
    }
}

TEST_CASE("the stated variance is the variance between seeds") {
    const Scene scene = small_scene(1);
    constexpr unsigned runs = 32;
    std::vector<MeasuredImage> pictures;
    for (unsigned run = 0; run < runs; ++run)
        pictures.push_back(render_measured(scene, {.spp = 32, .seed = 100 + run}));

    double stated = 0, measured = 0;
    for (std::size_t i = 0; i < pictures[0].mean.f32.size(); ++i) {
        double sum = 0, squares = 0;
        for (const auto &picture : pictures) {
            sum += double{picture.mean.f32[i]};
            squares += double{picture.mean.f32[i]} * double{picture.mean.f32[i]};
            stated += double{picture.variance.f32[i]} / runs;
        }
        measured += (squares - sum * sum / runs) / (runs - 1);
    }
    CHECK(stated / measured == Approx(1).epsilon(0.1));
}
