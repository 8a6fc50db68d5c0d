#pragma once
/// How far a render has come.

#include <limits>

namespace clrender {

/// What is not known is not a number.
struct RenderProgress {
    double paths = 0;     ///< done
    double samples = 0;   ///< a pixel
    int most_samples = 0; ///< that end the render; 0: other rules do
    double fraction = 0;  ///< of the render, 0 to 1
    double seconds_left = std::numeric_limits<double>::quiet_NaN();
    double error = std::numeric_limits<double>::quiet_NaN(); ///< relative error so far
};

} // namespace clrender
