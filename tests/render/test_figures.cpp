/// The statements of docs/figures.md, on small versions of its scenes.

#include "render_adapter.h"

#include "render/render.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

using namespace clrender;
using namespace clrender::test;

namespace {

using Defines = std::map<std::string, std::string>;

/// A scene of `scenes/` at another size.
Scene figure(const std::string &name, int width, int height, Defines defines = {}) {
    defines["width"] = std::to_string(width);
    defines["height"] = std::to_string(height);
    return load_scene(std::string(CLRENDER_SCENE_DIR) + "/" + name + ".xml",
                      {.defines = std::move(defines)});
}

bool is_near(double a, double b, double tolerance) {
    return std::abs(a - b) <= tolerance;
}

/// The mean of one channel over the pixels [x0, x1) x [y0, y1).
double mean_of_part(const Image &image, int x0, int x1, int y0, int y1, int channel) {
    double sum = 0;
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x)
            sum += value_at(image, x, y, channel);
    return sum / ((x1 - x0) * (y1 - y0));
}

/// The distances of what is seen at the centres of the pixels.
Image distances(Scene scene) {
    scene.integrator.kind = IntegratorKind::depth;
    return render_measured(scene, {.spp = 1, .pixel_centers = true}).mean;
}

} // namespace

TEST_CASE("figures: every bounce adds light, and the sum converges") {
    struct Expected {
        int max_depth;
        std::array<double, 3> mean;
    };
    const std::vector<Expected> all = {
        {2, {.1249, .1435, .1291}},  {3, {.1900, .2213, .2160}},     {5, {.2352, .2822, .2928}},
        {10, {.2512, .3073, .3380}}, {20, {.25194, .30874, .34316}}, {40, {.25194, .30875, .34322}},
    };
    std::array<double, 3> before{};
    for (const Expected &expected : all) {
        const Scene scene =
            figure("white_ball", 64, 48, {{"max_depth", std::to_string(expected.max_depth)}});
        const auto picture = render_measured(scene, {.spp = 512});
        for (int c = 0; c < 3; ++c) {
            const auto i = static_cast<std::size_t>(c);
            const double mean = channel_mean(picture.mean, c);
            INFO("max_depth " << expected.max_depth << ", channel " << c);
            CHECK(is_near(mean, expected.mean[i], 6 * double{picture.mean_se[i]} + 1e-4));
            CHECK(mean >= before[i]);
            if (expected.max_depth == 40)
                CHECK(mean <= before[i] * 1.001);
            before[i] = mean;
        }
    }
}

TEST_CASE("figures: the white ball is grey by direct light and takes on the colour of the walls") {
    const auto lower_part = [](const std::string &max_depth) {
        const auto picture =
            render_measured(figure("white_ball", 64, 48, {{"max_depth", max_depth}}), {.spp = 64});
        std::array<double, 3> rgb{};
        for (int c = 0; c < 3; ++c)
            rgb[static_cast<std::size_t>(c)] = mean_of_part(picture.mean, 30, 36, 29, 34, c);
        return rgb;
    };
    const auto direct = lower_part("2");
    CHECK(direct[0] > 0);
    CHECK(direct[1] == Approx(direct[0]).epsilon(1e-4));
    CHECK(direct[2] == Approx(direct[0]).epsilon(1e-4));
    const auto all = lower_part("20");
    CHECK(all[1] > 1.05 * all[0]);
}

TEST_CASE("figures: pixel centres give pure colours, filtering also those between, at edges only") {
    constexpr int width = 160;
    constexpr int height = 120;
    const Scene scene = figure(
        "antialias", width, height,
        {{"crop_width", "160"}, {"crop_height", "120"}, {"max_depth", "1"}, {"rfilter", "box"}});
    const Image centres = render_measured(scene, {.spp = 16, .pixel_centers = true}).mean;
    const Image filtered = render_measured(scene, {.spp = 16}).mean;

    // Red is enough to tell them apart: nothing, the sky, the lamp in the air.
    const auto colour = [](const Image &image, int x, int y) {
        const std::array<double, 3> pure{0, 0.55, 6};
        for (int i = 0; i < 3; ++i)
            if (is_near(value_at(image, x, y), pure[static_cast<std::size_t>(i)], 1e-5))
                return i;
        return -1;
    };
    const auto is_edge = [&](int x, int y) {
        for (int v = std::max(y - 1, 0); v <= std::min(y + 1, height - 1); ++v)
            for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width - 1); ++u)
                if (colour(centres, u, v) != colour(centres, x, y))
                    return true;
        return false;
    };
    std::array<int, 3> pure_pixels{};
    int impure = 0;
    int between = 0;
    int between_off_edges = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const int centre = colour(centres, x, y);
            if (centre < 0)
                ++impure;
            else
                ++pure_pixels[static_cast<std::size_t>(centre)];
            if (colour(filtered, x, y) < 0) {
                ++between;
                between_off_edges += is_edge(x, y) ? 0 : 1;
            }
        }
    CHECK(impure == 0);
    CHECK(*std::min_element(pure_pixels.begin(), pure_pixels.end()) > 10);
    CHECK(between > 100);
    CHECK(between_off_edges == 0);
}

TEST_CASE("figures: lamps of one power light alike whatever their radius, but for penumbras") {
    // Without what stands on the floor, everything in the picture sees the whole lamp.
    const auto without_objects = [](Scene scene) {
        const auto is_clay = [&](const Shape &shape) {
            return scene.bsdfs.at(static_cast<std::size_t>(shape.bsdf)).id == "clay";
        };
        scene.shapes.erase(std::remove_if(scene.shapes.begin(), scene.shapes.end(), is_clay),
                           scene.shapes.end());
        return scene;
    };
    const auto scene_with = [](const std::string &radius, const std::string &radiance) {
        return figure("soft_shadows", 96, 72,
                      {{"max_depth", "2"}, {"light_radius", radius}, {"light_radiance", radiance}});
    };
    const Scene small = scene_with("0.1", "125000");
    const Scene large = scene_with("10", "12.5");
    const TestRender how{.spp = 64, .pixel_centers = true};
    const Image small_lit = render_measured(without_objects(small), how).mean;
    const Image large_lit = render_measured(without_objects(large), how).mean;
    double difference = 0;
    for (int c = 0; c < 3; ++c)
        CHECK(channel_mean(large_lit, c) == Approx(channel_mean(small_lit, c)).epsilon(2e-3));
    for (std::size_t i = 0; i < small_lit.f32.size(); ++i)
        difference += std::abs(double{large_lit.f32[i]} / double{small_lit.f32[i]} - 1);
    CHECK(difference / static_cast<double>(small_lit.f32.size()) < 0.02);

    // A background pixel is in the penumbra if some, but not all, of the lamp's light arrives.
    const Image with_objects = distances(small);
    const Image background = distances(without_objects(small));
    const auto penumbra = [&](const Scene &scene, const Image &lit) {
        const Image picture = render_measured(scene, how).mean;
        int count = 0;
        for (std::size_t i = 0; i < lit.f32.size(); i += 3) {
            const double fraction = double{picture.f32[i]} / double{lit.f32[i]};
            if (with_objects.f32[i] == background.f32[i] && fraction > 0.1 && fraction < 0.9)
                ++count;
        }
        return count;
    };
    const int small_penumbra = penumbra(small, small_lit);
    const int large_penumbra = penumbra(large, large_lit);
    CHECK(large_penumbra > 100);
    CHECK(large_penumbra > 10 * small_penumbra);
}

TEST_CASE("figures: a mesh looks the same to the bit with the hierarchy and without") {
    const Scene scene = figure("mesh_bvh", 96, 72, {{"max_depth", "4"}});
    RenderOptions options;
    options.spp = 4;
    const RenderResult with = render_scene(scene, options);
    options.sampling.brute_force = true;
    const RenderResult without = render_scene(scene, options);
    CHECK(with.stats.triangles > 10000);
    CHECK(with.image.f32 == without.image.f32);
}

TEST_CASE("figures: interpolated normals change the shading, not the surface") {
    const Scene smooth = figure("normals", 96, 96);
    const Scene flat = figure("normals", 96, 96, {{"face_normals", "true"}});
    CHECK(distances(smooth).f32 == distances(flat).f32);
    const auto a = render_measured(smooth, {.spp = 64});
    const auto b = render_measured(flat, {.spp = 64});
    // Where the surface is seen, facets are lit by steps: squared differences are several times
    // what noise makes of equal pictures, and their root is a good part of the light.
    const Image depth = distances(smooth);
    double seen = 0, square = 0, noise = 0, a_sum = 0, b_sum = 0;
    for (std::size_t i = 0; i < a.mean.f32.size(); i += 3) {
        if (!(depth.f32[i] > 0))
            continue;
        const double va = a.mean.f32[i], vb = b.mean.f32[i];
        ++seen;
        square += (va - vb) * (va - vb);
        noise += double{a.variance.f32[i]} + double{b.variance.f32[i]};
        a_sum += va;
        b_sum += vb;
    }
    const double difference = std::sqrt(std::max(square - noise, 0.0) / seen);
    INFO(seen << " pixels, squared differences " << square / noise << " times those of noise, "
              << difference << " beyond it, means " << a_sum / seen << ", " << b_sum / seen);
    CHECK(seen > 1000);
    CHECK(square > 3 * noise);
    CHECK(difference > 0.03 * a_sum / seen);
    // Facets turn light from here to there; they make none.
    CHECK(b_sum == Approx(a_sum).epsilon(0.02));
}

TEST_CASE("figures: a lens shows sharply what lies in the plane of focus") {
    // With one segment only the lamps are seen, 14 to 20 away; a pixel counts that one brightens.
    const auto lamp_pixels = [](const std::string &aperture, const std::string &focus) {
        const Scene scene = figure("depth_of_field", 480, 270,
                                   {{"max_depth", "1"},
                                    {"rfilter", "box"},
                                    {"aperture_radius", aperture},
                                    {"focus_distance", focus}});
        const Image picture = render_measured(scene, {.spp = 64}).mean;
        int count = 0;
        for (std::size_t i = 0; i < picture.f32.size(); i += 3)
            count += picture.f32[i] > 0.1F ? 1 : 0;
        return count;
    };
    const int pinhole = lamp_pixels("0.0001", "6.5");
    const int focused = lamp_pixels("0.12", "16.5");
    const int blurred = lamp_pixels("0.12", "6.5");
    INFO("pixels: pinhole " << pinhole << ", focused " << focused << ", blurred " << blurred);
    CHECK(pinhole > 20);
    CHECK(focused < 6 * pinhole);
    CHECK(blurred > 4 * focused);
}
