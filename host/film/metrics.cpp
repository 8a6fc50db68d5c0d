#include "metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace clrender {

namespace {

/// Keeps dark pixels from ruling the relative error.
constexpr double rel_mse_epsilon = 0.01;

int color_channels(const Image &image) {
    return image.channels <= 2 ? 1 : 3;
}

/// Linear values of the colour channels, by (pixel, channel).
class LinearView {
public:
    explicit LinearView(const Image &image) : image_(image) {
        for (std::size_t i = 0; i < decoded_.size(); ++i)
            decoded_[i] = srgb_decode(static_cast<double>(i) / 255);
    }
    double operator()(std::size_t pixel, std::size_t channel) const {
        const std::size_t i = pixel * static_cast<std::size_t>(image_.channels) + channel;
        return image_.type == PixelType::u8 ? decoded_[image_.u8[i]] : image_.f32[i];
    }

private:
    const Image &image_;
    std::array<double, 256> decoded_{};
};

void check_comparable(const Image &a, const Image &r, const std::string &a_name) {
    if (a.width != r.width || a.height != r.height)
        throw InputError({a_name, 0}, fmt::format("size {} x {}, expected the reference's {} x {}",
                                                  a.width, a.height, r.width, r.height));
    if (color_channels(a) != color_channels(r))
        throw InputError({a_name, 0}, fmt::format("{} colour channels, expected the reference's {}",
                                                  color_channels(a), color_channels(r)));
}

} // namespace

ImageDifference compare_images(const Image &a, const Image &reference, const std::string &a_name) {
    check_comparable(a, reference, a_name);
    const LinearView a_at(a);
    const LinearView r_at(reference);
    const auto width = static_cast<std::size_t>(a.width);
    const std::size_t pixels = width * static_cast<std::size_t>(a.height);
    const auto channels = static_cast<std::size_t>(color_channels(a));

    // One relative error per pixel, for the trimmed mean.
    ImageDifference result;
    std::vector<double> relative;
    relative.reserve(pixels);
    double squares = 0;
    double sum = 0;
    for (std::size_t p = 0; p < pixels; ++p) {
        double pixel_square = 0;
        double pixel_relative = 0;
        double pixel_sum = 0;
        double pixel_largest = 0;
        for (std::size_t c = 0; c < channels; ++c) {
            const double r = r_at(p, c);
            const double difference = a_at(p, c) - r;
            pixel_square += difference * difference;
            pixel_relative += difference * difference / (r * r + rel_mse_epsilon);
            pixel_sum += difference;
            pixel_largest = std::max(pixel_largest, std::abs(difference));
        }
        if (!std::isfinite(pixel_sum) || !std::isfinite(pixel_relative)) {
            ++result.nonfinite;
            continue;
        }
        squares += pixel_square;
        sum += pixel_sum;
        relative.push_back(pixel_relative);
        if (pixel_largest > result.largest) {
            result.largest = pixel_largest;
            result.where = {static_cast<int>(p % width), static_cast<int>(p / width)};
        }
    }
    if (relative.empty())
        return result;

    const auto count = static_cast<double>(relative.size() * channels);
    result.mse = squares / count;
    result.bias = sum / count;
    result.rel_mse = std::accumulate(relative.begin(), relative.end(), 0.0) / count;
    const auto kept = relative.size() - relative.size() / 1000;
    std::nth_element(relative.begin(), relative.begin() + static_cast<std::ptrdiff_t>(kept) - 1,
                     relative.end());
    relative.resize(kept);
    result.rel_mse_trimmed = std::accumulate(relative.begin(), relative.end(), 0.0) /
                             static_cast<double>(kept * channels);
    return result;
}

} // namespace clrender
