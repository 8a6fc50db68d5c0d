#pragma once
/// Where two pictures differ: windows that touch or overlap are one region.

#include "picture_test.h"

#include <cstddef>
#include <vector>

namespace clrender::verify {

/// A connected set of pixels, in all of which some window differs.
struct Region {
    int left = 0, top = 0, right = 0, bottom = 0; ///< of its pixels, both ends included
    std::size_t pixels = 0;
    const Family *family = nullptr; ///< of `worst`
    Family::Finding worst;          ///< the window with the largest |t|
};

/// The largest first. Windows that are the whole picture are left out.
std::vector<Region> find_regions(const PictureTest &test, const PictureTest::Look &look,
                                 const Image &image);

/// The picture, dimmed and grey, its regions in red with a frame around each, for a PNG.
Image mark_regions(const Image &image, const PictureTest &test, const PictureTest::Look &look);

} // namespace clrender::verify
