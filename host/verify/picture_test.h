#pragma once
/// Whether a render that goes on differs from a reference by more than the noise of both.

#include "reference.h"
#include "windows.h"

#include <cstddef>
#include <string>
#include <vector>

namespace clrender::verify {

/// The chance of a false "differs", over all looks and windows.
inline constexpr double significance = 1e-3;
/// Samples of the smallest batch: the length of the film's blocks.
inline constexpr int first_batch = 64;
/// Batches from which the errors are known well enough to decide, and up to which they are kept.
inline constexpr int least_batches = 8, most_batches = 64;

/// Windows of one size in all colour channels, and the batches of samples seen there. The error of
/// a window's mean comes from the scatter of its batches: no assumption is made of how pixels
/// correlate. Consecutive batches of Sobol' points repel each other, so that it is rather too
/// large. Where rare bright samples make the light of a window and none has come yet, its batches
/// scatter too little: a window that is darker than the reference has the variance of the windows
/// around it at least.
class Family {
public:
    /// `effect`: the relative difference to be excluded.
    Family(std::string name, const Windows &windows, double effect, const Reference &reference);

    /// Takes the picture of the first `samples` samples, a batch more than the last one.
    void add(const Image &image, int samples);
    /// Makes one batch of two.
    void merge();
    [[nodiscard]] int batches() const { return static_cast<int>(batches_.size()); }

    /// The mean over windows and channels of the squared error over that which `variance`, of the
    /// pixels, would make if pixels did not correlate.
    [[nodiscard]] double spread(const Image &variance) const;

    /// One window in one channel.
    struct Finding {
        std::size_t window = 0;
        int channel = 0;
        double value = 0, error = 0;                     ///< of the render, standard error
        double reference_value = 0, reference_error = 0; ///< of the reference
        double t = 0;                                    ///< the difference in standard errors
    };
    struct Look {
        double critical = 0;           ///< |t| of a difference beyond the noise
        std::vector<Finding> findings; ///< beyond `critical`
        Finding worst;                 ///< the one with the largest |t|
        bool excluded = false;         ///< every difference of `effect` is excluded
        bool hopeless = false;         ///< the reference's own error keeps it from being excluded
    };
    /// `alpha`: the chance of any finding where there is only noise. `spread`: of the reference's
    /// pixels.
    [[nodiscard]] Look look(double alpha, int samples, double spread) const;

    [[nodiscard]] const std::string &name() const { return name_; }
    [[nodiscard]] const Windows &windows() const { return windows_; }

private:
    /// The mean of the batches.
    [[nodiscard]] double difference(std::size_t i) const;
    /// The squared error of each window and channel, from the scatter of the batches.
    [[nodiscard]] std::vector<double> batch_variances() const;
    /// The mean of `variances` around a window and channel.
    [[nodiscard]] double variance_around(const std::vector<double> &variances, std::size_t i) const;
    /// `own`: the render's squared error from its batches.
    [[nodiscard]] Finding find(std::size_t i, double own, int samples, double spread) const;

    std::string name_;
    Windows windows_;
    double effect_;
    int channels_;
    double reference_samples_, rounding_;
    std::vector<double> reference_;          ///< of each window and channel
    std::vector<double> reference_variance_; ///< as if pixels did not correlate
    std::vector<double> picture_mean_;       ///< of the reference, each channel
    std::vector<double> last_;               ///< the means so far
    int last_samples_ = 0;
    std::vector<std::vector<float>> batches_; ///< minus `reference_`
};

/// The test as a whole.
class PictureTest {
public:
    /// `effect`: of the mean; of a window of 8x8 ten times, of 4x4 five times as much is looked
    /// for.
    PictureTest(const Reference &reference, double effect);

    /// Samples a pixel of the next picture that add() takes.
    [[nodiscard]] int next_samples() const;
    /// Takes the picture of the first next_samples() samples.
    void add(const Image &image);

    struct Look {
        std::vector<Family::Look> families; ///< as families()
        [[nodiscard]] bool differs() const;
        [[nodiscard]] bool same() const;
        [[nodiscard]] bool hopeless() const;
    };
    /// Spends a part of the significance. `variance` is that of the render's pixels.
    Look look(const Image &variance);

    [[nodiscard]] const std::vector<Family> &families() const { return families_; }

private:
    std::vector<Family> families_;
    int batch_ = first_batch; ///< samples
    int samples_ = 0;
    int looks_ = 0;
};

} // namespace clrender::verify
