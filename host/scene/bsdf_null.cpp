#include "mitsuba_scene.h"

namespace clrender::mitsuba {

void SceneReader::read_model(Properties &, NullBsdf &) {}

} // namespace clrender::mitsuba
