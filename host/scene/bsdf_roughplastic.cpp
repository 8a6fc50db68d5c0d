#include "mitsuba_scene.h"

namespace clrender::mitsuba {

void SceneReader::read_model(Properties &properties, RoughPlasticBsdf &bsdf) {
    read_model(properties, bsdf.plastic);
    if (bsdf.plastic.ior.interior == bsdf.plastic.ior.exterior)
        properties.fail("int_ior", "equals ext_ior, expected two different indices");
    bsdf.microfacets = read_distribution(properties);
    bsdf.alpha = properties.number("alpha", bsdf.alpha);
    if (!(bsdf.alpha >= 0))
        properties.fail("alpha", "is negative, expected a roughness from 0 to 1");
}

} // namespace clrender::mitsuba
