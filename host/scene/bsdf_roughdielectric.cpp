#include "mitsuba_scene.h"

namespace clrender::mitsuba {

void SceneReader::read_model(Properties &properties, RoughDielectricBsdf &bsdf) {
    bsdf.microfacets = read_microfacets(properties);
    bsdf.ior = read_iors(properties);
    if (bsdf.ior.interior == bsdf.ior.exterior)
        properties.fail("int_ior", "equals ext_ior, expected two different indices");
    bsdf.specular_reflectance =
        read_colour(properties, "specular_reflectance", SpectrumUse::reflectance);
    bsdf.specular_transmittance =
        read_colour(properties, "specular_transmittance", SpectrumUse::reflectance);
}

} // namespace clrender::mitsuba
