/// Emitter "spot".

#include "../log.h"
#include "mitsuba_scene.h"

namespace clrender::mitsuba {

void SceneReader::read_spot(Properties &properties, Emitter &emitter) {
    emitter.kind = EmitterKind::spot;
    emitter.intensity = read_constant(properties, "intensity", SpectrumUse::emission, Rgb(1));
    emitter.to_world = properties.transform("to_world");
    emitter.cutoff_angle = properties.number("cutoff_angle", emitter.cutoff_angle);
    if (!(emitter.cutoff_angle > 0 && emitter.cutoff_angle <= 180))
        properties.fail("cutoff_angle", "is out of range, expected degrees above 0, at most 180");
    emitter.beam_width = properties.number("beam_width", 0.75 * emitter.cutoff_angle);
    if (emitter.beam_width < 0)
        properties.fail("beam_width", "is negative, expected no number below 0");
    if (emitter.beam_width > emitter.cutoff_angle) {
        log::warn(properties.where("beam_width"),
                  properties.description() + ": \"beam_width\" is above cutoff_angle, which is "
                                             "taken in its place");
        emitter.beam_width = emitter.cutoff_angle;
    }

    emitter.radiance = read_colour(properties, "texture", SpectrumUse::emission);
    if (emitter.radiance == none)
        return;
    if (scene_.textures[static_cast<std::size_t>(emitter.radiance)].kind == TextureKind::constant)
        properties.fail("texture", "is a plain colour, expected a texture such as a \"bitmap\"");
    if (!(emitter.cutoff_angle < 90))
        properties.fail("cutoff_angle", "is too wide for a texture, expected degrees below 90");
}

} // namespace clrender::mitsuba
