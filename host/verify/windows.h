#pragma once
/// Means over square windows of a picture, which overlap by half.

#include "image/image.h"

#include <cstddef>
#include <vector>

namespace clrender::verify {

/// Windows of one size, `side` pixels or the whole picture where that is smaller, whose corners lie
/// side / 2 apart (the last ones end with the picture). Windows are numbered row by row.
class Windows {
public:
    /// side 0: one window, the picture.
    Windows(int width, int height, int side);

    [[nodiscard]] std::size_t count() const { return left_.size() * top_.size(); }
    [[nodiscard]] int left(std::size_t window) const { return left_[window % left_.size()]; }
    [[nodiscard]] int top(std::size_t window) const { return top_[window / left_.size()]; }
    /// Windows in a row.
    [[nodiscard]] std::size_t columns() const { return left_.size(); }
    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }
    [[nodiscard]] double pixels() const { return static_cast<double>(width_) * height_; }

    /// Mean of each window in each of the first `channels` channels, channels interleaved.
    [[nodiscard]] std::vector<double> means(const Image &image, int channels) const;

private:
    int width_, height_;
    std::vector<int> left_, top_;
};

} // namespace clrender::verify
