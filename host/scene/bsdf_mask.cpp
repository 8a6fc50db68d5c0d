#include "mitsuba_scene.h"

namespace clrender::mitsuba {

void SceneReader::read_model(Properties &properties, MaskBsdf &bsdf) {
    bsdf.opacity = read_number(properties, "opacity", 0.5);
    bsdf.nested = read_nested(properties, 1).front();
}

} // namespace clrender::mitsuba
