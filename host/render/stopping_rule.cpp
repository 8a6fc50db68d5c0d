#include "stopping_rule.h"

#include "film/film_blocks.h"

#include <algorithm>
#include <cmath>

namespace clrender {

namespace {

/// Errors of Sobol' points fall with 1 / N to 1 / N^2, those of independent samples as 1 / N.
constexpr double usual_exponent = 1.1;
constexpr double least_exponent = 0.8;
constexpr double largest_exponent = 2;

/// The first measurement of the error: the least number of samples whose scatter says something.
constexpr int first_measured = 4;
/// Of a picture that has no finite error with so many samples it stays unknown.
constexpr int most_unknown = 256;
/// Samples beyond those that the law asks for, so that most renders need not be gone on with.
constexpr double caution = 1.03;
/// The law is trusted up to so many times the samples that it is known for.
constexpr double longest_reach = 4;
/// A step into a block is worth it if it saves this share of the block's end.
constexpr double least_saving = 0.05;
constexpr int most_tries = 3;

/// A first pass that would take more than this share of the time gives way to one of a sample.
constexpr double largest_first_share = 0.25;
/// A render is stopped within a step where it would be so late: seconds, and as a share of them.
constexpr double latest_seconds = 0.1;

int next_boundary(int whole) {
    return whole_blocks(whole + 1);
}

/// The last end of a block up to `samples`.
int boundary_before(double samples) {
    constexpr double most = 1 << 30;
    const int least = static_cast<int>(std::clamp(samples, 0.0, most));
    const int end = whole_blocks(least);
    return end > least ? CLR_BLOCK_START(blocks_of(least) - 1) : end;
}

} // namespace

ErrorLaw::ErrorLaw() : exponent_(usual_exponent) {}

void ErrorLaw::measured(int samples, double error) {
    constexpr double least_ratio = 1.9;
    if (samples_ > 0 && samples >= least_ratio * samples_ && error > 0 && error_ > 0)
        exponent_ = std::clamp(2 * std::log(error_ / error) /
                                   std::log(static_cast<double>(samples) / samples_),
                               least_exponent, largest_exponent);
    samples_ = samples;
    error_ = error;
}

double ErrorLaw::error_at(double samples) const {
    if (!is_known())
        return std::numeric_limits<double>::quiet_NaN();
    return error_ * std::pow(samples / samples_, -exponent_ / 2);
}

double ErrorLaw::samples_for(double error) const {
    if (!is_known() || !std::isfinite(error_))
        return std::numeric_limits<double>::infinity();
    return samples_ * std::pow(error_ / error, 2 / exponent_);
}

double StoppingRule::seconds_a_sample() const {
    return step_samples_ > 0 ? step_seconds_ / step_samples_ : 0;
}

/// Samples that can be taken in time.
double StoppingRule::affordable(double now) const {
    const double left = limits_.deadline - finish_seconds_ - now;
    const double cost = seconds_a_sample();
    return cost > 0 ? std::max(left / cost, 0.0) : std::numeric_limits<double>::infinity();
}

/// Where the next step ends, of those that lead to `goal` samples.
int StoppingRule::end_of_step(double goal) const {
    const int next = next_boundary(whole_);
    if (goal < next)
        return static_cast<int>(goal);
    // The law is checked before it reaches far, and so is the speed.
    double reach = std::isfinite(limits_.deadline) ? whole_ + (goal - whole_) / 2 : goal;
    if (limits_.error > 0)
        reach = std::min(reach, longest_reach * std::max(whole_, first_measured));
    return std::max(boundary_before(std::min(reach, goal)), next);
}

std::optional<StoppingRule::Step> StoppingRule::stop(StopReason reason) {
    reason_ = reason;
    return std::nullopt;
}

std::optional<StoppingRule::Step> StoppingRule::next(double now) {
    const bool by_error = limits_.error > 0;
    const bool by_time = std::isfinite(limits_.deadline);
    if (by_error && is_measured_ && law_.error_at(shown_) <= limits_.error)
        return stop(StopReason::error);
    if (by_error && is_measured_ && shown_ >= most_unknown && !std::isfinite(law_.error_at(shown_)))
        return stop(StopReason::unknown_error);
    if (shown_ >= limits_.samples)
        return stop(StopReason::samples);
    if (shown_ == 0) {
        if (is_slow_ || (by_time && now >= limits_.deadline))
            return Step{1, false};
        const int first = std::min(by_error ? first_measured : next_boundary(0), limits_.samples);
        const double slow = by_time ? largest_first_share * (limits_.deadline - now)
                                    : std::numeric_limits<double>::infinity();
        return Step{first, by_error, slow};
    }

    // A render that goes on from a checkpoint does not know its speed.
    if (by_time && !(seconds_a_sample() > 0))
        return now < limits_.deadline
                   ? std::optional(Step{std::min(next_boundary(whole_), limits_.samples), false})
                   : stop(StopReason::time);
    const double in_time = whole_ + std::floor(affordable(now));
    if (in_time <= shown_)
        return stop(StopReason::time);
    double wanted = std::numeric_limits<double>::infinity();
    if (by_error) {
        // Each try into the block leaves less to chance.
        wanted = std::ceil(law_.samples_for(limits_.error) * std::pow(caution, 1 + tries_));
        wanted = std::max(wanted, shown_ + 1.0);
        const int block_end = next_boundary(whole_);
        if (wanted < block_end && (wanted > (1 - least_saving) * block_end || tries_ >= most_tries))
            wanted = block_end;
    }
    const double goal = std::min({double(limits_.samples), in_time, wanted});
    const int end = end_of_step(goal);
    const bool is_last = end >= in_time && end < wanted;
    return Step{end, by_error && !is_last};
}

void StoppingRule::rendered(const Step &step, double seconds) {
    // Later steps are longer, or closer to those that come.
    constexpr double fading = 0.5;
    step_seconds_ = fading * step_seconds_ + seconds;
    step_samples_ = fading * step_samples_ + (step.samples - whole_);
    shown_ = step.samples;
    is_measured_ = false;
    if (boundary_before(shown_) == shown_) {
        whole_ = shown_;
        tries_ = 0;
    } else {
        ++tries_;
    }
}

void StoppingRule::measured(double error) {
    law_.measured(shown_, error);
    is_measured_ = true;
}

bool StoppingRule::is_overdue(double now) const {
    return shown_ > 0 && now > limits_.deadline - finish_seconds_ + latest_seconds;
}

double StoppingRule::seconds_left(double now, double samples) const {
    const double cost = seconds_a_sample();
    if (!(cost > 0))
        return std::numeric_limits<double>::quiet_NaN();
    double end = limits_.samples;
    if (limits_.error > 0)
        end = std::min(end, std::max(law_.samples_for(limits_.error), samples));
    return std::max(std::min((end - samples) * cost + finish_seconds_, limits_.deadline - now),
                    0.0);
}

} // namespace clrender
