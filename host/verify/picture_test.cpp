#include "picture_test.h"

#include "student_t.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace clrender::verify {

namespace {

/// Rounding, where there is no noise: of a value, and of the picture's mean where it is dark.
constexpr double relative_floor = 1e-5, mean_floor = 1e-6;
/// The effect in a dark window is relative to this share of the picture's mean.
constexpr double dark = 0.25;

double square(double x) {
    return x * x;
}

} // namespace

Family::Family(std::string name, const Windows &windows, double effect, const Reference &reference)
    : name_(std::move(name)), windows_(windows), effect_(effect),
      channels_(colour_channels(reference.image)), reference_samples_(reference.samples),
      rounding_(reference.rounding), reference_(windows.means(reference.image, channels_)) {
    const Windows whole(reference.image.width, reference.image.height, 0);
    picture_mean_ = whole.means(reference.image, channels_);
    if (reference.variance)
        reference_variance_ = windows.means(*reference.variance, channels_);
    else
        reference_variance_.assign(reference_.size(), 0.0);
    for (double &value : reference_variance_)
        value /= windows.pixels();
    last_.assign(reference_.size(), 0.0);
}

void Family::add(const Image &image, int samples) {
    const std::vector<double> means = windows_.means(image, channels_);
    const double before = last_samples_, after = samples;
    std::vector<float> batch(means.size());
    for (std::size_t i = 0; i < means.size(); ++i)
        batch[i] = static_cast<float>((means[i] * after - last_[i] * before) / (after - before) -
                                      reference_[i]);
    batches_.push_back(std::move(batch));
    last_ = means;
    last_samples_ = samples;
}

void Family::merge() {
    for (std::size_t b = 0; b + 1 < batches_.size(); b += 2) {
        for (std::size_t i = 0; i < reference_.size(); ++i)
            batches_[b][i] = (batches_[b][i] + batches_[b + 1][i]) / 2;
        std::swap(batches_[b / 2], batches_[b]);
    }
    batches_.resize(batches_.size() / 2);
}

double Family::spread(const Image &variance) const {
    const std::vector<double> pixels = windows_.means(variance, channels_);
    double measured = 0, expected = 0;
    const std::vector<double> variances = batch_variances();
    for (std::size_t i = 0; i < reference_.size(); ++i) {
        measured += variances[i];
        expected += pixels[i] / windows_.pixels();
    }
    return expected > 0 ? std::max(measured / expected, 1.0) : 1;
}

double Family::difference(std::size_t i) const {
    double sum = 0;
    for (const auto &batch : batches_)
        sum += double{batch[i]};
    return sum / static_cast<double>(batches_.size());
}

std::vector<double> Family::batch_variances() const {
    const auto count = static_cast<double>(batches_.size());
    std::vector<double> variances(reference_.size());
    for (std::size_t i = 0; i < variances.size(); ++i) {
        const double mean = difference(i);
        for (const auto &batch : batches_)
            variances[i] += square(double{batch[i]} - mean);
        variances[i] /= count * (count - 1);
    }
    return variances;
}

double Family::variance_around(const std::vector<double> &variances, std::size_t i) const {
    // Windows overlap by half: every second one.
    constexpr std::size_t reach = 4, step = 2;
    const auto channels = static_cast<std::size_t>(channels_);
    const std::size_t columns = windows_.columns(), rows = windows_.count() / columns;
    const std::size_t column = i / channels % columns, row = i / channels / columns;
    double sum = 0, count = 0;
    for (std::size_t y = row + reach + 1; y-- > row - std::min(row, reach);)
        for (std::size_t x = column + reach + 1; x-- > column - std::min(column, reach);) {
            const bool is_taken =
                y < rows && x < columns && (y + row) % step == 0 && (x + column) % step == 0;
            if (is_taken) {
                sum += variances[(y * columns + x) * channels + i % channels];
                ++count;
            }
        }
    return sum / count;
}

Family::Finding Family::find(std::size_t i, double own, int samples, double spread) const {
    const double difference = this->difference(i);
    // Each picture's error is at least what the other one's samples tell: rare bright samples may
    // have come to only one of them.
    const double layer = reference_variance_[i] * spread;
    const double ratio = reference_samples_ > 0 ? samples / reference_samples_ : 0;
    const double own_variance = ratio > 0 ? std::max(own, layer / ratio) : own;
    const auto channel = i % static_cast<std::size_t>(channels_);
    const double rounding =
        square(relative_floor * reference_[i] + mean_floor * picture_mean_[channel]) +
        square(rounding_ * reference_[i]) / windows_.pixels();
    const double reference_variance = std::max(layer, own * ratio) + rounding;

    Finding finding;
    finding.window = i / static_cast<std::size_t>(channels_);
    finding.channel = static_cast<int>(channel);
    finding.value = reference_[i] + difference;
    finding.error = std::sqrt(own_variance);
    finding.reference_value = reference_[i];
    finding.reference_error = std::sqrt(reference_variance);
    const double error = std::sqrt(own_variance + reference_variance);
    finding.t = difference == 0 ? 0 : difference / error;
    return finding;
}

Family::Look Family::look(double alpha, int samples, double spread) const {
    Look look;
    // Šidák: one of so many windows.
    const double one = -std::expm1(std::log1p(-alpha) / static_cast<double>(reference_.size()));
    look.critical = t_critical(one, batches() - 1);
    look.excluded = true;
    const std::vector<double> variances = batch_variances();
    for (std::size_t i = 0; i < reference_.size(); ++i) {
        Finding finding = find(i, variances[i], samples, spread);
        const double error = std::hypot(finding.error, finding.reference_error);
        const double mean = picture_mean_[i % static_cast<std::size_t>(channels_)];
        const double limit = effect_ * std::max(std::abs(reference_[i]), dark * std::abs(mean));
        look.excluded =
            look.excluded &&
            std::abs(finding.value - finding.reference_value) + look.critical * error <= limit;
        look.hopeless = look.hopeless || (look.critical * finding.reference_error > limit &&
                                          finding.reference_error > 2 * finding.error);

        if (finding.t < 0)
            finding =
                find(i, std::max(variances[i], variance_around(variances, i)), samples, spread);
        if (std::abs(finding.t) > std::abs(look.worst.t))
            look.worst = finding;
        if (!(std::abs(finding.t) <= look.critical))
            look.findings.push_back(finding);
    }
    return look;
}

PictureTest::PictureTest(const Reference &reference, double effect) {
    const int width = reference.image.width, height = reference.image.height;
    families_.emplace_back("mean of the picture", Windows(width, height, 0), effect, reference);
    families_.emplace_back("8x8 pixels", Windows(width, height, 8), 10 * effect, reference);
    families_.emplace_back("4x4 pixels", Windows(width, height, 4), 5 * effect, reference);
}

int PictureTest::next_samples() const {
    return samples_ + (families_.front().batches() == most_batches ? 2 * batch_ : batch_);
}

void PictureTest::add(const Image &image) {
    const int samples = next_samples();
    batch_ = samples - samples_;
    for (Family &family : families_) {
        if (family.batches() == most_batches)
            family.merge();
        family.add(image, samples);
    }
    samples_ = samples;
}

PictureTest::Look PictureTest::look(const Image &variance) {
    // The sum of 1 / k^2 over all looks is pi^2 / 6.
    ++looks_;
    const double alpha = significance * 6 / square(std::numbers::pi * looks_) /
                         static_cast<double>(families_.size());
    const double spread = families_[1].spread(variance);
    Look look;
    for (const Family &family : families_)
        look.families.push_back(family.look(alpha, samples_, spread));
    return look;
}

bool PictureTest::Look::differs() const {
    return std::any_of(families.begin(), families.end(),
                       [](const Family::Look &look) { return !look.findings.empty(); });
}

bool PictureTest::Look::same() const {
    return std::all_of(families.begin(), families.end(),
                       [](const Family::Look &look) { return look.excluded; });
}

bool PictureTest::Look::hopeless() const {
    return std::any_of(families.begin(), families.end(),
                       [](const Family::Look &look) { return look.hopeless; });
}

} // namespace clrender::verify
