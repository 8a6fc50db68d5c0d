#include "layer_passes.h"

#include "film/trim.h"
#include "scene/object_names.h"
#include "shared/film_filter.h"

#include <algorithm>

namespace clrender::inline CLR_PRECISION {

namespace {

/// Where the scene asks for layers they have as many samples as the picture, up to so many; in
/// Mitsuba they have all.
constexpr int most_filtered = 64;
/// Layers of the command line cost little: an eighth of the samples, up to so many.
constexpr int least_samples = 4;
constexpr int most_boxed = 16;
constexpr int most_matte = 64;

int share_of(int spp, int most) {
    return std::min(spp, std::clamp(spp / 8, least_samples, most));
}

SplatFilter splat_filter(const FlatScene &flat) {
    SplatFilter filter;
    if (flat.filter.empty())
        return filter;
    filter.border = flat.facts.filter_border;
    filter.radius = static_cast<double>(flat.frame.filter_radius);
    for (std::size_t i = 0; i < CLR_FILTER_LEVELS; ++i)
        filter.values.push_back(static_cast<float>(flat.filter[CLR_FILTER_VALUES + i]));
    return filter;
}

} // namespace

bool wants_layers(const Scene &scene, const RenderOptions &options) {
    return !scene.layers.aovs.empty() || !options.layers.aovs.empty() || options.layers.matte;
}

std::size_t layer_values(const Scene &scene, const RenderOptions &options) {
    std::size_t values = 0;
    for (const auto *aovs : {&scene.layers.aovs, &options.layers.aovs})
        for (const Aov &aov : *aovs)
            values += 2 * aov_suffixes(aov.type).size();
    return values + (options.layers.matte ? 8 * matte_ranks : 0);
}

LayerPasses::LayerPasses(const Scene &scene, FlatScene &flat, const RenderOptions &options, int spp)
    : options_(options), spp_(spp), table_(std::move(flat.hits)), filter_(splat_filter(flat)) {
    if (!scene.layers.aovs.empty())
        add(AovPass::filtered, scene.layers.aovs, flat, std::min(spp, most_filtered));
    if (!options.layers.aovs.empty())
        add(AovPass::boxed, options.layers.aovs, flat, share_of(spp, most_boxed));
    if (options.layers.matte) {
        add(AovPass::matte, {}, flat, share_of(spp, most_matte));
        const std::vector<std::string> materials = bsdf_names(scene);
        passes_.back().sums->set_names(scene.object_names, materials);
        metadata_ = cryptomatte_metadata("crypto_object", scene.object_names);
        metadata_.merge(cryptomatte_metadata("crypto_material", materials));
    }
}

void LayerPasses::add(AovPass pass, std::vector<Aov> aovs, const FlatScene &flat, int samples) {
    passes_.push_back({std::make_unique<AovSums>(pass, std::move(aovs), table_, filter_,
                                                 flat.frame.width, flat.frame.height),
                       samples,
                       {}});
}

void LayerPasses::start_compiling(const cl::Context &context, const cl::CommandQueue &queue,
                                  const DeviceEntry &entry, const KernelConfig &config) {
    for (Pass &pass : passes_) {
        pass.hits = std::make_unique<FirstHits>(context, queue, entry, config, pass.sums->fields());
        pass.hits->start_compiling(options_.kernel_dir);
    }
}

void LayerPasses::run(const DeviceScene &scene, const FlatScene &flat, RenderResult &result) {
    for (Pass &pass : passes_) {
        pass.hits->run(scene, flat, pass.samples, spp_, options_.should_stop, *pass.sums);
        for (NamedLayer &layer : pass.sums->finish()) {
            trim(layer.image, flat.border);
            result.layers.push_back(std::move(layer));
        }
        pass.sums.reset();
    }
    result.layer_metadata = std::move(metadata_);
}

} // namespace clrender::inline CLR_PRECISION
