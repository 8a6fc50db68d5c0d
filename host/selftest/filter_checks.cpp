#include "checks.h"

#include "flatten/film_filter.h"
#include "shared/film_filter.h"

#include <cmath>
#include <string>

namespace clrender::selftest {

namespace {

struct NamedFilter {
    std::string name;
    ReconstructionFilter filter;
};

std::vector<NamedFilter> filters() {
    std::vector<NamedFilter> all;
    const auto add = [&](const std::string &name, FilterKind kind) -> ReconstructionFilter & {
        all.push_back({name, {}});
        all.back().filter.kind = kind;
        return all.back().filter;
    };
    add("gaussian", FilterKind::gaussian);
    add("wide gaussian", FilterKind::gaussian).stddev = 1;
    add("tent", FilterKind::tent);
    add("wide tent", FilterKind::tent).radius = 3.5;
    add("mitchell", FilterKind::mitchell);
    add("catmullrom", FilterKind::catmullrom);
    add("lanczos", FilterKind::lanczos);
    return all;
}

FlatScene scene_with(const ReconstructionFilter &filter) {
    FlatScene flat;
    flat.filter = tabulate_filter(filter);
    flat.frame.filter_radius = static_cast<float>(filter_radius(filter));
    return flat;
}

/// The filter as Mitsuba steps it, in double: the value at the inner end of the step that `x` lies
/// in. Where `x` is so close to a step that rounding may take the other, both are given.
struct SteppedValue {
    double one, other;

    SteppedValue(const ReconstructionFilter &filter, double x) {
        const double step = filter_radius(filter) / CLR_FILTER_LEVELS;
        const auto value = [&](double level) {
            return level >= CLR_FILTER_LEVELS ? 0 : filter_value(filter, level * step);
        };
        const double at = std::abs(x) / step;
        constexpr double slack = 1e-4;
        one = value(std::floor(at + slack));
        other = value(std::max(std::floor(at - slack), 0.0));
    }

    [[nodiscard]] double error(double value) const {
        return std::min(std::abs(value - one), std::abs(value - other));
    }
};

/// The integral of the filter, by the steps.
double integral_of(const ReconstructionFilter &filter) {
    const double step = filter_radius(filter) / CLR_FILTER_LEVELS;
    double sum = 0;
    for (int k = 0; k < CLR_FILTER_LEVELS; ++k)
        sum += 2 * step * filter_value(filter, k * step);
    return sum;
}

void check_splatted(ProbeDevice &device, Checks &checks) {
    Worst error, sum_error;
    for (const NamedFilter &named : filters()) {
        constexpr int weights = 9, middle = 4;
        const FlatScene flat = scene_with(named.filter);
        const std::size_t count = device.count(20000);
        std::vector<float> in;
        for (std::size_t i = 0; i < count; ++i)
            in.push_back((static_cast<float>(i) + 0.5f) / static_cast<float>(count));
        const std::vector<float> out = device.run_scene("probe_filter", flat, in, 1, weights);
        const double integral = integral_of(named.filter);
        double sum = 0;
        for (std::size_t i = 0; i < count; ++i)
            for (int k = 0; k < weights; ++k) {
                const double weight = out[weights * i + static_cast<std::size_t>(k)];
                error.see(SteppedValue(named.filter, k - middle + 0.5 - double{in[i]})
                              .error(weight * integral));
                sum += weight;
            }
        sum_error.see(std::abs(sum / static_cast<double>(count) - 1));
    }
    checks.push_back(
        {"filter_weights", "largest error against the stepped filter", error.value(), 1e-6});
    checks.push_back({"filter_weights", "weights over all places in a pixel, off 1 by",
                      sum_error.value(), 1e-3});
}

/// Samples in proportion to |filter|: where they lie, and that weight times density is the filter.
void check_sampled(ProbeDevice &device, Checks &checks) {
    double deviation = 0;
    Worst mean_error;
    for (const NamedFilter &named : filters()) {
        const FlatScene flat = scene_with(named.filter);
        const std::size_t count = device.count(1e5);
        Random random(14);
        std::vector<float> in;
        for (std::size_t i = 0; i < count; ++i) {
            in.push_back((static_cast<float>(i) + random.unit()) / static_cast<float>(count));
            in.insert(in.end(), {100, 100});
        }
        const std::vector<float> out = device.run_scene("probe_filter_offset", flat, in, 3, 2);
        // Moments of the weighted samples against those of the filter.
        const double radius = filter_radius(named.filter), integral = integral_of(named.filter);
        constexpr int cells = 62;
        std::vector<double> sums(cells, 0.0);
        for (std::size_t i = 0; i < count; ++i) {
            const double at = (double{out[2 * i]} / radius + 1) / 2;
            const int cell = std::min(static_cast<int>(at * cells), cells - 1);
            if (!(at >= 0 && at <= 1)) {
                mean_error.see(at - at + std::abs(at));
                continue;
            }
            sums[static_cast<std::size_t>(cell)] += double{out[2 * i + 1]};
        }
        for (int k = 0; k < cells; ++k) {
            const double step = 2 * radius / cells;
            const int level = k < cells / 2 ? cells / 2 - 1 - k : k - cells / 2;
            const double expected =
                filter_value(named.filter, level * radius / CLR_FILTER_LEVELS) * step / integral;
            deviation = std::max(
                deviation, std::abs(sums[static_cast<std::size_t>(k)] / static_cast<double>(count) -
                                    expected));
        }
        double mean = 0;
        for (const double sum : sums)
            mean += sum / static_cast<double>(count);
        mean_error.see(std::abs(mean - 1));
    }
    checks.push_back(
        {"filter_offset", "weight of a step of the filter, largest error", deviation, 1e-3});
    checks.push_back({"filter_offset", "mean weight, off 1 by", mean_error.value(), 1e-3});
}

} // namespace

Checks check_filters(ProbeDevice &device) {
    Checks checks;
    check_splatted(device, checks);
    check_sampled(device, checks);
    return checks;
}

} // namespace clrender::selftest
