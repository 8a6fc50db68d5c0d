#include "mitsuba_scene.h"

namespace clrender::mitsuba {

void SceneReader::read_model(Properties &properties, ThinDielectricBsdf &bsdf) {
    bsdf.ior = read_iors(properties);
    bsdf.specular_reflectance =
        read_colour(properties, "specular_reflectance", SpectrumUse::reflectance);
    bsdf.specular_transmittance =
        read_colour(properties, "specular_transmittance", SpectrumUse::reflectance);
}

} // namespace clrender::mitsuba
