#include "../log.h"
#include "mitsuba_scene.h"
#include "mitsuba_text.h"

#include <fmt/format.h>

#include <cmath>

namespace clrender::mitsuba {

int SceneReader::read_share(Properties &properties, const std::string &name, double fallback,
                            double most) {
    const int index = read_number(properties, name, fallback);
    const Texture &texture = scene_.textures.at(static_cast<std::size_t>(index));
    if (texture.kind == TextureKind::constant && texture.value.x > most)
        log::warn(properties.where(name),
                  fmt::format("{} is above {:g}, which takes its place", in_quotes(name), most));
    return index;
}

void SceneReader::read_model(Properties &properties, BurleyBsdf &bsdf) {
    bsdf.base_color = read_colour(properties, "base_color", SpectrumUse::reflectance);
    bsdf.roughness = read_number(properties, "roughness", 0.5);
    bsdf.anisotropic = read_share(properties, "anisotropic", 0);
    bsdf.spec_trans = read_share(properties, "spec_trans", 0);
    bsdf.spec_tint = read_share(properties, "spec_tint", 0);
    bsdf.sheen = read_number(properties, "sheen", 0);
    bsdf.sheen_tint = read_share(properties, "sheen_tint", 0);
    bsdf.flatness = read_share(properties, "flatness", 0);
}

void SceneReader::read_model(Properties &properties, PrincipledBsdf &bsdf) {
    read_model(properties, static_cast<BurleyBsdf &>(bsdf));
    const Texture &passing = scene_.textures.at(static_cast<std::size_t>(bsdf.spec_trans));
    if (passing.kind == TextureKind::constant && passing.value.x == 0)
        bsdf.spec_trans = none;
    bsdf.metallic = read_share(properties, "metallic", 0);
    bsdf.clearcoat = read_share(properties, "clearcoat", 0);
    bsdf.clearcoat_gloss = read_share(properties, "clearcoat_gloss", 0);
    // How often lobes are sampled changes the noise alone.
    properties.ignore({"diffuse_reflectance_sampling_rate", "main_specular_sampling_rate",
                       "clearcoat_sampling_rate"});

    // Glass without a difference of indices has no direction of refraction: Mitsuba's ways out.
    const bool glass = bsdf.spec_trans != none;
    if (properties.has("eta") && properties.has("specular"))
        properties.fail("specular", "and eta are both given, expected only one of them");
    if (properties.has("eta")) {
        bsdf.eta = properties.number("eta", 1.5);
        if (!(bsdf.eta > 0))
            properties.fail("eta", "is not positive, expected an index above 0, such as 1.5");
        if (glass && bsdf.eta == 1)
            bsdf.eta = 1.001;
        return;
    }
    double specular = properties.number("specular", 0.5);
    if (!(specular >= 0 && 0.08 * specular < 1))
        properties.fail("specular", "is out of range, expected a number from 0 to 1");
    if (glass && specular == 0)
        specular = 1e-3;
    bsdf.eta = 2 / (1 - std::sqrt(0.08 * specular)) - 1;
}

} // namespace clrender::mitsuba
