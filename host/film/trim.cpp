#include "trim.h"

#include <algorithm>

namespace clrender {

void trim(Image &image, int border) {
    if (border == 0 || image.f32.empty())
        return;
    const auto channels = static_cast<std::ptrdiff_t>(image.channels);
    const std::ptrdiff_t row = image.width * channels;
    image.width -= 2 * border;
    image.height -= 2 * border;

    // Rows move towards the beginning only, so none overwrites one that is still to move.
    const std::ptrdiff_t kept = image.width * channels;
    auto from = image.f32.begin() + border * row + border * channels;
    auto to = image.f32.begin();
    for (int y = 0; y < image.height; ++y, from += row)
        to = std::copy(from, from + kept, to);
    image.f32.resize(static_cast<std::size_t>(kept * image.height));
    image.f32.shrink_to_fit();
}

} // namespace clrender
