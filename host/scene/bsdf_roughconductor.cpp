#include "mitsuba_scene.h"

namespace clrender::mitsuba {

MicrofacetKind read_distribution(Properties &properties) {
    properties.ignore({"sample_visible"});
    return static_cast<MicrofacetKind>(properties.choice("distribution", 0, {"beckmann", "ggx"}));
}

MicrofacetModel SceneReader::read_microfacets(Properties &properties) {
    MicrofacetModel model;
    model.kind = read_distribution(properties);
    if (!properties.has("alpha_u") && !properties.has("alpha_v")) {
        model.alpha_u = model.alpha_v = read_number(properties, "alpha", 0.1);
        return model;
    }
    for (const char *name : {"alpha_u", "alpha_v"})
        if (!properties.has(name))
            properties.fail(name, "is missing, expected both alpha_u and alpha_v, or alpha");
    if (properties.has("alpha"))
        properties.fail("alpha", "and alpha_u, alpha_v are both given, expected only one of them");
    model.alpha_u = read_number(properties, "alpha_u", 0.1);
    model.alpha_v = read_number(properties, "alpha_v", 0.1);
    return model;
}

void SceneReader::read_model(Properties &properties, RoughConductorBsdf &bsdf) {
    bsdf.microfacets = read_microfacets(properties);
    bsdf.specular_reflectance =
        read_colour(properties, "specular_reflectance", SpectrumUse::reflectance);
    if (const auto metal = read_metal(properties)) {
        bsdf.eta = add_constant(metal->eta);
        bsdf.k = add_constant(metal->k);
        return;
    }
    bsdf.eta = read_colour(properties, "eta", SpectrumUse::refractive_index);
    bsdf.k = read_colour(properties, "k", SpectrumUse::refractive_index);
}

} // namespace clrender::mitsuba
