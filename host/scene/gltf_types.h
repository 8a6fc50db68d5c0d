#pragma once
/// The JSON types of a glTF file's members.

#include "gltf_document.h"

#include <nlohmann/json.hpp>

namespace clrender::gltf {

/// Refuses members of another type than the standard states, which tinygltf passes over: a node
/// whose "mesh" is no number would be a node without one. Throws InputError with the place.
void check_types(const nlohmann::json &root, const Document &document);

} // namespace clrender::gltf
