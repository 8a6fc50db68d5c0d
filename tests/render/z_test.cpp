#include "z_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

namespace clrender::test {

namespace {

constexpr double significance = 0.01;
constexpr double required_fraction = 0.9975;
constexpr double mean_limit = 4;
constexpr double relative_floor = 1e-5;
constexpr double absolute_floor = 1e-6; ///< of the picture's mean magnitude

double two_sided_p(double z) {
    return std::erfc(std::abs(z) / std::numbers::sqrt2);
}

double square(double x) {
    return x * x;
}

bool same_shape(const Image &a, const Image &b) {
    return a.width == b.width && a.height == b.height && a.channels == b.channels &&
           a.f32.size() == b.f32.size();
}

std::string why_incomparable(const MeasuredImage &a, const MeasuredImage &b) {
    if (!same_shape(a.mean, b.mean))
        return fmt::format("{}x{}x{} against {}x{}x{}", a.mean.width, a.mean.height,
                           a.mean.channels, b.mean.width, b.mean.height, b.mean.channels);
    const auto channels = static_cast<std::size_t>(a.mean.channels);
    for (const MeasuredImage *image : {&a, &b}) {
        if (!same_shape(image->mean, image->variance))
            return "the variance has another shape than the picture";
        if (image->mean_se.size() != channels)
            return "the standard errors of the mean are missing";
        const auto finite = [](float x) { return std::isfinite(x); };
        if (!std::ranges::all_of(image->mean.f32, finite) ||
            !std::ranges::all_of(image->variance.f32, finite))
            return "a value is not finite";
        if (std::ranges::any_of(image->variance.f32, [](float v) { return v < 0; }))
            return "a variance is negative";
    }
    return "";
}

double mean_magnitude(const Image &image) {
    double sum = 0;
    for (const float value : image.f32)
        sum += std::abs(double{value});
    return sum / static_cast<double>(image.f32.size());
}

std::vector<double> channel_means(const Image &image) {
    const auto channels = static_cast<std::size_t>(image.channels);
    std::vector<double> mean(channels, 0);
    for (std::size_t i = 0; i < image.f32.size(); ++i)
        mean[i % channels] += double{image.f32[i]};
    for (double &value : mean)
        value /= static_cast<double>(image.f32.size() / channels);
    return mean;
}

void test_pixels(const MeasuredImage &a, const MeasuredImage &b, ZTestResult &result) {
    const auto channels = static_cast<std::size_t>(a.mean.channels);
    const double floor = absolute_floor * mean_magnitude(b.mean);
    result.pixels = a.mean.f32.size() / channels;
    result.alpha = 1 - std::pow(1 - significance, 1 / static_cast<double>(result.pixels));
    result.z = a.mean;
    for (std::size_t pixel = 0; pixel < result.pixels; ++pixel) {
        bool passes = true;
        for (std::size_t i = pixel * channels; i < (pixel + 1) * channels; ++i) {
            const double va = double{a.mean.f32[i]}, vb = double{b.mean.f32[i]};
            const double rounding = relative_floor * std::max(std::abs(va), std::abs(vb)) + floor;
            const double noise = std::sqrt(double{a.variance.f32[i]} + double{b.variance.f32[i]} +
                                           square(rounding) + 1e-60);
            const double z = (va - vb) / noise;
            result.z.f32[i] = static_cast<float>(z);
            result.mean_square_z += square(z) / static_cast<double>(a.mean.f32.size());
            passes = passes && two_sided_p(z) > result.alpha;
            if (std::abs(z) > result.worst_z) {
                result.worst_z = std::abs(z);
                result.worst_x = static_cast<int>(pixel) % a.mean.width;
                result.worst_y = static_cast<int>(pixel) / a.mean.width;
            }
        }
        result.failed_pixels += passes ? 0 : 1;
    }
}

void test_means(const MeasuredImage &a, const MeasuredImage &b, ZTestResult &result) {
    result.mean_a = channel_means(a.mean);
    result.mean_b = channel_means(b.mean);
    const double floor = absolute_floor * mean_magnitude(b.mean);
    for (std::size_t c = 0; c < result.mean_a.size(); ++c) {
        const double rounding = relative_floor * std::abs(result.mean_b[c]) + floor;
        const double error =
            std::sqrt(square(a.mean_se[c]) + square(b.mean_se[c]) + square(rounding) + 1e-60);
        result.mean_z.push_back((result.mean_a[c] - result.mean_b[c]) / error);
    }
}

/// The first three channels as they are, one channel as grey; alpha is left out.
Image colour_of(const Image &image) {
    Image colour = image;
    colour.channels = 3;
    colour.f32.clear();
    const auto channels = static_cast<std::size_t>(image.channels);
    for (std::size_t i = 0; i < image.f32.size(); i += channels)
        for (std::size_t c = 0; c < 3; ++c)
            colour.f32.push_back(image.f32[i + (channels < 3 ? 0 : c)]);
    return colour;
}

/// Red where the largest z of the pixel is positive, blue where it is negative; full at |z| = 6.
Image picture_of_z(const Image &z) {
    Image picture = colour_of(z);
    const auto channels = static_cast<std::size_t>(z.channels);
    for (std::size_t i = 0; i < z.f32.size(); i += channels) {
        float worst = 0;
        for (std::size_t c = 0; c < channels; ++c)
            if (std::abs(z.f32[i + c]) > std::abs(worst))
                worst = z.f32[i + c];
        const std::size_t pixel = i / channels * 3;
        picture.f32[pixel] = std::max(worst, 0.f) / 6;
        picture.f32[pixel + 1] = 0;
        picture.f32[pixel + 2] = std::max(-worst, 0.f) / 6;
    }
    return picture;
}

/// Whatever can be shown of pictures that may not even have the same size.
std::string save_evidence(const std::string &name, const MeasuredImage &a, const MeasuredImage &b,
                          const ZTestResult &result) {
    const auto folder = std::filesystem::current_path() / "z_test_failures" / name;
    std::filesystem::create_directories(folder);
    for (const auto &[file, image] : {std::pair{"a", &a.mean}, std::pair{"b", &b.mean}}) {
        if (image->f32.empty())
            continue;
        const Image colour = colour_of(*image);
        write_image((folder / file).string() + ".exr", colour);
        write_image((folder / file).string() + ".png", colour);
    }
    if (!result.z.f32.empty()) {
        write_image((folder / "z.exr").string(), colour_of(result.z));
        write_image((folder / "z.png").string(), picture_of_z(result.z));
    }
    return folder.string();
}

} // namespace

bool ZTestResult::pixels_pass() const {
    return static_cast<double>(pixels - failed_pixels) >=
           required_fraction * static_cast<double>(pixels);
}

bool ZTestResult::means_pass() const {
    return std::ranges::all_of(mean_z, [](double z) { return std::abs(z) <= mean_limit; });
}

std::string ZTestResult::summary() const {
    if (!problem.empty())
        return problem;
    std::string text = fmt::format(
        "{} of {} pixels fail (allowed {:.0f}), mean z^2 {:.3f}, worst |z| {:.1f} at ({}, {})",
        failed_pixels, pixels, (1 - required_fraction) * static_cast<double>(pixels), mean_square_z,
        worst_z, worst_x, worst_y);
    for (std::size_t c = 0; c < mean_z.size(); ++c)
        text += fmt::format("; channel {}: mean {:.6g} against {:.6g}, {:+.1f} standard errors", c,
                            mean_a[c], mean_b[c], mean_z[c]);
    return text;
}

ZTestResult z_test(const MeasuredImage &a, const MeasuredImage &b) {
    ZTestResult result;
    result.problem = why_incomparable(a, b);
    if (!result.problem.empty())
        return result;
    test_pixels(a, b, result);
    test_means(a, b, result);
    return result;
}

NamedVerdict compare_or_save(const std::string &name, const MeasuredImage &a,
                             const MeasuredImage &b) {
    const ZTestResult result = z_test(a, b);
    NamedVerdict verdict{result.passes(), name + ": " + result.summary()};
    if (!verdict.passes)
        verdict.summary += "; see " + save_evidence(name, a, b, result);
    return verdict;
}

std::vector<double> standard_error_of_mean(const Image &variance,
                                           const ReconstructionFilter &filter) {
    const auto pixels = static_cast<double>(variance.width) * variance.height;
    std::vector<double> error = channel_means(variance);
    for (double &value : error)
        value = std::sqrt(value / pixels * correlation_factor(filter));
    return error;
}

} // namespace clrender::test
