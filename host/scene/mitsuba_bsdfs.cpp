/// BSDFs: which reader takes which; bsdf_<kind>.cpp has the readers.

#include "mitsuba_scene.h"
#include "mitsuba_text.h"

namespace clrender::mitsuba {

namespace {

std::vector<std::string> bsdf_types() {
    return {
#define CLR_PLUGIN(type, Model) #type,
#include "bsdf_plugins.def"
#undef CLR_PLUGIN
    };
}

} // namespace

BsdfModel SceneReader::read_model_of(const std::string &type, Properties &properties) {
#define CLR_PLUGIN(name, Model)                                                                    \
    if (type == #name) {                                                                           \
        Model model;                                                                               \
        read_model(properties, model);                                                             \
        return model;                                                                              \
    }
#include "bsdf_plugins.def"
#undef CLR_PLUGIN
    fail_unsupported(document_, properties.object(), bsdf_types());
}

int SceneReader::read_bsdf(int object) {
    if (const auto known = bsdfs_.find(object); known != bsdfs_.end())
        return known->second;
    Properties properties(document_, object);
    if (!open_bsdfs_.insert(object).second)
        throw InputError(properties.where(),
                         properties.description() + " contains itself, expected no such cycle");

    Bsdf bsdf;
    bsdf.id = properties.object().id;
    bsdf.where = properties.where();
    attempt([&] {
        bsdf.model = read_model_of(properties.object().type, properties);
        properties.finish();
    });

    open_bsdfs_.erase(object);
    scene_.bsdfs.push_back(std::move(bsdf));
    return bsdfs_[object] = static_cast<int>(scene_.bsdfs.size()) - 1;
}

std::vector<int> SceneReader::read_nested(Properties &properties, std::size_t count) {
    const auto children = properties.children("bsdf");
    if (children.size() != count)
        throw InputError(properties.where(),
                         properties.description() + " has " + std::to_string(children.size()) +
                             " nested BSDFs, expected " + (count == 1 ? "one" : "two"));
    std::vector<int> nested;
    nested.reserve(children.size());
    for (const Child *child : children)
        nested.push_back(read_bsdf(child->object));
    return nested;
}

int SceneReader::default_bsdf(double reflectance) {
    const auto [known, is_new] = default_bsdfs_.emplace(reflectance, none);
    if (is_new) {
        Bsdf bsdf;
        bsdf.model = DiffuseBsdf{add_constant(Rgb(reflectance))};
        scene_.bsdfs.push_back(std::move(bsdf));
        known->second = static_cast<int>(scene_.bsdfs.size()) - 1;
    }
    return known->second;
}

} // namespace clrender::mitsuba
