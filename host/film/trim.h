#pragma once
/// Pictures without what was only sampled for their borders.

#include "image/image.h"

namespace clrender {

/// Takes `border` pixels off each side of a picture of floats; leaves an empty one as it is.
void trim(Image &image, int border);

} // namespace clrender
