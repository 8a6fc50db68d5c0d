#include "inner_pictures.h"

#include <chrono>
#include <utility>

namespace clrender {

namespace {

NamedLayer named(const std::string &name, const std::vector<std::string> &suffixes, Image image) {
    NamedLayer layer;
    for (const std::string &suffix : suffixes)
        layer.channels.push_back(name + "." + suffix);
    layer.image = std::move(image);
    return layer;
}

/// The first channels of each pixel.
Image first_channels(const Image &image, int count) {
    Image result = image;
    result.channels = count;
    result.f32.clear();
    for (std::size_t i = 0; i < image.f32.size(); i += static_cast<std::size_t>(image.channels))
        result.f32.insert(result.f32.end(), image.f32.begin() + static_cast<std::ptrdiff_t>(i),
                          image.f32.begin() + static_cast<std::ptrdiff_t>(i) + count);
    return result;
}

/// The first one's picture in RGBA holds that in RGB.
bool first_is_picture(const Scene &scene) {
    const PixelFormat format = scene.film.pixel_format;
    return !scene.layers.moments && (format == PixelFormat::rgb || format == PixelFormat::rgba);
}

/// How one of `left` pictures is rendered that share the time which is left. It is no part of a
/// checkpoint, and is rendered anew where a render goes on.
RenderOptions options_of_inner(const RenderOptions &options, std::size_t left) {
    using Clock = std::chrono::steady_clock;
    RenderOptions how = options;
    how.layers = {};
    how.with_samples = false;
    how.with_variance = options.target_error > 0;
    how.profile = nullptr;
    how.seconds_to_write = {};
    how.resumed = nullptr;
    how.checkpoint_due = {};
    how.write_checkpoint = {};
    how.part = how.parts = 1;
    const Clock::time_point now = Clock::now();
    if (options.deadline > now)
        how.deadline = now + (options.deadline - now) / static_cast<Clock::rep>(left);
    return how;
}

} // namespace

RenderResult render_with_inner_pictures(Scene &&scene, const RenderOptions &options) {
    if (scene.layers.pictures.empty())
        return render_scene(std::move(scene), options);
    const SceneLayers layers = scene.layers;
    const bool moments = layers.moments;
    const bool shares = first_is_picture(scene);
    const PixelFormat format = scene.film.pixel_format;
    const PixelFormat inner_format = moments ? PixelFormat::xyz : PixelFormat::rgba;
    const std::vector<std::string> suffixes = moments
                                                  ? std::vector<std::string>{"X", "Y", "Z"}
                                                  : std::vector<std::string>{"R", "G", "B", "A"};

    std::vector<NamedLayer> pictures;
    bool interrupted = false;
    // A part has the sums of the picture alone.
    const std::size_t count = options.parts == 1 ? layers.pictures.size() : 0;
    for (std::size_t i = shares ? 1 : 0; i < count && !interrupted; ++i) {
        Scene inner = scene;
        inner.layers = {};
        inner.integrator = layers.pictures[i].integrator;
        inner.film.pixel_format = inner_format;
        RenderResult result =
            render_scene(std::move(inner), options_of_inner(options, count - i + 1));
        interrupted = result.interrupted;
        pictures.push_back(named(layers.pictures[i].name, suffixes, std::move(result.image)));
    }
    if (shares)
        scene.film.pixel_format = PixelFormat::rgba;
    RenderResult result = render_scene(std::move(scene), options);
    if (shares)
        pictures.insert(pictures.begin(),
                        named(layers.pictures.front().name, suffixes, result.image));
    if (shares && format == PixelFormat::rgb) {
        result.image = first_channels(result.image, 3);
        if (!result.variance.f32.empty())
            result.variance = first_channels(result.variance, 3);
    }
    result.layers.insert(result.layers.begin(), std::make_move_iterator(pictures.begin()),
                         std::make_move_iterator(pictures.end()));
    return result;
}

} // namespace clrender
