/// The statistics of `clrender test`, on made-up noise of known size.

#include "verify/picture_test.h"
#include "verify/regions.h"
#include "verify/student_t.h"
#include "verify/windows.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using namespace clrender;
using namespace clrender::verify;

namespace {

constexpr int width = 24, height = 16;
constexpr std::size_t pixels = std::size_t{width} * height;

Image image_of(int channels, float value) {
    Image image;
    image.width = width;
    image.height = height;
    image.channels = channels;
    image.f32.assign(pixels * static_cast<std::size_t>(channels), value);
    return image;
}

/// Pictures that become better: every pixel is the mean of independent numbers about `truth`.
class Noise {
public:
    Noise(const Image &truth, double deviation, unsigned seed)
        : truth_(truth), deviation_(deviation), random_(seed), sums_(truth.f32.size(), 0.0) {}

    /// The picture of `samples` samples in all.
    Image picture(int samples) {
        Image image = truth_;
        std::normal_distribution<double> normal(0, deviation_ * std::sqrt(samples - samples_));
        for (std::size_t i = 0; i < sums_.size(); ++i) {
            sums_[i] += double{truth_.f32[i]} * (samples - samples_) + normal(random_);
            image.f32[i] = static_cast<float>(sums_[i] / samples);
        }
        samples_ = samples;
        return image;
    }

private:
    Image truth_;
    double deviation_;
    std::mt19937 random_;
    std::vector<double> sums_;
    int samples_ = 0;
};

Reference noisy_reference(const Image &truth, double deviation, int samples, unsigned seed) {
    Reference reference;
    reference.image = Noise(truth, deviation, seed).picture(samples);
    reference.variance =
        image_of(truth.channels, static_cast<float>(deviation * deviation / samples));
    reference.samples = samples;
    return reference;
}

/// Adds pictures up to `samples` samples.
void add_up_to(PictureTest &test, Noise &noise, int samples) {
    while (test.next_samples() <= samples)
        test.add(noise.picture(test.next_samples()));
}

} // namespace

TEST_CASE("Student's t has the tails of the tables and of closed forms") {
    // One degree of freedom: 1 - 2 / pi atan(t).
    for (const double t : {0.1, 1.0, 7.0, 1e4})
        CHECK(t_tail(t, 1) == Approx(2 / M_PI * std::atan(1 / t)).epsilon(1e-9));
    // Two: 1 - t / sqrt(2 + t^2).
    CHECK(t_tail(3, 2) == Approx(1 - 3 / std::sqrt(11.0)).epsilon(1e-9));
    CHECK(t_critical(0.05, 10) == Approx(2.228139).epsilon(1e-6));
    CHECK(t_critical(0.001, 30) == Approx(3.645959).epsilon(1e-6));
    CHECK(t_tail(t_critical(1e-9, 31), 31) == Approx(1e-9).epsilon(1e-6));
}

TEST_CASE("Windows overlap by half and reach the edges of the picture") {
    const Windows windows(10, 7, 4);
    CHECK(windows.count() == 12);
    CHECK(windows.left(3) == 6);
    CHECK(windows.top(8) == 3);
    Image image;
    image.width = 10;
    image.height = 7;
    image.channels = 2;
    for (int y = 0; y < 7; ++y)
        for (int x = 0; x < 10; ++x)
            image.f32.insert(image.f32.end(), {static_cast<float>(x), static_cast<float>(y)});
    const auto means = windows.means(image, 2);
    CHECK(means[6] == Approx(7.5));
    CHECK(means[7] == Approx(1.5));
    CHECK(means[17] == Approx(4.5));
    CHECK(Windows(10, 7, 0).count() == 1);
}

TEST_CASE("The errors of windows are those of the noise") {
    const Image truth = image_of(3, 0.5F);
    constexpr int seeds = 40, samples = 2048;
    std::vector<double> squares(3, 0.0), counts(3, 0.0);
    for (unsigned seed = 0; seed < seeds; ++seed) {
        const Reference reference = noisy_reference(truth, 0.5, samples, 2 * seed + 1);
        PictureTest test(reference, 0.01);
        Noise noise(truth, 0.5, 2 * seed + 2);
        add_up_to(test, noise, samples);
        for (std::size_t f = 0; f < 3; ++f)
            // With a chance of 1 everything is a finding.
            for (const auto &finding : test.families()[f].look(1, samples, 1).findings) {
                squares[f] += finding.t * finding.t;
                ++counts[f];
            }
    }
    // Of 120 means the mean square has a deviation of 0.13; each picture's error is at least what
    // the other one tells, which makes t a little smaller.
    CHECK(squares[0] / counts[0] == Approx(0.9).margin(0.4));
    CHECK(squares[1] / counts[1] == Approx(0.9).margin(0.15));
    CHECK(squares[2] / counts[2] == Approx(0.9).margin(0.15));
}

TEST_CASE("Noise alone is the same, and a few pixels that differ are found where they are") {
    const Image truth = image_of(3, 0.5F);
    const Reference reference = noisy_reference(truth, 0.5, 32768, 1);
    Image changed = truth;
    const bool has_change = GENERATE(false, true);
    for (int y = 5; has_change && y < 9; ++y)
        for (int x = 13; x < 17; ++x)
            changed
                .f32[3 * (static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)) + 1] *=
                0.9F;
    PictureTest test(reference, 0.01);
    Noise noise(changed, 0.5, 2);
    add_up_to(test, noise, 16384);
    const auto look = test.look(image_of(3, 0.25F / 16384));
    CHECK(look.differs() == has_change);
    CHECK(look.same() == !has_change);
    const auto regions = find_regions(test, look, truth);
    CHECK(regions.size() == (has_change ? 1 : 0));
    for (const Region &region : regions) {
        CHECK(region.worst.channel == 1);
        CHECK(region.left <= 13);
        CHECK(region.right >= 16);
        CHECK(region.top <= 5);
        CHECK(region.bottom >= 8);
        CHECK(region.worst.value / region.worst.reference_value == Approx(0.95).margin(0.06));
    }
}

TEST_CASE("Light of rare samples that has not come yet is not missing") {
    // One sample of 4000 brings all of the light; the reference is exact.
    constexpr int samples = 2048, seeds = 20;
    constexpr double value = 0.5, chance = 1.0 / 4000;
    const Image truth = image_of(3, static_cast<float>(value));
    Reference reference;
    reference.image = truth;
    int alarms = 0;
    for (unsigned seed = 1; seed <= seeds; ++seed) {
        std::mt19937 random(seed);
        std::vector<double> sums(pixels, 0.0);
        PictureTest test(reference, 0.01);
        for (int before = 0; test.next_samples() <= samples;) {
            std::poisson_distribution<int> events(chance * (test.next_samples() - before));
            before = test.next_samples();
            Image image = truth;
            for (std::size_t pixel = 0; pixel < sums.size(); ++pixel) {
                sums[pixel] += events(random) * value / chance;
                for (std::size_t c = 0; c < 3; ++c)
                    image.f32[3 * pixel + c] = static_cast<float>(sums[pixel] / before);
            }
            test.add(image);
        }
        alarms += test.look(image_of(3, 1)).differs() ? 1 : 0;
    }
    CHECK(alarms == 0);
}
