#pragma once
/// Primitives compressed with KHR_draco_mesh_compression, through the Draco library.

#include "gltf_accessors.h"

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace clrender::gltf {

struct CompressedPrimitive {
    std::vector<std::array<std::uint32_t, 3>> triangles; ///< of vertices below `vertices`
    std::size_t vertices = 0;
    std::map<std::string, Numbers> attributes; ///< by the primitive's name for them
};

/// The compressed data of a primitive, or none where it has none. The sizes in the data's header
/// are checked, and memory is claimed for them, before the library sees it. Throws InputError.
std::optional<CompressedPrimitive>
decompress(const Document &document, const tinygltf::Primitive &source, const std::string &place);

} // namespace clrender::gltf
