#pragma once
/// The layers of an EXR file beside its picture, as write_image() writes them.

#include "image.h"

#include <optional>
#include <string>

namespace clrender {

/// Layer `name`: the channels NAME.R and so on as they are stored (no change of colour space). None
/// where the file is no EXR file or has no such layer. Throws InputError.
std::optional<Image> read_exr_layer(const std::string &path, const std::string &name);

} // namespace clrender
