#pragma once
/// The difference between two pictures as the eye sees it when it flips between them.

#include "image/image.h"

namespace clrender {

/// The LDR-FLIP map of two pictures of one size, at 67 pixels a degree (a 0.7 m wide screen of 3840
/// pixels seen from 0.7 m): Andersson et al., "FLIP: A Difference Evaluator for Alternating
/// Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020. One channel, 0 (equal) to 1.
/// Values are in linear light, clamped to [0, 1]; those of 8-bit pictures are decoded from sRGB.
/// Pixels that are not finite count as black.
Image flip_map(const Image &a, const Image &reference);

} // namespace clrender
