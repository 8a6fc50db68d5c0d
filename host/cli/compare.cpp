#include "compare.h"

#include "film/flip.h"
#include "film/metrics.h"
#include "print.h"

#include <numeric>

namespace clrender {

namespace {

/// Prints the mean of the FLIP map and writes it.
void write_flip(const Image &a, const Image &b, const std::string &path) {
    Image map = flip_map(a, b);
    const double mean =
        std::accumulate(map.f32.begin(), map.f32.end(), 0.0) / static_cast<double>(map.f32.size());
    print("FLIP                {:.6g}   mean over the pixels, 0 to 1\n", mean);
    // The writer encodes in sRGB.
    for (float &value : map.f32)
        value = static_cast<float>(srgb_decode(double{value}));
    write_image(path, map);
}

} // namespace

int compare_command(const std::string &a, const std::string &b, double tolerance,
                    const std::string &flip) {
    if (!(tolerance >= 0))
        throw InputError({"--tolerance", 0}, "negative, expected a number of at least 0");
    const Image picture = read_image(a), reference = read_image(b);
    const ImageDifference d = compare_images(picture, reference, a);

    print("mean squared error  {:.6g}\n", d.mse);
    print("relMSE              {:.6g}   mean((a - r)^2 / (r^2 + 0.01)), r from {}\n", d.rel_mse, b);
    print("relMSE, trimmed     {:.6g}   without the worst 0.1% of the pixels\n", d.rel_mse_trimmed);
    print("bias                {:+.6g}   mean(a - r)\n", d.bias);
    print("largest difference  {:.6g}   at pixel ({}, {})\n", d.largest, d.where[0], d.where[1]);
    if (d.nonfinite > 0)
        print("not finite          {} pixels, left out above\n", d.nonfinite);
    if (!flip.empty())
        write_flip(picture, reference, flip);

    const bool differs = d.rel_mse > tolerance || d.nonfinite > 0;
    if (differs)
        print("differs: {}\n", d.nonfinite > 0 ? "pixels are NaN or infinite"
                                               : fmt::format("relMSE is above the tolerance "
                                                             "{:g}",
                                                             tolerance));
    return differs ? 1 : 0;
}

} // namespace clrender
