/// Emitter "directional".

#include "mitsuba_scene.h"

namespace clrender::mitsuba {

void SceneReader::read_directional(Properties &properties, Emitter &emitter) {
    emitter.kind = EmitterKind::directional;
    emitter.intensity = read_constant(properties, "irradiance", SpectrumUse::emission, Rgb(1));
    if (properties.has("direction") && properties.has("to_world"))
        properties.fail("direction", "and to_world are both given, expected only one of them");
    const glm::dvec3 direction =
        properties.point("direction").value_or(glm::dvec3(properties.transform("to_world")[2]));
    const double length = glm::length(direction);
    if (!(length > 0))
        properties.fail("direction", "has no length, expected a vector along which light travels");
    emitter.direction = direction / length;
}

} // namespace clrender::mitsuba
