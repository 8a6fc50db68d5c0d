#pragma once
/// The one place of these tests that knows how a scene is rendered.

#include "config/sampling_options.h"
#include "z_test.h"

#include "scene/load_scene.h"

#include <cstdint>
#include <map>
#include <set>
#include <string>

namespace clrender::test {

struct TestRender {
    int spp = 0; ///< 0: the scene's own sample_count
    std::uint32_t seed = 1;
    int lanes = 0; ///< 0: as wide as the device
    bool double_precision = false;
    bool pixel_centers = false;
    int batch_blocks = 0;                ///< as in RenderOptions
    int tile_items = 0;                  ///< as in RenderOptions
    int band_rows = 0;                   ///< as in RenderOptions
    bool preview = false;                ///< as in RenderOptions
    ForcedFeatures forced_features = {}; ///< as in RenderOptions
    int light_samples = 0;               ///< as in RenderOptions
    Strategy strategy = Strategy::mis;
    bool specular_connections = true; ///< as in RenderOptions
    bool sobol = false; ///< independent samples, whose variance is what it looks like, if not
};

/// Renders on the machine's default device.
MeasuredImage render_measured(const Scene &scene, const TestRender &how = {});

/// Reads a scene from its XML text; files in it are found from tests/references.
Scene scene_from_xml(const std::string &xml,
                     const std::map<std::string, std::string> &defines = {});

/// The mean over all pixels of one channel.
double channel_mean(const Image &image, int channel);

/// One value, from the top left corner.
double value_at(const Image &image, int x, int y, int channel = 0);

} // namespace clrender::test
