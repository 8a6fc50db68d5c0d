#pragma once
/// The statistical comparison of two renderings of the same scene, each with its own noise.
///
/// Pixels: z = (a - b) / sqrt(var_a + var_b) for every pixel and channel, turned into a two-sided
/// p-value. A pixel passes if all its channels have p above alpha, where alpha is the Sidak
/// correction of .01 for the number of pixels: 1 - (1 - .01)^(1/n). At least 99.75% must pass.
///
/// Mean: each channel's mean over the picture within 4 standard errors. This is the sharp half of
/// the test: a picture that is 1% too dark fails here long before a single pixel does.
///
/// Where both variances are (almost) 0, rounding decides: a floor of 1e-5 of the value plus 1e-6 of
/// the picture's mean is added to every standard deviation.

#include "image/image.h"
#include "scene/scene.h"

#include <string>
#include <vector>

namespace clrender::test {

/// A picture with what is known of its noise.
struct MeasuredImage {
    Image mean;                  ///< f32
    Image variance;              ///< f32, same shape: the variance of each value of `mean`
    std::vector<double> mean_se; ///< one a channel: standard error of the mean of the picture
};

struct ZTestResult {
    std::size_t pixels = 0;
    std::size_t failed_pixels = 0;
    double alpha = 0;                   ///< the Sidak-corrected level of one pixel
    double mean_square_z = 0;           ///< about 1 when only noise differs
    double worst_z = 0;                 ///< the largest |z|
    int worst_x = 0, worst_y = 0;       ///< where it is, from the top left corner
    std::vector<double> mean_a, mean_b; ///< one a channel
    std::vector<double> mean_z;         ///< difference of the means in standard errors
    Image z;                            ///< z of every pixel and channel
    std::string problem;                ///< why the pictures cannot be compared, or empty

    [[nodiscard]] bool pixels_pass() const;
    [[nodiscard]] bool means_pass() const;
    [[nodiscard]] bool passes() const { return problem.empty() && pixels_pass() && means_pass(); }
    [[nodiscard]] std::string summary() const;
};

ZTestResult z_test(const MeasuredImage &a, const MeasuredImage &b);

/// z_test; if it fails, writes both pictures and the map of z (red: a is brighter) into the folder
/// z_test_failures/NAME of the current folder, whose path is then part of `summary`.
struct NamedVerdict {
    bool passes = false;
    std::string summary;
};
NamedVerdict compare_or_save(const std::string &name, const MeasuredImage &a,
                             const MeasuredImage &b);

/// Reads an EXR file of make_references.py. Throws std::runtime_error.
MeasuredImage read_reference(const std::string &path);

/// The standard error of each channel's mean over the picture, from the variances of its pixels.
///
/// A filter shares each sample among neighbouring pixels, whose noise then agrees: adding their
/// variances is too little. With weights w of one sample in the pixels around it, a pixel's
/// variance is proportional to sum(w^2) / sum(w)^2, while the mean of the picture counts each
/// sample once: the sum is too small by the factor sum(w)^2 / sum(w^2), here averaged over the
/// sample's place in its pixel. It is exact for noise that varies little within the filter.
std::vector<double> standard_error_of_mean(const Image &variance,
                                           const ReconstructionFilter &filter);

/// That factor: 1 for box, 2.25 for tent, 3.14 for the default gaussian.
double correlation_factor(const ReconstructionFilter &filter);

} // namespace clrender::test
