#pragma once
/// The texture statements of MTL files: map_Kd [options] FILE.

#include <glm/glm.hpp>

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace clrender {

struct MtlMap {
    std::string file;               ///< as written, with / for \, without quotes
    glm::dvec2 scale{1}, offset{0}; ///< -s, -o: looked up at scale * (u, v) + offset
    bool is_clamped = false;        ///< -clamp on
    double bump_scale = 1;          ///< -bm
    std::set<std::string> ignored;  ///< options that change the picture, but are not rendered
};

/// Parses the words behind the keyword. Returns what is wrong with them, "" if nothing.
std::string parse_mtl_map(const std::vector<std::string_view> &words, MtlMap &map);

} // namespace clrender
