#include "windows.h"

#include <algorithm>

namespace clrender::verify {

namespace {

std::vector<int> places(int extent, int side) {
    std::vector<int> starts;
    const int step = std::max(side / 2, 1);
    for (int start = 0; start + side < extent; start += step)
        starts.push_back(start);
    starts.push_back(extent - side);
    return starts;
}

} // namespace

Windows::Windows(int width, int height, int side)
    : width_(side > 0 ? std::min(side, width) : width),
      height_(side > 0 ? std::min(side, height) : height), left_(places(width, width_)),
      top_(places(height, height_)) {}

std::vector<double> Windows::means(const Image &image, int channels) const {
    const auto image_width = static_cast<std::size_t>(image.width);
    const auto stride = static_cast<std::size_t>(image.channels);
    const auto colours = static_cast<std::size_t>(channels);
    std::vector<double> means;
    means.reserve(count() * colours);
    std::vector<double> columns(image_width * colours);
    for (const int top : top_) {
        // The sums of the columns of this row of windows, then of the columns of each window.
        std::fill(columns.begin(), columns.end(), 0.0);
        for (int y = top; y < top + height_; ++y) {
            const float *row = &image.f32[static_cast<std::size_t>(y) * image_width * stride];
            for (std::size_t x = 0; x < image_width; ++x)
                for (std::size_t c = 0; c < colours; ++c)
                    columns[x * colours + c] += double{row[x * stride + c]};
        }
        for (const int left : left_)
            for (std::size_t c = 0; c < colours; ++c) {
                double sum = 0;
                for (int x = left; x < left + width_; ++x)
                    sum += columns[static_cast<std::size_t>(x) * colours + c];
                means.push_back(sum / pixels());
            }
    }
    return means;
}

} // namespace clrender::verify
