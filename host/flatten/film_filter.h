#pragma once
/// The reconstruction filter as a table to sample from.

#include "scene/film_border.h"
#include "shared/shared_types.h"

#include <vector>

namespace clrender::inline CLR_PRECISION {

/// Value of one axis of the separable filter at `x` pixels from the centre, not normalised. The
/// forms are those of Mitsuba's manual; box 1 within half a pixel.
double filter_value(const ReconstructionFilter &filter, double x);

/// The table that kernels/shared/film_filter.h lays out: CLR_FILTER_SIZE numbers.
std::vector<clr_real> tabulate_filter(const ReconstructionFilter &filter);

} // namespace clrender::inline CLR_PRECISION
