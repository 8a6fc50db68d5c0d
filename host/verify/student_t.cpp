#include "student_t.h"

#include <algorithm>
#include <cmath>

namespace clrender::verify {

namespace {

/// The continued fraction of the incomplete beta function (DLMF 8.17.22) by Lentz's method, for
/// x < (a + 1) / (a + b + 2).
double beta_fraction(double x, double a, double b) {
    constexpr double tiny = 1e-300, precision = 1e-14;
    constexpr int most_terms = 10000;
    const auto away_from_zero = [](double v) { return std::abs(v) < tiny ? tiny : v; };
    double c = 1, d = 1 / away_from_zero(1 - (a + b) * x / (a + 1)), value = d;
    for (int m = 1; m < most_terms; ++m) {
        const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        double step = 1;
        for (const double term : {even, odd}) {
            d = 1 / away_from_zero(1 + term * d);
            c = away_from_zero(1 + term / c);
            step = c * d;
            value *= step;
        }
        if (std::abs(step - 1) < precision)
            break;
    }
    return value;
}

/// x^a (1 - x)^b / (a B(a, b)), the factor in front of the fraction.
double beta_factor(double x, double rest, double a, double b) {
    return std::exp(a * std::log(x) + b * std::log(rest) + std::lgamma(a + b) - std::lgamma(a) -
                    std::lgamma(b)) /
           a;
}

} // namespace

double t_tail(double t, int degrees) {
    if (t == 0)
        return 1;
    // The regularized incomplete beta function I_x(degrees / 2, 1 / 2) at x = degrees / (degrees +
    // t^2); `rest` is 1 - x, without cancellation.
    const double a = degrees / 2.0, b = 0.5;
    const double x = degrees / (degrees + t * t), rest = t * t / (degrees + t * t);
    if (x < (a + 1) / (a + b + 2))
        return beta_factor(x, rest, a, b) * beta_fraction(x, a, b);
    return 1 - beta_factor(rest, x, b, a) * beta_fraction(rest, b, a);
}

double t_critical(double probability, int degrees) {
    constexpr int halvings = 200;
    double low = 0, high = 1;
    while (t_tail(high, degrees) > probability)
        high *= 2;
    for (int i = 0; i < halvings; ++i) {
        const double middle = (low + high) / 2;
        (t_tail(middle, degrees) > probability ? low : high) = middle;
    }
    return high;
}

} // namespace clrender::verify
