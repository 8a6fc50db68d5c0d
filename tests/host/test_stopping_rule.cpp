/// When renders end, on a clock and with errors that are made up.

#include "film/film_blocks.h"
#include "render/stopping_rule.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <limits>

using namespace clrender;

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

struct Outcome {
    int samples = 0, steps = 0, taken = 0; ///< `taken`: with those that were taken again
    double now = 0;
    StopReason reason = StopReason::samples;
};

/// Renders with `cost` seconds a sample, `finish` for the picture, and this error.
Outcome render(const StopLimits &limits, double cost, double finish = 0,
               const std::function<double(int)> &error = {}) {
    StoppingRule rule(limits);
    Outcome out;
    while (const auto step = rule.next(out.now)) {
        REQUIRE(++out.steps < 1000);
        REQUIRE(step->samples > rule.whole());
        REQUIRE(step->samples <= limits.samples);
        const int first = std::min(16, limits.samples);
        if (rule.shown() == 0 && step->samples > 1 && first * cost > step->slow_seconds) {
            rule.too_slow();
            continue;
        }
        const double seconds = (step->samples - rule.whole()) * cost;
        out.taken += step->samples - rule.whole();
        out.now += seconds;
        rule.rendered(*step, seconds);
        if (step->measure)
            rule.measured(error(step->samples));
        rule.set_finish_seconds(finish);
    }
    out.samples = rule.shown();
    out.now += finish;
    out.reason = rule.reason();
    return out;
}

} // namespace

TEST_CASE("A render by time ends in time, with as many samples as fit") {
    for (const double cost : {1e-5, 1e-3, 0.02, 0.11, 0.4})
        for (const double deadline : {2.0, 7.0, 60.0})
            for (const double finish : {0.0, 0.5}) {
                INFO(cost << " s a sample, " << deadline << " s, " << finish << " s to write");
                const Outcome out =
                    render({.samples = 1 << 30, .deadline = deadline}, cost, finish);
                CHECK(out.reason == StopReason::time);
                CHECK(out.now <= deadline + 1e-6);
                // What is left would not do for one more, or for one that was taken twice.
                CHECK(out.now > deadline - 2.01 * cost - 1e-3 * deadline);
                CHECK(out.taken <= out.samples + 1);
                CHECK(out.steps < 40);
            }
}

TEST_CASE("A render whose time is up before it begins has one sample of each pixel") {
    const Outcome out = render({.samples = 1 << 30, .deadline = -1}, 3);
    CHECK(out.samples == 1);
    CHECK(out.reason == StopReason::time);
}

TEST_CASE("The number of samples ends a render that is in time, and one that is not exact enough") {
    for (const int samples : {1, 7, 16, 100, 1000}) {
        const Outcome timed = render({.samples = samples, .deadline = 1e6}, 1e-3);
        CHECK(timed.samples == samples);
        CHECK(timed.reason == StopReason::samples);
        const Outcome noisy =
            render({.samples = samples, .error = 1e-6}, 1e-3, 0, [](int) { return 1.0; });
        CHECK(noisy.samples == samples);
        CHECK(noisy.reason == StopReason::samples);
    }
}

TEST_CASE("A render by error ends where the error is reached, and little beyond") {
    for (const double exponent : {1.0, 1.3, 1.6})
        for (const double first : {0.2, 1.0, 5.0})
            for (const double target : {0.1, 0.03, 0.01}) {
                INFO("error " << first << " / N^" << exponent / 2 << ", target " << target);
                const auto error = [&](int n) { return first * std::pow(n, -exponent / 2); };
                const Outcome out = render({.samples = 1 << 30, .error = target}, 1e-3, 0, error);
                CHECK(out.reason == StopReason::error);
                CHECK(error(out.samples) <= target);
                // Nothing is known before four samples, and after them not how fast the error
                // falls.
                if (out.samples > 4)
                    CHECK(error(out.samples) >= (exponent < 1.5 ? 0.85 : 0.7) * target);
                CHECK(out.taken <= 1.5 * out.samples + 130);
            }
}

TEST_CASE("A render whose error cannot be measured ends") {
    for (const double unknown :
         {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
        const Outcome out =
            render({.samples = 1 << 30, .error = 0.01}, 1e-3, 0, [&](int) { return unknown; });
        CHECK(out.reason == StopReason::unknown_error);
        CHECK(out.samples <= 1024);
    }
    // With few samples it may be unknown for a while.
    const Outcome later = render({.samples = 1 << 30, .error = 0.1}, 1e-3, 0, [](int n) {
        return n < 32 ? std::numeric_limits<double>::infinity() : 1 / std::sqrt(n);
    });
    CHECK(later.reason == StopReason::error);
}

TEST_CASE("The first rule that is reached ends the render") {
    const auto error = [](int n) { return 1 / std::sqrt(n); };
    CHECK(render({.samples = 1 << 30, .deadline = 1, .error = 0.01}, 1e-3, 0, error).reason ==
          StopReason::time);
    CHECK(render({.samples = 1 << 30, .deadline = 100, .error = 0.01}, 1e-3, 0, error).reason ==
          StopReason::error);
    CHECK(render({.samples = 500, .deadline = 100, .error = 0.01}, 1e-3, 0, error).reason ==
          StopReason::samples);
}

TEST_CASE("What is left is told by the rule that will end the render") {
    const auto left = [](const StopLimits &limits) {
        StoppingRule rule(limits);
        rule.rendered({64, true}, 0.64);
        rule.measured(0.1);
        return rule.seconds_left(0.64, 64);
    };
    CHECK(left({.samples = 164}) == Approx(1));
    CHECK(left({.samples = 1 << 30, .deadline = 3.64}) == Approx(3));
    // E^2 falls as N^-1.1 as long as it has been measured once.
    CHECK(left({.samples = 1 << 30, .deadline = 1e9, .error = 0.05}) ==
          Approx(0.64 * (std::pow(4, 1 / 1.1) - 1)));
    CHECK(left({.samples = 1 << 30, .error = 0.1}) == Approx(0).margin(1e-9));
    CHECK(std::isnan(StoppingRule({.samples = 9, .deadline = never}).seconds_left(0, 0)));
}

TEST_CASE("A render is overdue only when it has a picture") {
    StoppingRule rule({.samples = 1 << 30, .deadline = 1});
    CHECK_FALSE(rule.is_overdue(9));
    rule.rendered({1, false}, 2);
    CHECK(rule.is_overdue(9));
    CHECK_FALSE(rule.is_overdue(0.5));
}
