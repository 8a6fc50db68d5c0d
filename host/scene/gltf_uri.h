#pragma once
/// URIs of glTF files: escaped paths, and data in the text itself.

#include <optional>
#include <string>
#include <string_view>

namespace clrender::gltf {

inline bool is_data_uri(std::string_view uri) {
    return uri.starts_with("data:");
}

/// The bytes of a data URI (RFC 2397), as base64 or percent-encoded; none where it is broken.
std::optional<std::string> decode_data_uri(std::string_view uri);

/// A relative URI as a path, %XX decoded; none where it names a scheme ("https:"), or has an escape
/// that is none.
std::optional<std::string> path_of_uri(std::string_view uri);

} // namespace clrender::gltf
