#include "mitsuba_scene.h"

namespace clrender::mitsuba {

void SceneReader::read_model(Properties &properties, ThinDielectricBsdf &bsdf) {
    bsdf.ior = read_iors(properties);
    read_tints(properties, bsdf);
}

} // namespace clrender::mitsuba
