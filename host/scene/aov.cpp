#include "aov.h"

#include <algorithm>

namespace clrender {

std::vector<std::string> aov_suffixes(AovType type) {
    switch (type) {
    case AovType::albedo:
    case AovType::reflectance:
        return {"R", "G", "B"};
    case AovType::depth:
        return {"T"};
    case AovType::camera_depth:
        return {"Z"};
    case AovType::uv:
    case AovType::duv_dx:
    case AovType::duv_dy:
        return {"U", "V"};
    case AovType::prim_index:
    case AovType::shape_index:
        return {"I"};
    case AovType::position:
    case AovType::geo_normal:
    case AovType::sh_normal:
    case AovType::dp_du:
    case AovType::dp_dv:
        break;
    }
    return {"X", "Y", "Z"};
}

const std::vector<std::string> &aov_type_names() {
    static const std::vector<std::string> names = {
        "albedo", "depth", "position", "uv",     "geo_normal", "sh_normal",
        "dp_du",  "dp_dv", "duv_dx",   "duv_dy", "prim_index", "shape_index"};
    return names;
}

std::optional<AovType> aov_type_of(const std::string &name) {
    const auto &names = aov_type_names();
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
        return std::nullopt;
    return static_cast<AovType>(found - names.begin());
}

} // namespace clrender
