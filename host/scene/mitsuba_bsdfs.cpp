/// BSDFs: diffuse, conductor, dielectric, twosided.

#include "../log.h"
#include "mitsuba_scene.h"
#include "mitsuba_text.h"
#include "named_media.h"

namespace clrender::mitsuba {

namespace {

const std::vector<std::string> bsdf_types{"diffuse", "conductor", "dielectric", "twosided"};

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

int SceneReader::read_bsdf(int object) {
    if (const auto known = bsdfs_.find(object); known != bsdfs_.end())
        return known->second;
    Properties properties(document_, object);
    if (!open_bsdfs_.insert(object).second)
        throw InputError(properties.where(),
                         properties.description() + " contains itself, expected no such cycle");

    using Reader = void (SceneReader::*)(Properties &, Bsdf &);
    static const std::map<std::string, std::pair<BsdfKind, Reader>> readers{
        {"diffuse", {BsdfKind::diffuse, &SceneReader::read_diffuse}},
        {"conductor", {BsdfKind::conductor, &SceneReader::read_conductor}},
        {"dielectric", {BsdfKind::dielectric, &SceneReader::read_dielectric}},
        {"twosided", {BsdfKind::twosided, &SceneReader::read_twosided}}};
    const auto reader = readers.find(properties.object().type);
    if (reader == readers.end())
        fail_unsupported(document_, properties.object(), bsdf_types);

    Bsdf bsdf;
    bsdf.kind = reader->second.first;
    bsdf.id = properties.object().id;
    bsdf.where = properties.where();
    (this->*reader->second.second)(properties, bsdf);
    properties.finish();

    open_bsdfs_.erase(object);
    scene_.bsdfs.push_back(std::move(bsdf));
    return bsdfs_[object] = static_cast<int>(scene_.bsdfs.size()) - 1;
}

void SceneReader::read_diffuse(Properties &properties, Bsdf &bsdf) {
    bsdf.reflectance = read_colour(properties, "reflectance", SpectrumUse::reflectance);
    if (bsdf.reflectance == none)
        bsdf.reflectance = add_constant(Rgb(.5));
}

void SceneReader::read_conductor(Properties &properties, Bsdf &bsdf) {
    bsdf.specular_reflectance =
        read_colour(properties, "specular_reflectance", SpectrumUse::reflectance);

    // A named material states both parts of the index.
    const bool stated = properties.has("eta") || properties.has("k");
    const std::string material = properties.string("material").value_or("none");
    if (material != "none") {
        if (stated)
            properties.fail("material", "and eta, k are both given, expected only one of them");
        const auto metal = named_metal(material);
        if (!metal)
            properties.fail("material", "is the unknown metal " + in_quotes(material) + ", " +
                                            expected_one_of(material, named_metal_names()));
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

void SceneReader::read_dielectric(Properties &properties, Bsdf &bsdf) {
    bsdf.int_ior = read_ior(properties, "int_ior", bsdf.int_ior);
    bsdf.ext_ior = read_ior(properties, "ext_ior", bsdf.ext_ior);
    bsdf.specular_reflectance =
        read_colour(properties, "specular_reflectance", SpectrumUse::reflectance);
    bsdf.specular_transmittance =
        read_colour(properties, "specular_transmittance", SpectrumUse::reflectance);
}

void SceneReader::read_twosided(Properties &properties, Bsdf &bsdf) {
    const auto nested = properties.children("bsdf");
    if (nested.empty() || nested.size() > 2)
        throw InputError(properties.where(), properties.description() + " has " +
                                                 std::to_string(nested.size()) +
                                                 " nested BSDFs, expected one or two");
    for (const Child *child : nested)
        if (document_.at(child->object).type == "dielectric")
            throw InputError(document_.where(properties.object(), child->line),
                             "twosided contains a dielectric, expected a BSDF that lets no light "
                             "through");
    bsdf.front = read_bsdf(nested.front()->object);
    bsdf.back = read_bsdf(nested.back()->object);

    // Both sides of the outer BSDF show the front of a nested one.
    for (int *side : {&bsdf.front, &bsdf.back}) {
        const Bsdf &inner = scene_.bsdfs.at(static_cast<std::size_t>(*side));
        if (inner.kind == BsdfKind::twosided)
            *side = inner.front;
    }
}

int SceneReader::default_bsdf(double reflectance) {
    const auto [known, is_new] = default_bsdfs_.emplace(reflectance, none);
    if (is_new) {
        Bsdf bsdf;
        bsdf.reflectance = add_constant(Rgb(reflectance));
        scene_.bsdfs.push_back(std::move(bsdf));
        known->second = static_cast<int>(scene_.bsdfs.size()) - 1;
    }
    return known->second;
}

} // namespace clrender::mitsuba
