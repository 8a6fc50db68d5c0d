#include "mitsuba_scene.h"

namespace clrender::mitsuba {

void SceneReader::read_model(Properties &properties, PrincipledThinBsdf &bsdf) {
    read_model(properties, static_cast<BurleyBsdf &>(bsdf));
    bsdf.eta = read_number(properties, "eta", 1.5);
    bsdf.diff_trans = read_share(properties, "diff_trans", 0, 2);
    // How often lobes are sampled changes the noise alone.
    properties.ignore({"diffuse_reflectance_sampling_rate", "specular_reflectance_sampling_rate",
                       "specular_transmittance_sampling_rate",
                       "diffuse_transmittance_sampling_rate"});
}

} // namespace clrender::mitsuba
