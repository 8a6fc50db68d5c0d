#include "mitsuba_scene.h"
#include "mitsuba_text.h"

namespace clrender::mitsuba {

namespace {

/// An index of refraction: a number or the name of a medium.
double read_ior(Properties &properties, const std::string &name, double fallback) {
    const Property *property = properties.find(name);
    if (property == nullptr)
        return fallback;
    if (const auto *medium = std::get_if<std::string>(&property->value)) {
        if (const auto ior = named_ior(*medium))
            return *ior;
        properties.fail(name, "is the unknown medium " + in_quotes(*medium) + ", " +
                                  expected_one_of(*medium, named_ior_names()));
    }
    const double ior = properties.number(name, fallback);
    if (!(ior > 0))
        properties.fail(name, "is not positive, expected an index above 0, such as 1.5");
    return ior;
}

} // namespace

IndicesOfRefraction read_iors(Properties &properties, IndicesOfRefraction ior) {
    ior.interior = read_ior(properties, "int_ior", ior.interior);
    ior.exterior = read_ior(properties, "ext_ior", ior.exterior);
    return ior;
}

void SceneReader::read_model(Properties &properties, DielectricBsdf &bsdf) {
    bsdf.ior = read_iors(properties);
    read_tints(properties, bsdf);
}

} // namespace clrender::mitsuba
