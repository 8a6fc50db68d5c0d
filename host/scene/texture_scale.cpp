/// Texture "scale" of Mitsuba 0.6: another one, multiplied by a number or a colour.

#include "mitsuba_scene.h"
#include "mitsuba_text.h"

#include <utility>

namespace clrender::mitsuba {

int SceneReader::read_scaled_texture(Properties &properties, SpectrumUse use) {
    const Rgb factor = read_constant(properties, "scale", SpectrumUse::refractive_index, Rgb(1));
    int nested = none;
    if (const auto children = properties.children("texture"); children.size() == 1)
        nested = read_texture(children.front()->object, use);
    else if (properties.has("value"))
        nested = read_colour(properties, "value", use);
    if (nested == none)
        throw InputError(properties.where(),
                         properties.description() + " has no texture inside, expected one");

    Texture texture = scene_.textures.at(static_cast<std::size_t>(nested));
    // Whoever asks for a number makes one of this texture once more.
    if (use == SpectrumUse::number)
        std::swap(texture.color0, texture.color1);
    switch (texture.kind) {
    case TextureKind::constant:
        texture.value *= factor;
        check_range(properties, "scale", texture.value, use, false);
        break;
    case TextureKind::checkerboard:
        texture.color0 *= factor;
        texture.color1 *= factor;
        break;
    case TextureKind::attribute:
        if (factor.r != factor.g || factor.g != factor.b)
            throw UnsupportedError(properties.where("scale"),
                                   properties.description() + ": a colour times the attribute of a "
                                                              "mesh is not supported, expected a "
                                                              "number");
        texture.scale *= factor.r;
        break;
    case TextureKind::bitmap:
        texture.scale *= factor;
        break;
    }
    scene_.textures.push_back(std::move(texture));
    return static_cast<int>(scene_.textures.size()) - 1;
}

} // namespace clrender::mitsuba
