#include "mitsuba_scene.h"

namespace clrender::mitsuba {

void SceneReader::read_model(Properties &properties, PlasticBsdf &bsdf) {
    bsdf.ior = read_iors(properties, bsdf.ior);
    bsdf.diffuse_reflectance =
        read_colour(properties, "diffuse_reflectance", SpectrumUse::reflectance);
    bsdf.specular_reflectance =
        read_colour(properties, "specular_reflectance", SpectrumUse::reflectance);
    bsdf.nonlinear = properties.boolean("nonlinear", false);
}

} // namespace clrender::mitsuba
