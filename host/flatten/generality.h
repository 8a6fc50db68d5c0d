#pragma once
/// A kernel that can do more than its scene needs: for measuring what specialising it brings.

#include "shared/shared_types.h"

#include <set>
#include <string>

namespace clrender::inline CLR_PRECISION {

struct FlatScene;

/// Names of kernel_config.def that the kernel is to be able to do, needed or not.
using Generality = std::set<std::string>;

/// All that a kernel can be compiled with for any scene. What decides how the picture is defined
/// (filter, sampler, integrator, hidden emitters) is not among it, nor is the width.
const Generality &full_generality();

/// Sets the wanted fields of the configuration to what serves every scene, and gives arrays that
/// the scene does not need one harmless element. The steps of flatten() have put in what shifts
/// indices: a sphere and a rectangle that no ray meets, lights without light.
void apply_generality(const Generality &wanted, FlatScene &flat);

} // namespace clrender::inline CLR_PRECISION
