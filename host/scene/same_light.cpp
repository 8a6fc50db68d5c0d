#include "same_light.h"

#include <array>

namespace clrender::mitsuba {

namespace {

/// Of Mitsuba 0.6, 2 and 3 and the best-known forks. Those for derivatives (prb_...) have a depth
/// of 6 where none is stated.
constexpr std::array<SameLight, 33> table{{
    {"volpath", -1, false, true},
    {"volpathmis", -1, false, true},
    {"volpath_simple", -1, false, true},
    {"prb", 6, false, false},
    {"prb_basic", 6, false, false},
    {"prb_reparam", 6, false, false},
    {"prb_projective", 6, false, false},
    {"prb_threepoint", 6, false, false},
    {"prbvolpath", 6, false, true},
    {"prb_volpath", 6, false, true},
    {"bdpt", -1, true, false},
    {"ptracer", -1, true, false},
    {"photonmapper", -1, true, false},
    {"ppm", -1, true, false},
    {"sppm", -1, true, false},
    {"vcm", -1, true, false},
    {"ups", -1, true, false},
    {"pssmlt", -1, true, false},
    {"mlt", -1, true, false},
    {"mmlt", -1, true, false},
    {"mltmis", -1, true, false},
    {"erpt", -1, true, false},
    {"manifold", -1, true, false},
    {"guided_path", -1, false, false},
    {"guidedpath", -1, false, false},
    {"path_guiding", -1, false, false},
    {"pathguiding", -1, false, false},
    {"guided_bdpt", -1, true, false},
    {"gpt", -1, false, false},
    {"gbdpt", -1, true, false},
    {"lighttracer", -1, true, false},
    {"restir", -1, false, false},
    {"path_mis", -1, false, false},
}};

} // namespace

const SameLight *same_light_as_path(const std::string &type) {
    for (const SameLight &entry : table)
        if (type == entry.type)
            return &entry;
    return nullptr;
}

} // namespace clrender::mitsuba
