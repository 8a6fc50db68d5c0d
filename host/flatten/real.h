#pragma once
/// Vectors in the precision of what is flattened: everything in this folder is compiled once with
/// clr_real as float, and once as double, into a namespace for each.

#include "shared/shared_types.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <type_traits>

namespace clrender::inline CLR_PRECISION {

using Vec2 = glm::vec<2, clr_real, glm::defaultp>;
using Vec3 = glm::vec<3, clr_real, glm::defaultp>;

/// In which differences of products of clr_real are exact, or nearly so.
using WideReal = std::conditional_t<std::is_same_v<clr_real, float>, double, long double>;

/// A vector, or a colour, as numbers of that precision.
inline void store(clr_real (&out)[3], const glm::dvec3 &v) {
    out[0] = static_cast<clr_real>(v.x);
    out[1] = static_cast<clr_real>(v.y);
    out[2] = static_cast<clr_real>(v.z);
}

} // namespace clrender::inline CLR_PRECISION
