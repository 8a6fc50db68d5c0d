#pragma once
/// Pictures that are layers: those of the integrators inside of `aov` and `moment`.

#include "render.h"

namespace clrender {

/// Renders the scene, and its inner pictures as layers before all others: each in R, G, B and A, or
/// for `moment` its mean in X, Y and Z.
RenderResult render_with_inner_pictures(Scene &&scene, const RenderOptions &options);

} // namespace clrender
