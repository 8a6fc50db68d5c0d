/// Layers of first hits against those that Mitsuba 3 makes of the same scene (data/make_aovs.py).

#include "image/layers.h"
#include "render/inner_pictures.h"
#include "scene/load_scene.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace clrender;

namespace {

constexpr int spp = 64;
/// Samples of the reference over ours: independent ones, so ours have at most this variance more.
constexpr double extra_variance = 16;

const std::string folder = std::string(CLRENDER_TEST_DIR) + "/render/data/";

RenderResult render_layers(const LayerOptions &layers) {
    RenderOptions options;
    options.lanes = 4;
    options.spp = spp;
    options.layers = layers;
    return render_with_inner_pictures(load_scene(folder + "aovs.xml"), options);
}

const NamedLayer &layer_of(const RenderResult &result, const std::string &channel) {
    for (const NamedLayer &layer : result.layers)
        if (layer.channels.front() == channel)
            return layer;
    FAIL("no layer " << channel);
    return result.layers.front();
}

} // namespace

TEST_CASE("layers of the aov integrator agree with Mitsuba's", "[layers]") {
    const RenderResult result = render_layers({{{"n", AovType::shape_index}}, true});
    std::size_t compared = 0;
    for (const NamedLayer &layer : result.layers) {
        const std::string name = layer.channels.front().substr(0, 2);
        const auto mean = read_exr_layer(folder + "aovs.exr", name);
        if (!mean)
            continue;
        const auto variance = read_exr_layer(folder + "aovs.exr", "variance_" + name);
        REQUIRE(mean->f32.size() == layer.image.f32.size());
        CAPTURE(layer.channels.front());
        double sum = 0, sum_variance = 0;
        std::size_t values = 0, outliers = 0;
        for (std::size_t i = 0; i < mean->f32.size(); ++i) {
            // Mitsuba has NaN for derivatives beside nothing.
            if (!std::isfinite(mean->f32[i]))
                continue;
            const double difference = static_cast<double>(layer.image.f32[i]) - mean->f32[i];
            const double rounding = 1e-4 * (1 + std::abs(static_cast<double>(mean->f32[i])));
            const double bound = (1 + extra_variance) * variance->f32[i] + rounding * rounding;
            outliers += !(difference * difference < 25 * bound) ? 1 : 0;
            sum += difference;
            sum_variance += bound;
            ++values;
        }
        CHECK(outliers == 0);
        // Neighbours share samples: the filter sums over about 3.6 pixels.
        CHECK(sum * sum < 25 * 3.6 * sum_variance);
        CHECK(values > mean->f32.size() / 4);
        ++compared;
    }
    CHECK(compared == 12);

    // The numbers of pixels are those that the filtered ones have where there is but one, and no
    // mask, which layers by pixels see through.
    const Image &filtered = layer_of(result, "si.I").image, &exact = layer_of(result, "n.I").image;
    std::size_t same = 0;
    for (std::size_t i = 0; i < exact.f32.size(); ++i) {
        CHECK(exact.f32[i] == std::floor(exact.f32[i]));
        same += std::abs(exact.f32[i] - filtered.f32[i]) < 1e-4 ? 1 : 0;
    }
    CHECK(same > exact.f32.size() / 3);

    // Coverages of a pixel add up to at most 1, and to 1 on the floor.
    const Image &first = layer_of(result, "crypto_object00.R").image;
    const auto floor = static_cast<std::size_t>(first.width) * 16 + 4;
    CHECK(first.f32[4 * floor] == cryptomatte_id("floor"));
    for (std::size_t i = 0; i < first.f32.size(); i += 4)
        CHECK(first.f32[i + 1] + first.f32[i + 3] <= 1 + 1e-5);
    CHECK(layer_of(result, "img.R").image.channels == 4);
}
