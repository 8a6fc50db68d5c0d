#include "render_adapter.h"

#include "render/render.h"

#include <filesystem>
#include <fstream>

#include <unistd.h>

namespace clrender::test {

MeasuredImage render_measured(const Scene &scene, const TestRender &how) {
    RenderOptions options;
    options.spp = how.spp > 0 ? how.spp : scene.sample_count;
    options.seed = how.seed;
    options.lanes = how.lanes;
    options.double_precision = how.double_precision;
    options.sampling.pixel_centers = how.pixel_centers;
    options.sampling.independent_sampler = !how.sobol;
    options.sampling.light_samples = how.light_samples;
    options.sampling.strategy = how.strategy;
    options.sampling.specular_connections = how.specular_connections;
    options.sampling.forced_features = how.forced_features;
    options.batch = how.batch_blocks;
    options.tile = how.tile_items;
    options.band_rows = how.band_rows;
    options.preview = how.preview;
    options.with_variance = true;
    RenderResult result = render_scene(scene, options);
    MeasuredImage measured{std::move(result.image), std::move(result.variance), {}};
    measured.mean_se = standard_error_of_mean(measured.variance, scene.film.filter);
    return measured;
}

Scene scene_from_xml(const std::string &xml, const std::map<std::string, std::string> &defines) {
    static int count = 0;
    const auto path =
        std::filesystem::temp_directory_path() /
        ("clrender_test_" + std::to_string(getpid()) + "_" + std::to_string(count++) + ".xml");
    const std::string folder = std::string(CLRENDER_TEST_DIR) + "/references";
    std::ofstream(path) << "<scene version=\"3.0.0\">\n<path value=\"" << folder << "\"/>\n"
                        << xml << "\n</scene>\n";
    try {
        Scene scene = load_scene(path.string(), {.defines = defines});
        std::filesystem::remove(path);
        return scene;
    } catch (...) {
        std::filesystem::remove(path);
        throw;
    }
}

double channel_mean(const Image &image, int channel) {
    double sum = 0;
    const auto channels = static_cast<std::size_t>(image.channels);
    for (std::size_t i = static_cast<std::size_t>(channel); i < image.f32.size(); i += channels)
        sum += double{image.f32[i]};
    return sum / static_cast<double>(image.f32.size() / channels);
}

double value_at(const Image &image, int x, int y, int channel) {
    const int index = (y * image.width + x) * image.channels + channel;
    return double{image.f32.at(static_cast<std::size_t>(index))};
}

} // namespace clrender::test
