#pragma once
/// Transformations that keep angles.

#include <glm/glm.hpp>

namespace clrender {

/// True if a transformation turns, mirrors and scales alone: lengths and right angles to this
/// share; by default as far as float32 exporters manage.
bool is_similarity(const glm::dmat3 &m, double tolerance = 1e-4);

} // namespace clrender
