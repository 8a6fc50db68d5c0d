/// Emitter "projector".

#include "mitsuba_scene.h"
#include "scene/limits.h"

namespace clrender::mitsuba {

void SceneReader::read_projector(Properties &properties, Emitter &emitter) {
    emitter.kind = EmitterKind::projector;
    emitter.radiance = read_colour(properties, "irradiance", SpectrumUse::emission);
    if (emitter.radiance == none)
        throw InputError(properties.where(),
                         properties.description() + " has no \"irradiance\", expected a texture");
    emitter.scale = properties.number("scale", 1);
    if (emitter.scale < 0)
        properties.fail("scale", "is negative, expected no number below 0");
    if (emitter.scale > max_radiance)
        properties.fail("scale", "is too large, expected no number above 1e+30");
    emitter.to_world = properties.transform("to_world");
    const FieldOfView field = read_field_of_view(properties);
    emitter.fov = field.degrees;
    emitter.fov_axis = field.axis;
}

} // namespace clrender::mitsuba
