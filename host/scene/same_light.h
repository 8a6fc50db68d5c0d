#pragma once
/// Integrators that estimate the light that path tracing estimates.

#include <string>

namespace clrender::mitsuba {

struct SameLight {
    const char *type;
    int max_depth;       ///< where the scene states none
    bool finds_caustics; ///< of lights without extent, which path tracing does not find
    bool skips_passages; ///< what lets light pass straight does not count as a segment
};

/// The entry of a table, or null for other integrators.
const SameLight *same_light_as_path(const std::string &type);

} // namespace clrender::mitsuba
