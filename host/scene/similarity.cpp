#include "similarity.h"

#include <cmath>

namespace clrender {

bool is_similarity(const glm::dmat3 &m, double tolerance) {
    const double size = glm::length(m[0]);
    for (int i = 0; i < 3; ++i) {
        if (std::abs(glm::length(m[i]) - size) > tolerance * size)
            return false;
        if (std::abs(glm::dot(m[i], m[(i + 1) % 3])) > tolerance * size * size)
            return false;
    }
    return true;
}

} // namespace clrender
