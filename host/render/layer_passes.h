#pragma once
/// The layers beside a picture that tell what the camera sees first.

#include "first_hits.h"

#include <memory>
#include <vector>

namespace clrender::inline CLR_PRECISION {

/// Whether a render has any.
bool wants_layers(const Scene &scene, const RenderOptions &options);

/// Values of each pixel that they keep on the host.
std::size_t layer_values(const Scene &scene, const RenderOptions &options);

class LayerPasses {
public:
    /// Of a scene that is flattened and has its arrays yet.
    LayerPasses(const Scene &scene, FlatScene &flat, const RenderOptions &options, int spp);

    void start_compiling(const cl::Context &context, const cl::CommandQueue &queue,
                         const DeviceEntry &entry, const KernelConfig &config);
    /// Fills `result`; ends early where the render is stopped.
    void run(const DeviceScene &scene, const FlatScene &flat, RenderResult &result);

private:
    struct Pass {
        std::unique_ptr<AovSums> sums;
        int samples = 0;
        std::unique_ptr<FirstHits> hits;
    };

    void add(AovPass pass, std::vector<Aov> aovs, const FlatScene &flat, int samples);

    const RenderOptions &options_;
    int spp_;
    HitTable table_;
    SplatFilter filter_;
    std::vector<Pass> passes_;
    std::map<std::string, std::string> metadata_;
};

} // namespace clrender::inline CLR_PRECISION
