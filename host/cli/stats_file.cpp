#include "stats_file.h"

#include "output_file.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <string_view>

namespace clrender::cli {

namespace {

double per_second(double count, double seconds) {
    return seconds > 0 ? count / seconds : 0;
}

/// Why the render has ended, in a word.
const char *ended_by(const RenderResult &result) {
    if (result.interrupted)
        return "interrupt";
    switch (result.ended_by) {
    case StopReason::time:
        return "time";
    case StopReason::error:
        return "error";
    case StopReason::unknown_error:
        return "unknown error";
    case StopReason::samples:
        break;
    }
    return "samples";
}

} // namespace

void write_stats(const std::string &path, const RenderResult &result, const RunTimes &times) {
    const RenderStats &stats = result.stats;
    // What is not a number becomes null.
    const auto measured = [&](double value) {
        return std::isnan(result.error.relative_variance) ? std::nan("") : value;
    };
    const nlohmann::ordered_json json = {
        {"device", stats.device},
        {"lanes", stats.lanes},
        {"width", stats.width},
        {"height", stats.height},
        {"spp", stats.spp},
        {"interrupted", result.interrupted},
        {"ended_by", ended_by(result)},
        {"paths", stats.paths},
        {"rays", stats.rays},
        {"paths_per_second", per_second(stats.paths, stats.seconds_render)},
        {"rays_per_second", per_second(stats.rays, stats.seconds_render)},
        {"seconds",
         {{"parse", times.parse},
          {"device", stats.seconds_device},
          {"build", stats.seconds_build},
          {"compile", stats.seconds_compile},
          {"upload", stats.seconds_upload},
          {"render", stats.seconds_render},
          {"write", times.write},
          {"total", times.total}}},
        {"kernel",
         {{"features", stats.kernel_features},
          {"cache", stats.kernel_cached ? "hit" : "miss"},
          {"seconds", stats.seconds_kernel}}},
        {"memory", {{"host_bytes", stats.host_bytes}, {"device_bytes", stats.device_bytes}}},
        {"triangles", stats.triangles},
        {"error",
         {{"relative_error", result.error.relative_error()},
          {"relative_variance", result.error.relative_variance},
          {"variance_factor", measured(result.error.factor.value)},
          {"variance_factor_error", measured(result.error.factor.error)}}},
        {"nonfinite_samples", stats.nonfinite_samples},
        {"clamped_pixels", stats.clamped_pixels},
        {"pixels_without_samples", result.gaps},
    };
    write_output_file(path, json.dump(2) + '\n');
}

std::string summary(const RenderResult &result, const RunTimes &times,
                    const std::vector<std::string> &outputs) {
    const RenderStats &s = result.stats;
    std::string files;
    for (const std::string &path : outputs)
        files += (files.empty() ? "" : ", ") + path;
    const double pixels = static_cast<double>(s.width) * s.height;
    // The paths include those of a border around the picture.
    const double samples =
        std::min((s.paths_before + s.paths) / pixels, static_cast<double>(s.spp));
    const std::string gaps =
        result.gaps == 0 ? ""
                         : fmt::format("; {:.3g}% of the pixels have no sample yet and show their "
                                       "neighbours",
                                       100 * static_cast<double>(result.gaps) / pixels);
    return fmt::format("{}{}: {}x{}, {:.4g} samples a pixel, {:.2f} s ({:.2f} Mpaths/s on {}, {} "
                       "lanes; {:.2f} s in all){}",
                       files.empty()        ? "rendered"
                       : result.interrupted ? "interrupted; the picture so far is in "
                                            : "wrote ",
                       files, s.width, s.height, samples, s.seconds_render,
                       per_second(s.paths, s.seconds_render) * 1e-6, s.device, s.lanes, times.total,
                       gaps);
}

std::string reason_line(const RenderResult &result, const RunTimes &times) {
    std::string error;
    if (std::isfinite(result.error.relative_error()))
        error = fmt::format("relative error {:.2g}%, ", 100 * result.error.relative_error());
    std::string_view reason = "all samples taken";
    if (result.interrupted)
        reason = "interrupted";
    else if (result.ended_by == StopReason::time)
        reason = "the time is up";
    else if (result.ended_by == StopReason::error)
        reason = "target reached";
    else if (result.ended_by == StopReason::unknown_error)
        reason = "its error cannot be measured, as all its sums were clamped";
    std::string line = fmt::format("{}{} after {:.3g} s, {} samples a pixel", error, reason,
                                   times.total, result.stats.spp);
    if (!error.empty())
        line += " (error: noise alone, the square root of the mean of variance / (value^2 + .01))";
    return line;
}

} // namespace clrender::cli
