#include "mitsuba_scene.h"

namespace clrender::mitsuba {

void SceneReader::read_model(Properties &properties, DiffuseBsdf &bsdf) {
    bsdf.reflectance = read_colour(properties, "reflectance", SpectrumUse::reflectance);
    if (bsdf.reflectance == none)
        bsdf.reflectance = add_constant(Rgb(.5));
}

} // namespace clrender::mitsuba
