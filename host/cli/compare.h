#pragma once
/// `clrender compare A B`.

#include <string>

namespace clrender {

/// Without --tolerance, any difference counts.
inline constexpr double default_compare_tolerance = 0;

/// Prints to stdout how far picture `a` is from the reference `b`. Returns the exit code: 0, or 1
/// if the untrimmed relMSE is above `tolerance` or a pixel of either is NaN or infinite. Throws
/// InputError if a file cannot be read or if sizes or colour channels differ. `flip`: a PNG file
/// for the FLIP map, level / 255 being its value, or "".
int compare_command(const std::string &a, const std::string &b,
                    double tolerance = default_compare_tolerance, const std::string &flip = {});

} // namespace clrender
