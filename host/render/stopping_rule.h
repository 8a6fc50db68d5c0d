#pragma once
/// When a render is done: after so many samples, at a time, or when it is as exact as wanted. The
/// rules decide from numbers alone, which the render hands in; they know no clock and no device.

#include <limits>
#include <optional>

namespace clrender {

/// What ends a render; the first that is reached does. Times are seconds on one clock, any.
struct StopLimits {
    int samples = 1; ///< a pixel
    /// When the picture has to be there, written.
    double deadline = std::numeric_limits<double>::infinity();
    double error = 0; ///< relative error of the picture (ErrorEstimate); 0: any
};

enum class StopReason {
    samples,
    time,
    error,
    unknown_error, ///< it cannot be measured, with however many samples
};

/// The law E^2 = c / N^p of a picture's relative error, from what was measured.
class ErrorLaw {
public:
    /// The picture of `samples` samples has the error `error`; later ones have more samples, or are
    /// the same again.
    void measured(int samples, double error);
    [[nodiscard]] bool is_known() const { return samples_ > 0; }
    /// The error with so many samples; not a number where nothing is known.
    [[nodiscard]] double error_at(double samples) const;
    /// Samples for this error; infinite where nothing is known.
    [[nodiscard]] double samples_for(double error) const;

private:
    int samples_ = 0;
    double error_ = 0;
    double exponent_; ///< p

public:
    ErrorLaw();
};

/// Cuts a render into steps such that it ends by its limits with the same number of samples in
/// every pixel. A step goes from the last whole block of samples (film_blocks.h) to the end of a
/// later one, or into a block: such a step is the last, or its samples are taken again.
class StoppingRule {
public:
    explicit StoppingRule(const StopLimits &limits) : limits_(limits) {}

    struct Step {
        int samples;  ///< that every pixel has behind it
        bool measure; ///< the error has to be measured behind it
        /// Where the first pass will take longer than so many seconds, too_slow() has to be told.
        double slow_seconds = std::numeric_limits<double>::infinity();
    };
    /// Every pixel has so many samples already, whole blocks.
    void go_on_from(int samples) { whole_ = shown_ = samples; }
    /// The next step, or nothing: the render is done.
    std::optional<Step> next(double now);

    /// Every pixel has the samples of the step, which took so many seconds.
    void rendered(const Step &step, double seconds);
    /// The step would take too long; none of its samples count.
    void too_slow() { is_slow_ = true; }
    void measured(double error);
    /// Reading and writing the picture takes so long.
    void set_finish_seconds(double seconds) { finish_seconds_ = seconds; }

    /// Whether the render has to be stopped at once, in the middle of a step: it would be late.
    [[nodiscard]] bool is_overdue(double now) const;
    /// Notes that it has been.
    void overdue() { reason_ = StopReason::time; }

    /// Samples of every pixel in whole blocks, and those of the last step, which may be more.
    [[nodiscard]] int whole() const { return whole_; }
    [[nodiscard]] int shown() const { return shown_; }
    [[nodiscard]] StopReason reason() const { return reason_; }
    [[nodiscard]] const ErrorLaw &law() const { return law_; }
    /// Seconds that are left, by the rule that will end the render, where every pixel has `samples`
    /// samples; not a number where nothing is known.
    [[nodiscard]] double seconds_left(double now, double samples) const;

private:
    [[nodiscard]] double seconds_a_sample() const;
    [[nodiscard]] double affordable(double now) const;
    [[nodiscard]] int end_of_step(double goal) const;
    std::optional<Step> stop(StopReason reason);

    StopLimits limits_;
    ErrorLaw law_;
    StopReason reason_ = StopReason::samples;
    int whole_ = 0, shown_ = 0;
    double step_seconds_ = 0, step_samples_ = 0; ///< of the latest steps, the last ones most
    double finish_seconds_ = 0;
    bool is_slow_ = false;
    bool is_measured_ = false; ///< the error of `shown_` samples
    int tries_ = 0;            ///< steps into the block that begins with `whole_`
};

} // namespace clrender
