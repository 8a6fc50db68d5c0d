/// One channel of a picture: the property `channel` of Mitsuba 0.6's bitmaps.

#include "../image/texels.h"
#include "../memory_limit.h"
#include "mitsuba_scene.h"

namespace clrender::mitsuba {

namespace {

/// Alpha is linear, and 1 where the picture has none.
double alpha_of(const Image &image, std::size_t at) {
    if (image.channels != 2 && image.channels != 4)
        return 1;
    const auto channels = static_cast<std::size_t>(image.channels);
    const std::size_t place = at * channels + channels - 1;
    constexpr double byte = 255;
    return image.type == PixelType::u8 ? image.u8[place] / byte : double{image.f32[place]};
}

} // namespace

std::shared_ptr<const Image> SceneReader::read_channel(Properties &properties,
                                                       std::shared_ptr<const Image> source,
                                                       TexelFormat format) {
    constexpr int alpha = 3;
    const auto channel = static_cast<int>(properties.choice("channel", 0, {"r", "g", "b", "a"}));
    auto image = std::make_shared<Image>();
    files_.then([image, source = std::move(source), format, channel, properties] {
        const std::size_t count =
            static_cast<std::size_t>(source->width) * static_cast<std::size_t>(source->height);
        if (const std::string why = claim_memory(count * sizeof(float)); !why.empty())
            properties.fail("channel", why);
        image->width = source->width;
        image->height = source->height;
        image->channels = 1;
        for (std::size_t i = 0; i < count; ++i)
            image->f32.push_back(
                static_cast<float>(channel == alpha ? alpha_of(*source, i)
                                                    : texel_color(*source, i, format)[channel]));
    });
    return image;
}

} // namespace clrender::mitsuba
