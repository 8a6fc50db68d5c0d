#pragma once
/// The reconstruction filter as a table to sample from.

#include "scene/scene.h"

#include <vector>

namespace clrender {

/// Value of one axis of the separable filter at `x` pixels from the centre, not normalised. The
/// forms are those of Mitsuba's manual; box 1 within half a pixel.
double filter_value(const ReconstructionFilter &filter, double x);

/// Where the filter ends, in pixels.
double filter_radius(const ReconstructionFilter &filter);

/// The table that kernels/shared/film_filter.h lays out: CLR_FILTER_SIZE floats.
std::vector<float> tabulate_filter(const ReconstructionFilter &filter);

} // namespace clrender
