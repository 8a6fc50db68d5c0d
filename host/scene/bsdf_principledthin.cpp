#include "mitsuba_scene.h"

namespace clrender::mitsuba {

void SceneReader::read_model(Properties &properties, PrincipledThinBsdf &bsdf) {
    bsdf.base_color = read_colour(properties, "base_color", SpectrumUse::reflectance);
    bsdf.roughness = read_number(properties, "roughness", 0.5);
    bsdf.anisotropic = read_share(properties, "anisotropic", 0);
    bsdf.spec_trans = read_share(properties, "spec_trans", 0);
    bsdf.eta = read_number(properties, "eta", 1.5);
    bsdf.spec_tint = read_share(properties, "spec_tint", 0);
    bsdf.sheen = read_number(properties, "sheen", 0);
    bsdf.sheen_tint = read_share(properties, "sheen_tint", 0);
    bsdf.flatness = read_share(properties, "flatness", 0);
    bsdf.diff_trans = read_share(properties, "diff_trans", 0, 2);
    // How often lobes are sampled changes the noise alone.
    properties.ignore({"diffuse_reflectance_sampling_rate", "specular_reflectance_sampling_rate",
                       "specular_transmittance_sampling_rate",
                       "diffuse_transmittance_sampling_rate"});
}

} // namespace clrender::mitsuba
