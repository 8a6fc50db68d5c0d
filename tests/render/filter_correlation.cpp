/// How strongly a reconstruction filter makes the noise of neighbouring pixels agree.

#include "z_test.h"

#include <cmath>
#include <numbers>

namespace clrender::test {

namespace {

double cubic(double x, double b, double c) {
    if (x >= 2)
        return 0;
    if (x < 1)
        return ((12 - 9 * b - 6 * c) * x * x * x + (-18 + 12 * b + 6 * c) * x * x + 6 - 2 * b) / 6;
    return ((-b - 6 * c) * x * x * x + (6 * b + 30 * c) * x * x + (-12 * b - 48 * c) * x + 8 * b +
            24 * c) /
           6;
}

double sinc(double x) {
    const double angle = std::numbers::pi * x;
    return angle == 0 ? 1 : std::sin(angle) / angle;
}

/// The filter along one axis at the distance x >= 0.
double weight(const ReconstructionFilter &filter, double x) {
    switch (filter.kind) {
    case FilterKind::box:
        return x < 0.5 ? 1 : 0;
    case FilterKind::tent:
        return std::max(0., 1 - x / filter.radius);
    case FilterKind::gaussian: {
        const double exponent = -0.5 / (filter.stddev * filter.stddev);
        const double radius = 4 * filter.stddev;
        return std::max(0., std::exp(exponent * x * x) - std::exp(exponent * radius * radius));
    }
    case FilterKind::mitchell:
        return cubic(x, filter.b, filter.c);
    case FilterKind::catmullrom:
        return cubic(x, 0, 0.5);
    case FilterKind::lanczos:
        return x < filter.lobes ? sinc(x) * sinc(x / filter.lobes) : 0;
    }
    return 0;
}

} // namespace

double correlation_factor(const ReconstructionFilter &filter) {
    double sum = 0, sum_of_squares = 0;
    constexpr double step = 1e-3;
    for (double x = step / 2; x < 16; x += step) {
        const double w = weight(filter, x);
        sum += 2 * w * step;
        sum_of_squares += 2 * w * w * step;
    }
    const double one_axis = sum * sum / sum_of_squares;
    return one_axis * one_axis;
}

} // namespace clrender::test
