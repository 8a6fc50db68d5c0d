#pragma once
/// How far a film's samples reach.

#include "scene.h"

namespace clrender {

/// Where the filter ends, in pixels.
double filter_radius(const ReconstructionFilter &filter);

/// How many pixels beyond its own a sample reaches.
int filter_border(const ReconstructionFilter &filter);

/// How many pixels on each side of the crop window are sampled as well.
int sampled_border(const FilmSettings &film);

} // namespace clrender
