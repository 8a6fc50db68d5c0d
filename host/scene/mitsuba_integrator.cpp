/// Integrators: path, direct, depth, and moment for the one inside of it.

#include "../log.h"
#include "mitsuba_scene.h"
#include "mitsuba_text.h"

#include <limits>

namespace clrender::mitsuba {

namespace {

constexpr std::int64_t max_count = std::numeric_limits<std::int32_t>::max();

void read_path(Properties &properties, Integrator &integrator) {
    integrator.kind = IntegratorKind::path;
    integrator.max_depth =
        static_cast<int>(properties.integer("max_depth", integrator.max_depth, -1, max_count));
    integrator.rr_depth =
        static_cast<int>(properties.integer("rr_depth", integrator.rr_depth, 1, max_count));
    integrator.hide_emitters = properties.boolean("hide_emitters", false);
}

void read_direct(Properties &properties, Integrator &integrator) {
    integrator.kind = IntegratorKind::direct;
    integrator.hide_emitters = properties.boolean("hide_emitters", false);
    if (properties.has("shading_samples") &&
        (properties.has("emitter_samples") || properties.has("bsdf_samples")))
        properties.fail("shading_samples", "and emitter_samples or bsdf_samples are both given, "
                                           "expected only one of them");
    const auto both = properties.integer("shading_samples", 1, 1, max_count);
    integrator.emitter_samples =
        static_cast<int>(properties.integer("emitter_samples", both, 0, max_count));
    integrator.bsdf_samples =
        static_cast<int>(properties.integer("bsdf_samples", both, 0, max_count));
    if (integrator.emitter_samples == 0 && integrator.bsdf_samples == 0)
        properties.fail("bsdf_samples", "and emitter_samples are both 0, expected at least 1");
}

} // namespace

void SceneReader::read_integrator(int object) {
    Properties properties(document_, object);
    const std::string &type = properties.object().type;
    Integrator &integrator = scene_.integrator;
    integrator = Integrator();
    integrator.where = properties.where();
    properties.ignore({"samples_per_pass", "block_size"});
    if (properties.find("timeout") != nullptr)
        log::warn(properties.where("timeout"), "\"timeout\" is ignored");

    if (type == "path") {
        read_path(properties, integrator);
    } else if (type == "direct") {
        read_direct(properties, integrator);
    } else if (type == "depth") {
        integrator.kind = IntegratorKind::depth;
        properties.ignore({"hide_emitters"});
    } else if (type == "moment") {
        // The moments are further channels: the picture is that of the integrator inside.
        properties.ignore({"hide_emitters"});
        const auto nested = properties.children("integrator");
        if (nested.size() != 1)
            throw InputError(properties.where(), properties.description() + " has " +
                                                     std::to_string(nested.size()) +
                                                     " nested integrators, expected one");
        if (document_.at(nested[0]->object).type == "moment")
            throw InputError(properties.where(), properties.description() +
                                                     " is nested, expected a path integrator "
                                                     "inside");
        read_integrator(nested[0]->object);
    } else {
        fail_unsupported(document_, properties.object(), {"path", "direct", "depth", "moment"});
    }
    properties.finish();
}

} // namespace clrender::mitsuba
