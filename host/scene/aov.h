#pragma once
/// Arbitrary output variables: what layers beside a picture tell of what the camera sees first.

#include <optional>
#include <string>
#include <vector>

namespace clrender {

/// The types of Mitsuba's `aov` integrator, and two more: `reflectance`, what a surface scatters of
/// the light of a uniform surrounding, and `camera_depth`, the distance from the eye along the
/// camera's axis.
enum class AovType {
    albedo,
    depth,
    position,
    uv,
    geo_normal,
    sh_normal,
    dp_du,
    dp_dv,
    duv_dx,
    duv_dy,
    prim_index,
    shape_index,
    reflectance,
    camera_depth,
};

/// A layer: its channels are `name` and the suffixes of the type.
struct Aov {
    std::string name;
    AovType type = AovType::depth;
};

/// The suffixes of a type's channels, such as R, G, B.
std::vector<std::string> aov_suffixes(AovType type);

/// The names of Mitsuba's types, in the order of AovType.
const std::vector<std::string> &aov_type_names();

/// One of those.
std::optional<AovType> aov_type_of(const std::string &name);

} // namespace clrender
