#include "mitsuba_scene.h"

namespace clrender::mitsuba {

void SceneReader::read_model(Properties &properties, RoughDielectricBsdf &bsdf) {
    bsdf.microfacets = read_microfacets(properties);
    bsdf.ior = read_iors(properties);
    if (bsdf.ior.interior == bsdf.ior.exterior)
        properties.fail("int_ior", "equals ext_ior, expected two different indices");
    read_tints(properties, bsdf);
}

} // namespace clrender::mitsuba
