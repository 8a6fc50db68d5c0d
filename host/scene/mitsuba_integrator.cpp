/// Integrators: path and those that estimate the same light, direct, depth, and those that add
/// layers to the picture of one inside of them.

#include "../log.h"
#include "mitsuba_scene.h"
#include "mitsuba_text.h"

#include <algorithm>
#include <limits>

namespace clrender::mitsuba {

namespace {

constexpr std::int64_t max_count = std::numeric_limits<std::int32_t>::max();

void read_path(Properties &properties, Integrator &integrator) {
    integrator.kind = IntegratorKind::path;
    integrator.max_depth =
        static_cast<int>(properties.integer("max_depth", integrator.max_depth, -1, max_count));
    const int rr_depth = static_cast<int>(properties.integer("rr_depth", 1, 1, max_count));
    if (properties.has("rr_depth"))
        integrator.rr_depth = rr_depth;
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

bool is_point_like(const Emitter &emitter) {
    return emitter.kind != EmitterKind::area && emitter.kind != EmitterKind::constant &&
           emitter.kind != EmitterKind::envmap && emitter.kind != EmitterKind::sunsky;
}

bool lets_pass_straight(const Bsdf &bsdf) {
    return std::holds_alternative<NullBsdf>(bsdf.model) ||
           std::holds_alternative<MaskBsdf>(bsdf.model) ||
           std::holds_alternative<ThinDielectricBsdf>(bsdf.model);
}

template <typename Items, typename Test> bool has_any(const Items &items, Test test) {
    return std::any_of(items.begin(), items.end(), test);
}

/// Warns of light that the scene's own integrator finds and path tracing does not.
void warn_of_differences(const Scene &scene, const SourceLocation &where, const SameLight &other) {
    const bool has_point_like = has_any(scene.emitters, is_point_like);
    const auto is_smooth = [&](const Bsdf &bsdf) { return is_mirror_like(scene, bsdf); };
    if (other.finds_caustics && has_point_like && has_any(scene.bsdfs, is_smooth))
        log::warn(where, "light of lights without extent that smooth glass or mirrors bring "
                         "(caustics) is found by this integrator, but not by path tracing");
    if (other.skips_passages && has_point_like && has_any(scene.bsdfs, lets_pass_straight))
        log::warn(where, "lights without extent do not shine through what lets light pass "
                         "straight in path tracing, but do in this integrator");
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
    } else if (type == "aov" || type == "moment") {
        read_layers(properties);
    } else if (type == "direct_projective" || type == "direct_reparam") {
        read_direct(properties, integrator);
        properties.ignore_rest();
        log::warn(properties.where(), properties.description() + " is rendered as \"direct\"");
    } else if (type == "irrcache" || type == "adaptive") {
        read_wrapped_integrator(properties);
    } else if (const SameLight *other = same_light_as_path(type)) {
        read_other_integrator(properties, *other);
    } else {
        fail_unsupported(document_, properties.object(),
                         {"path", "direct", "depth", "aov", "moment"});
    }
    properties.finish();
}

/// Integrators of Mitsuba 0.6 that bring the light that the one inside of them finds, from fewer of
/// its samples.
void SceneReader::read_wrapped_integrator(Properties &properties) {
    const auto nested = properties.children("integrator");
    if (nested.size() != 1)
        throw InputError(properties.where(), properties.description() + " has " +
                                                 std::to_string(nested.size()) +
                                                 " nested integrators, expected one");
    const Object &inner = document_.at(nested.front()->object);
    if (inner.type == "aov" || inner.type == "moment")
        throw InputError(document_.where(inner), "integrator " + in_quotes(inner.type) +
                                                     " is nested, expected a path integrator here");
    for (const char *part : {"indirect_only", "debug"})
        if (properties.boolean(part, false))
            throw UnsupportedError(properties.where(part), in_quotes(part) + " of " +
                                                               properties.description() +
                                                               " is not supported, expected false");
    properties.ignore_rest();
    read_integrator(nested.front()->object);
    log::warn(properties.where(), properties.description() +
                                      " is left out: the integrator inside of it estimates the "
                                      "same light");
}

void SceneReader::read_other_integrator(Properties &properties, const SameLight &other) {
    Integrator &integrator = scene_.integrator;
    integrator.max_depth = other.max_depth;
    integrator.skips_passages = other.skips_passages;
    read_path(properties, integrator);

    // What else it states tells how the light is found, not how much there is.
    properties.ignore_rest();
    log::warn(properties.where(), properties.description() +
                                      " is rendered by path tracing, which estimates the same "
                                      "light");
    warn_of_differences(scene_, properties.where(), other);
}

} // namespace clrender::mitsuba
