/// The z-test itself: it accepts noise, and it finds what a reviewer would call wrong.

#include "z_test.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <filesystem>
#include <limits>
#include <random>

using namespace clrender;
using namespace clrender::test;

namespace {

constexpr int size = 64;
const ReconstructionFilter box{.kind = FilterKind::box};

/// A smooth picture with 3 channels, and the noise of `deviation` times its value.
MeasuredImage noisy_picture(unsigned seed, double deviation) {
    MeasuredImage picture;
    picture.mean.width = picture.mean.height = size;
    picture.mean.channels = 3;
    picture.variance = picture.mean;
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    for (int i = 0; i < size * size * 3; ++i) {
        const double truth = 0.5 + 0.4 * std::sin(i * 0.002);
        const double sigma = deviation * truth;
        picture.mean.f32.push_back(static_cast<float>(truth + sigma * normal(random)));
        picture.variance.f32.push_back(static_cast<float>(sigma * sigma));
    }
    picture.mean_se = standard_error_of_mean(picture.variance, box);
    return picture;
}

void multiply(MeasuredImage &picture, float factor) {
    for (float &value : picture.mean.f32)
        value *= factor;
}

/// A picture with the reference's own mean and `more` times its variance.
MeasuredImage resample(const MeasuredImage &reference, double more, unsigned seed) {
    MeasuredImage picture = reference;
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    for (std::size_t i = 0; i < picture.mean.f32.size(); ++i) {
        const double variance = more * double{reference.variance.f32[i]};
        picture.variance.f32[i] = static_cast<float>(variance);
        picture.mean.f32[i] += static_cast<float>(std::sqrt(variance) * normal(random));
    }
    for (double &error : picture.mean_se)
        error *= std::sqrt(more);
    return picture;
}

} // namespace

TEST_CASE("z-test accepts two noisy pictures of the same scene") {
    for (unsigned seed = 0; seed < 20; ++seed) {
        const auto result = z_test(noisy_picture(2 * seed, 0.05), noisy_picture(2 * seed + 1, 0.1));
        INFO(result.summary());
        CHECK(result.passes());
        CHECK(result.mean_square_z == Approx(1).margin(0.06));
    }
}

TEST_CASE("z-test rejects a picture that is 1% darker") {
    MeasuredImage dark = noisy_picture(1, 0.05);
    multiply(dark, 0.99f);
    const auto result = z_test(dark, noisy_picture(2, 0.05));
    CHECK_FALSE(result.passes());
    CHECK_FALSE(result.means_pass());
    CHECK(result.pixels_pass()); // no single pixel could tell
}

TEST_CASE("z-test rejects one wrong block whose mean is right") {
    MeasuredImage wrong = noisy_picture(1, 0.02);
    for (int y = 20; y < 28; ++y)
        for (int x = 30; x < 38; ++x)
            for (int c = 0; c < 3; ++c)
                wrong.mean.f32[static_cast<std::size_t>((y * size + x) * 3 + c)] *=
                    (x + y) % 2 == 0 ? 1.3f : 0.7f;
    const auto result = z_test(wrong, noisy_picture(2, 0.02));
    CHECK_FALSE(result.pixels_pass());
    CHECK(result.worst_x >= 30);
    CHECK(result.worst_y < 28);
}

TEST_CASE("z-test rejects a difference in one channel only") {
    MeasuredImage tinted = noisy_picture(1, 0.05);
    for (std::size_t i = 2; i < tinted.mean.f32.size(); i += 3)
        tinted.mean.f32[i] *= 1.02f;
    const auto result = z_test(tinted, noisy_picture(2, 0.05));
    CHECK_FALSE(result.means_pass());
    CHECK(std::abs(result.mean_z[0]) < 4);
    CHECK(std::abs(result.mean_z[2]) > 4);
}

TEST_CASE("z-test without noise allows rounding and no more") {
    const MeasuredImage exact = noisy_picture(1, 0);
    MeasuredImage rounded = exact;
    for (std::size_t i = 0; i < rounded.mean.f32.size(); i += 2)
        rounded.mean.f32[i] *= 1 + 1e-6f;
    CHECK(z_test(rounded, exact).passes());
    multiply(rounded, 1.0002f);
    CHECK_FALSE(z_test(rounded, exact).pixels_pass());
}

TEST_CASE("z-test rejects values that are not finite, and pictures of another shape") {
    const MeasuredImage good = noisy_picture(1, 0.05);
    MeasuredImage bad = good;
    bad.mean.f32[77] = std::numeric_limits<float>::quiet_NaN();
    CHECK_FALSE(z_test(bad, good).passes());
    bad = good;
    bad.variance.f32[77] = std::numeric_limits<float>::infinity();
    CHECK_FALSE(z_test(good, bad).passes());
    bad = good;
    bad.mean.width = 32;
    CHECK_FALSE(z_test(bad, good).passes());
    bad = good;
    bad.mean_se.clear();
    CHECK_FALSE(z_test(bad, good).passes());
}

TEST_CASE("z-test saves the evidence of a failure and names the folder") {
    MeasuredImage dark = noisy_picture(1, 0.05);
    multiply(dark, 0.5f);
    const auto verdict = compare_or_save("self_test", dark, noisy_picture(2, 0.05));
    CHECK_FALSE(verdict.passes);
    const auto folder = std::filesystem::current_path() / "z_test_failures" / "self_test";
    CHECK(verdict.summary.find(folder.string()) != std::string::npos);
    for (const char *file : {"a.exr", "b.exr", "z.exr", "z.png"})
        CHECK(std::filesystem::exists(folder / file));
    std::filesystem::remove_all(folder);
}

TEST_CASE("z-test knows how much a filter correlates its pixels") {
    CHECK(correlation_factor({.kind = FilterKind::box}) == Approx(1).epsilon(1e-3));
    CHECK(correlation_factor({.kind = FilterKind::tent}) == Approx(2.25).epsilon(1e-3));
    CHECK(correlation_factor({.kind = FilterKind::gaussian}) ==
          Approx(3.14159).epsilon(0.02)); // 4 pi stddev^2, but for the cut tails
    CHECK(correlation_factor({.kind = FilterKind::lanczos}) == Approx(1.25).epsilon(0.02));
}

TEST_CASE("z-test accepts every stored reference with more noise, and rejects it 3% darker") {
    const auto folder = std::filesystem::path(CLRENDER_TEST_DIR) / "references";
    int count = 0;
    for (const auto &entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().extension() != ".exr")
            continue;
        ++count;
        const MeasuredImage reference = read_reference(entry.path().string());
        MeasuredImage picture = resample(reference, 4, 7);
        const auto same = z_test(picture, reference);
        INFO(entry.path().stem().string() << ": " << same.summary());
        CHECK(same.passes());
        multiply(picture, 0.97f);
        CHECK_FALSE(z_test(picture, reference).passes());
    }
    CHECK(count >= 24);
}
