#pragma once
/// Discrete distributions that are sampled in constant time.

#include "shared/scene_data.h"

#include <span>
#include <vector>

namespace clrender {

/// Walker's table by Vose's method ("A linear algorithm for generating random numbers with a given
/// distribution", 1991) for weights of which at least one is positive and none is negative.
std::vector<AliasEntry> build_alias_table(std::span<const double> weights);

} // namespace clrender
