#include "compare.h"

#include "film/metrics.h"

#include <fmt/format.h>

#include <cstdio>

namespace clrender {

namespace {

/// To stdout. A failed write shows at the end of the run; fmt::print would throw.
template <typename... Values> void print(fmt::format_string<Values...> format, Values &&...values) {
    const std::string text = fmt::format(format, std::forward<Values>(values)...);
    std::fwrite(text.data(), 1, text.size(), stdout);
}

} // namespace

int compare_command(const std::string &a, const std::string &b, double tolerance) {
    if (!(tolerance >= 0))
        throw InputError({"--tolerance", 0}, "negative, expected a number of at least 0");
    const ImageDifference d = compare_images(read_image(a), read_image(b), a);

    print("mean squared error  {:.6g}\n", d.mse);
    print("relMSE              {:.6g}   mean((a - r)^2 / (r^2 + 0.01)), r from {}\n", d.rel_mse, b);
    print("relMSE, trimmed     {:.6g}   without the worst 0.1% of the pixels\n", d.rel_mse_trimmed);
    print("bias                {:+.6g}   mean(a - r)\n", d.bias);
    print("largest difference  {:.6g}   at pixel ({}, {})\n", d.largest, d.where[0], d.where[1]);
    if (d.nonfinite > 0)
        print("not finite          {} pixels, left out above\n", d.nonfinite);

    const bool differs = d.rel_mse > tolerance || d.nonfinite > 0;
    if (differs)
        print("differs: {}\n", d.nonfinite > 0 ? "pixels are NaN or infinite"
                                               : fmt::format("relMSE is above the tolerance "
                                                             "{:g}",
                                                             tolerance));
    return differs ? 1 : 0;
}

} // namespace clrender
