#include "mitsuba_scene.h"
#include "mitsuba_text.h"

namespace clrender::mitsuba {

std::optional<ComplexIor> read_metal(Properties &properties) {
    const bool stated = properties.has("eta") || properties.has("k");
    const std::string material = properties.string("material").value_or("none");
    if (material == "none")
        return {};
    if (stated)
        properties.fail("material", "and eta, k are both given, expected only one of them");
    const auto metal = named_metal(material);
    if (!metal)
        properties.fail("material", "is the unknown metal " + in_quotes(material) + ", " +
                                        expected_one_of(material, named_metal_names()));
    return metal;
}

void SceneReader::read_model(Properties &properties, ConductorBsdf &bsdf) {
    bsdf.specular_reflectance =
        read_colour(properties, "specular_reflectance", SpectrumUse::reflectance);
    if (const auto metal = read_metal(properties)) {
        bsdf.perfect_mirror = false;
        bsdf.eta = metal->eta;
        bsdf.k = metal->k;
        return;
    }

    // With eta 0, the default, everything is reflected.
    bsdf.eta = read_constant(properties, "eta", SpectrumUse::refractive_index, Rgb(0));
    bsdf.k = read_constant(properties, "k", SpectrumUse::refractive_index, Rgb(1));
    bsdf.perfect_mirror = bsdf.eta == Rgb(0);
}

} // namespace clrender::mitsuba
