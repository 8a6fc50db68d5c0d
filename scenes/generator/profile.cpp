#include "profile.h"
#include <algorithm>
#include <cmath>

namespace {
constexpr int samples = 8192;
}

Profile::Profile(std::vector<Point> controls) : controls_(std::move(controls)) {
    // Mirrored neighbours make both ends meet the axis at a right angle.
    const Point second = controls_[1], before_last = controls_[controls_.size() - 2];
    controls_.insert(controls_.begin(), {-second.r, second.y});
    controls_.push_back({-before_last.r, before_last.y});

    arc_.push_back(0);
    Point last = spline(0);
    for (int i = 1; i <= samples; ++i) {
        const Point next = spline(i / double(samples));
        arc_.push_back(arc_.back() + std::hypot(next.r - last.r, next.y - last.y));
        last = next;
    }
}

Profile::Point Profile::spline(double t) const {
    const double spans = static_cast<double>(controls_.size() - 3);
    const double x = t * spans;
    const double first = std::clamp(std::floor(x), 0.0, spans - 1);
    const double f = x - first, g = 1 - f;
    const double weights[] = {g * g * g / 6, (3 * f * f * f - 6 * f * f + 4) / 6,
                              (3 * g * g * g - 6 * g * g + 4) / 6, f * f * f / 6};
    Point p;
    for (size_t k = 0; k < 4; ++k) {
        const Point &c = controls_[static_cast<size_t>(first) + k];
        p.r += weights[k] * c.r;
        p.y += weights[k] * c.y;
    }
    return p;
}

Profile::Point Profile::at(double fraction) const {
    const double target = std::clamp(fraction, 0.0, 1.0) * arc_.back();
    const auto above = std::upper_bound(arc_.begin() + 1, arc_.end() - 1, target);
    const double low = *(above - 1), high = *above;
    const double index =
        static_cast<double>(above - 1 - arc_.begin()) + (target - low) / (high - low);
    return spline(index / samples);
}

Profile vase_profile() {
    return Profile({{0, 0},       {0.15, 0},     {0.3, 0},     {0.36, 0.03}, {0.42, 0.25},
                    {0.57, 0.6},  {0.65, 0.92},  {0.56, 1.22}, {0.33, 1.48}, {0.21, 1.68},
                    {0.22, 1.84}, {0.33, 1.97},  {0.41, 2.02}, {0.39, 2.05}, {0.3, 2},
                    {0.19, 1.86}, {0.165, 1.68}, {0.28, 1.46}, {0.51, 1.2},  {0.6, 0.92},
                    {0.52, 0.61}, {0.37, 0.29},  {0.26, 0.1},  {0.12, 0.07}, {0, 0.07}});
}
