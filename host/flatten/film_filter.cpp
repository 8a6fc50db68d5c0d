#include "film_filter.h"

#include "shared/film_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace clrender::inline CLR_PRECISION {

namespace {

/// Mitchell and Netravali, "Reconstruction filters in computer graphics", 1988, equation 8.
double cubic(double x, double b, double c) {
    const double x2 = x * x;
    const double x3 = x2 * x;
    if (x < 1)
        return ((12 - 9 * b - 6 * c) * x3 + (-18 + 12 * b + 6 * c) * x2 + (6 - 2 * b)) / 6;
    if (x < 2)
        return ((-b - 6 * c) * x3 + (6 * b + 30 * c) * x2 + (-12 * b - 48 * c) * x +
                (8 * b + 24 * c)) /
               6;
    return 0;
}

/// sin(pi x) / (pi x), windowed by its own central lobe stretched over `lobes`.
double windowed_sinc(double x, double lobes) {
    if (x < 1e-9)
        return 1;
    if (x > lobes)
        return 0;
    const double a = std::numbers::pi * x;
    return std::sin(a) / a * std::sin(a / lobes) / (a / lobes);
}

} // namespace

double filter_value(const ReconstructionFilter &filter, double x) {
    x = std::abs(x);
    const double radius = filter_radius(filter);
    if (x > radius)
        return 0;
    switch (filter.kind) {
    case FilterKind::box:
        return 1;
    case FilterKind::tent:
        return 1 - x / radius;
    case FilterKind::gaussian: {
        const double alpha = -0.5 / (filter.stddev * filter.stddev);
        return std::max(0.0, std::exp(alpha * x * x) - std::exp(alpha * radius * radius));
    }
    case FilterKind::mitchell:
        return cubic(x, filter.b, filter.c);
    case FilterKind::catmullrom:
        return cubic(x, 0, 0.5);
    case FilterKind::lanczos:
        return windowed_sinc(x, filter.lobes);
    }
    return 0;
}

namespace {

/// The filter as a step function, as Mitsuba's scalar variants evaluate it: step k, from
/// radius k / CLR_FILTER_LEVELS on, has the value at its inner end.
class SteppedFilter {
public:
    explicit SteppedFilter(const ReconstructionFilter &filter)
        : width_(filter_radius(filter) / CLR_FILTER_LEVELS) {
        for (std::size_t k = 0; k < levels; ++k)
            values_[k] = filter_value(filter, width_ * static_cast<double>(k));
    }

    static constexpr std::size_t levels = CLR_FILTER_LEVELS;

    [[nodiscard]] double value(std::size_t level) const { return values_[level]; }
    [[nodiscard]] double radius() const { return width_ * levels; }
    [[nodiscard]] double outer_end(std::size_t level) const {
        return width_ * static_cast<double>(level + 1);
    }

    /// Integral of the filter, or of its size, from distance `x` outwards, on one side.
    [[nodiscard]] double beyond(double x, bool absolute) const {
        double sum = 0;
        for (std::size_t k = 0; k < levels; ++k) {
            const double from = std::max(x, width_ * static_cast<double>(k));
            const double length = std::max(0.0, outer_end(k) - from);
            sum += length * (absolute ? std::abs(values_[k]) : values_[k]);
        }
        return sum;
    }

    /// The distance beyond which `share` of the integral of its size lies, on one side.
    [[nodiscard]] double distance_of(double share) const {
        double rest = share * beyond(0, true);
        for (std::size_t k = levels; k-- > 0;) {
            const double height = std::abs(values_[k]);
            if (rest <= height * width_)
                return outer_end(k) - (height > 0 ? rest / height : 0);
            rest -= height * width_;
        }
        return 0;
    }

private:
    double width_;
    std::array<double, levels> values_{};
};

} // namespace

std::vector<clr_real> tabulate_filter(const ReconstructionFilter &filter) {
    const SteppedFilter stepped(filter);
    const double integral = 2 * stepped.beyond(0, false);
    std::vector<clr_real> table(CLR_FILTER_SIZE, 0.0f);
    const auto at = [&](int offset, std::size_t i) -> clr_real & {
        return table[static_cast<std::size_t>(offset) + i];
    };
    for (std::size_t k = 0; k < SteppedFilter::levels; ++k)
        at(CLR_FILTER_VALUES, k) = static_cast<clr_real>(stepped.value(k) / integral);

    // Places in proportion to |filter|, the left half mirrored; the same ones as the device reads.
    constexpr std::size_t steps = CLR_FILTER_STEPS;
    for (std::size_t i = 0; i <= steps / 2; ++i) {
        const double share = 2 * static_cast<double>(i) / steps;
        const auto distance = static_cast<clr_real>(stepped.distance_of(share));
        at(CLR_FILTER_INVERSE, i) = -distance;
        at(CLR_FILTER_INVERSE, steps - i) = distance;
    }

    // What lies beyond k + 1/2 pixels: of the numbers by the table itself.
    for (std::size_t k = 0; k < CLR_FILTER_EDGES; ++k) {
        const double border = static_cast<double>(k) + 0.5;
        if (border >= stepped.radius())
            continue;
        std::size_t i = 0;
        while (i < steps / 2 && -static_cast<double>(at(CLR_FILTER_INVERSE, i + 1)) > border)
            ++i;
        const double outer = -static_cast<double>(at(CLR_FILTER_INVERSE, i));
        const double inner = -static_cast<double>(at(CLR_FILTER_INVERSE, i + 1));
        const double part = outer > inner ? (outer - border) / (outer - inner) : 0;
        at(CLR_FILTER_EDGE, k) = static_cast<clr_real>((static_cast<double>(i) + part) / steps);
        at(CLR_FILTER_EDGE_SIGNED, k) =
            static_cast<clr_real>(stepped.beyond(border, false) / integral);
    }
    return table;
}

} // namespace clrender::inline CLR_PRECISION
