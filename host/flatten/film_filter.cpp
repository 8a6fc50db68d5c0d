#include "film_filter.h"

#include "shared/film_filter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace clrender {

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

double filter_radius(const ReconstructionFilter &filter) {
    switch (filter.kind) {
    case FilterKind::box:
        return 0.5;
    case FilterKind::tent:
        return filter.radius;
    case FilterKind::gaussian:
        return 4 * filter.stddev;
    case FilterKind::mitchell:
    case FilterKind::catmullrom:
        return 2;
    case FilterKind::lanczos:
        return filter.lobes;
    }
    return 0;
}

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

std::vector<float> tabulate_filter(const ReconstructionFilter &filter) {
    // The running integrals of |filter| and of the filter by the midpoint rule, much finer than the
    // table: the rule's error is of second order.
    constexpr std::size_t cells = std::size_t{1} << 16;
    const double radius = filter_radius(filter);
    const double width = 2 * radius / static_cast<double>(cells);
    std::vector<double> absolute(cells + 1, 0.0), plain(cells + 1, 0.0);
    const auto left_of = [&](std::size_t i) { return -radius + width * static_cast<double>(i); };
    for (std::size_t i = 0; i < cells; ++i) {
        const double value = filter_value(filter, left_of(i) + width / 2);
        absolute[i + 1] = absolute[i] + std::abs(value);
        plain[i + 1] = plain[i] + value;
    }

    // Equal shares of |filter|, by linear interpolation of the running integral.
    std::vector<float> table(CLR_FILTER_SIZE, 0.0f);
    const auto place_of_share = [&](double share) {
        const double target = share * absolute.back();
        const auto above = std::upper_bound(absolute.begin(), absolute.end() - 1, target);
        const std::size_t cell =
            std::min(static_cast<std::size_t>(above - absolute.begin()), cells) - 1;
        const double step = absolute[cell + 1] - absolute[cell];
        return left_of(cell) + (step > 0 ? width * (target - absolute[cell]) / step : 0);
    };
    for (int i = 0; i <= CLR_FILTER_STEPS; ++i) {
        const double share = static_cast<double>(i) / CLR_FILTER_STEPS;
        table[static_cast<std::size_t>(CLR_FILTER_INVERSE + i)] =
            static_cast<float>(place_of_share(share));
        if (i < CLR_FILTER_STEPS) {
            const double middle = place_of_share(share + 0.5 / CLR_FILTER_STEPS);
            table[static_cast<std::size_t>(CLR_FILTER_SIGN + i)] =
                filter_value(filter, middle) < 0 ? -1.0f : 1.0f;
        }
    }

    // What lies beyond k + 1/2 pixels on one side.
    for (int k = 0; k < CLR_FILTER_EDGES; ++k) {
        const double border = k + 0.5;
        if (border >= radius)
            continue;
        const auto cell = static_cast<std::size_t>((radius - border) / width);
        table[static_cast<std::size_t>(CLR_FILTER_EDGE + k)] =
            static_cast<float>(absolute[cell] / absolute.back());
        table[static_cast<std::size_t>(CLR_FILTER_EDGE_SIGNED + k)] =
            static_cast<float>(plain[cell] / plain.back());
    }
    table[CLR_FILTER_NORM] = static_cast<float>(absolute.back() / plain.back());
    return table;
}

} // namespace clrender
