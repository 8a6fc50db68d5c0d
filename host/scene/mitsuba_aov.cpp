/// Integrators that add layers to the picture of others inside of them: aov and moment.

#include "../log.h"
#include "mitsuba_scene.h"
#include "mitsuba_text.h"

#include <algorithm>
#include <fmt/core.h>

namespace clrender::mitsuba {

namespace {

/// One "name:type" of the list.
Aov parse_aov(Properties &properties, const std::string &token) {
    const std::size_t colon = token.find(':');
    if (colon == std::string::npos || colon == 0 || colon + 1 == token.size() ||
        token.find(':', colon + 1) != std::string::npos)
        properties.fail("aovs", "contains " + in_quotes(token) +
                                    ", expected pairs name:type separated by commas");
    const std::string type = token.substr(colon + 1);
    const auto known = aov_type_of(type);
    if (type == "boundary_test")
        throw UnsupportedError(properties.where("aovs"), properties.description() +
                                                             ": the type \"boundary_test\" is not "
                                                             "supported, expected another one");
    if (!known)
        properties.fail("aovs", "contains the unknown type " + in_quotes(type) + ", " +
                                    expected_one_of(type, aov_type_names()));
    return {token.substr(0, colon), *known};
}

/// The list, separated by commas or spaces.
std::vector<Aov> parse_aovs(Properties &properties, const std::string &text) {
    constexpr const char *separators = ", \t\r\n";
    std::vector<Aov> aovs;
    std::size_t begin = text.find_first_not_of(separators);
    while (begin != std::string::npos) {
        const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
        Aov aov = parse_aov(properties, text.substr(begin, end - begin));
        const auto same = [&](const Aov &other) {
            return other.name == aov.name && aov_suffixes(other.type) == aov_suffixes(aov.type);
        };
        if (std::any_of(aovs.begin(), aovs.end(), same))
            properties.fail("aovs", "contains the layer " + in_quotes(aov.name) +
                                        " twice, expected different names");
        aovs.push_back(std::move(aov));
        begin = text.find_first_not_of(separators, end);
    }
    return aovs;
}

} // namespace

/// The picture is that of the first integrator inside, or black where there is none.
void SceneReader::read_layers(Properties &properties) {
    properties.ignore({"hide_emitters"});
    const bool is_aov = properties.object().type == "aov";
    SceneLayers &layers = scene_.layers;
    if (is_aov) {
        const auto text = properties.string("aovs");
        if (!text)
            throw InputError(properties.where(), properties.description() +
                                                     " has no string \"aovs\", expected one: a "
                                                     "list of name:type");
        layers.aovs = parse_aovs(properties, *text);
    }
    const auto nested = properties.children("integrator");
    if (nested.empty()) {
        if (!is_aov)
            throw InputError(properties.where(),
                             properties.description() + " has no nested integrator, expected one");
        scene_.integrator.kind = IntegratorKind::path;
        scene_.integrator.max_depth = 0;
        log::warn(properties.where(), properties.description() +
                                          " has no nested integrator: the picture beside the "
                                          "layers is black");
        return;
    }
    std::vector<IntegratorLayer> pictures;
    int unnamed = 0;
    for (const Child *child : nested) {
        const Object &inner = document_.at(child->object);
        if (inner.type == "aov" || inner.type == "moment")
            throw InputError(properties.where(), properties.description() +
                                                     " is nested, expected a path integrator "
                                                     "inside");
        read_integrator(child->object);
        const std::string name =
            child->name.empty() ? fmt::format("_arg_{}", unnamed++) : child->name;
        pictures.push_back({name, scene_.integrator});
    }
    scene_.integrator = pictures.front().integrator;
    layers.pictures = std::move(pictures);
    layers.moments = !is_aov;
    if (!is_aov)
        log::warn(properties.where(), properties.description() +
                                          ": second moments (layers m2_...) are not supported and "
                                          "left out");
}

} // namespace clrender::mitsuba
