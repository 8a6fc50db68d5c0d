#pragma once
/// The JSON text of a glTF file.

#include "../error.h"

#include <nlohmann/json.hpp>

#include <string>
#include <string_view>

namespace clrender::gltf {

/// The text as a value, without the members "extras" of all objects, which no reader asks for.
/// Checked before it is kept: its syntax, its depth, that numbers are finite, and that what it
/// takes in memory is to be had. Faults name a line where the text `has_lines`. Throws
/// InputError.
nlohmann::json parse_json(std::string_view text, const std::string &path, bool has_lines);

} // namespace clrender::gltf
