#include "test_command.h"

#include "cli/exit_codes.h"
#include "cli/interrupt.h"
#include "log.h"
#include "print.h"
#include "verify/picture_test.h"
#include "verify/reference.h"
#include "verify/regions.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <utility>

namespace clrender::cli {

namespace {

using verify::Family;
using verify::PictureTest;
using verify::Reference;

/// Samples a pixel of the first look; from there on every look has twice as many.
constexpr int first_look = 1024;

enum class Outcome { same, differs, undecided, hopeless, stopped };

/// The test while it runs.
struct Run {
    std::string scene;
    const Reference &reference;
    AdvancingRender &render;
    PictureTest test;
    RenderResult result;
    PictureTest::Look look;
    int looks = 0;
};

void check_shape(const Reference &reference, const Scene &scene, const std::string &path) {
    const FilmSettings &film = scene.film;
    const Image &image = reference.image;
    if (image.width != film.crop_width || image.height != film.crop_height)
        throw InputError({path, 0},
                         fmt::format("size {} x {}, expected the render's {} x {}", image.width,
                                     image.height, film.crop_width, film.crop_height));
    const bool grey = film.pixel_format == PixelFormat::luminance ||
                      film.pixel_format == PixelFormat::luminance_alpha;
    const int channels = grey ? 1 : 3;
    if (verify::colour_channels(image) != channels)
        throw InputError({path, 0}, fmt::format("{} colour channels, expected the render's {}",
                                                verify::colour_channels(image), channels));
}

/// The reference is read in linear sRGB.
void render_in_srgb(FilmSettings &film) {
    if (film.pixel_format == PixelFormat::xyz)
        film.pixel_format = PixelFormat::rgb;
    if (film.pixel_format == PixelFormat::xyza)
        film.pixel_format = PixelFormat::rgba;
}

/// Renders batch by batch, and looks at 1024, 2048, 4096 ... samples and at the last.
Outcome run_until_decided(Run &run, int most_samples) {
    bool suspected = false;
    for (int next_look = first_look;;) {
        const int samples = run.test.next_samples();
        if (!run.render.advance(samples))
            return Outcome::stopped;
        run.result = run.render.read();
        if (const std::string place = verify::nonfinite_pixel(run.result.image); !place.empty())
            throw InputError({run.scene, 0}, "pixel " + place + " is NaN or infinite");
        run.test.add(run.result.image);
        const bool is_last = run.test.next_samples() > most_samples;
        if (samples < next_look && !is_last)
            continue;
        while (next_look <= samples)
            next_look *= 2;

        run.look = run.test.look(run.result.variance);
        ++run.looks;
        // Rare bright samples that have not come yet may pass for a difference: the next look,
        // with as many samples again, has to see it too.
        const bool differs = run.look.differs();
        if (differs && (suspected || is_last))
            return Outcome::differs;
        suspected = differs;
        if (!differs && run.look.same())
            return Outcome::same;
        if (is_last)
            return Outcome::undecided;
        if (!differs && run.look.hopeless())
            return Outcome::hopeless;
    }
}

std::string channel_name(const Image &image, int channel) {
    constexpr const char *names[] = {"R", "G", "B"};
    return verify::colour_channels(image) == 1 ? "Y" : names[channel];
}

std::string describe(const Image &image, const Family::Finding &finding) {
    return fmt::format("{} is {:.5g} +- {:.2g}, the reference's {:.5g} +- {:.2g} ({:+.2f}%, {:.1f} "
                       "standard errors)",
                       channel_name(image, finding.channel), finding.value, finding.error,
                       finding.reference_value, finding.reference_error,
                       100 * (finding.value / finding.reference_value - 1), std::abs(finding.t));
}

/// The pixel that differs most, in its own standard errors.
void print_worst_pixel(const Run &run) {
    const Image &a = run.result.image, &r = run.reference.image;
    const auto width = static_cast<std::size_t>(a.width);
    const auto colours = static_cast<std::size_t>(verify::colour_channels(a));
    const auto a_stride = static_cast<std::size_t>(a.channels);
    const auto r_stride = static_cast<std::size_t>(r.channels);
    constexpr double rounding_share = 1e-5, tiny = 1e-30;
    double worst = -1;
    Family::Finding finding;
    for (std::size_t p = 0; p < width * static_cast<std::size_t>(a.height); ++p)
        for (std::size_t c = 0; c < colours; ++c) {
            const double value = double{a.f32[p * a_stride + c]};
            const double reference = double{r.f32[p * r_stride + c]};
            const double variance = double{run.result.variance.f32[p * a_stride + c]};
            double reference_variance = 0;
            if (run.reference.variance) {
                const Image &layer = *run.reference.variance;
                reference_variance =
                    double{layer.f32[p * static_cast<std::size_t>(layer.channels) + c]};
            }
            // Where there is no noise, rounding differs.
            const double rounding = rounding_share * reference;
            const double t = (value - reference) /
                             std::sqrt(variance + reference_variance + rounding * rounding + tiny);
            if (std::abs(t) > worst) {
                worst = std::abs(t);
                finding = {p,         static_cast<int>(c),           value, std::sqrt(variance),
                           reference, std::sqrt(reference_variance), t};
            }
        }
    print("  worst pixel ({}, {}): {}\n", finding.window % width, finding.window / width,
          describe(a, finding));
}

void print_difference(const Run &run) {
    constexpr std::size_t shown = 5;
    const Image &image = run.result.image;
    for (const Family::Finding &finding : run.look.families.front().findings)
        print("  mean of the picture: {}\n", describe(image, finding));
    const auto regions = verify::find_regions(run.test, run.look, image);
    for (std::size_t i = 0; i < std::min(regions.size(), shown); ++i) {
        const verify::Region &region = regions[i];
        const auto &windows = region.family->windows();
        print("  {} pixels in x {} to {}, y {} to {}; worst {}x{} block at ({}, {}): {}\n",
              region.pixels, region.left, region.right, region.top, region.bottom, windows.width(),
              windows.height(), windows.left(region.worst.window), windows.top(region.worst.window),
              describe(image, region.worst));
    }
    if (regions.size() > shown)
        print("  and {} smaller regions\n", regions.size() - shown);
    print_worst_pixel(run);
}

/// How near the largest differences came to being beyond the noise.
void print_margins(const Run &run) {
    for (std::size_t f = 0; f < run.look.families.size(); ++f) {
        const Family::Look &look = run.look.families[f];
        print("  {}: largest difference {:.2f} standard errors, noise reaches {:.2f}{}\n",
              run.test.families()[f].name(), std::abs(look.worst.t), look.critical,
              look.excluded ? "" : "; the effect is not excluded");
    }
}

} // namespace

int test_command(const TestOptions &options, Scene &&scene, const RenderOptions &how,
                 const std::function<void(const RenderResult &)> &write) {
    const Reference reference = verify::read_reference(options.reference);
    check_shape(reference, scene, options.reference);
    if (!reference.variance)
        log::warn(options.reference + ": has no layer variance (--aov variance,samples writes it): "
                                      "it is taken as exact");
    render_in_srgb(scene.film);
    RenderOptions render_options = how;
    render_options.with_variance = true;
    const std::string name = scene.name;
    const auto render = start_render(std::move(scene), render_options);
    Run run = {name, reference, *render, PictureTest(reference, options.effect), {}, {}, 0};
    const Outcome outcome = run_until_decided(run, how.spp);
    if (outcome == Outcome::stopped) {
        log::info("test: interrupted");
        return exit_signal + interrupted();
    }
    write(run.result);
    if (run.result.stats.nonfinite_samples > 0)
        log::warn(fmt::format("{} samples were not finite and count as black",
                              run.result.stats.nonfinite_samples));
    const std::string samples =
        fmt::format("after {} samples a pixel, {} look{}", run.render.samples(), run.looks,
                    run.looks == 1 ? "" : "s");
    switch (outcome) {
    case Outcome::differs:
        print("test: differs, {}\n", samples);
        print_difference(run);
        write_image(options.marked, verify::mark_regions(run.result.image, run.test, run.look));
        print("  {} shows where\n", options.marked);
        return exit_differs;
    case Outcome::same:
        print("test: same, {}\n", samples);
        break;
    case Outcome::hopeless:
        print("test: cannot decide, {}: no difference is seen, but the reference is too noisy to "
              "exclude one; give it more samples\n",
              samples);
        break;
    default:
        print("test: cannot decide, {}: no difference is seen, but -s allows too few samples to "
              "exclude one\n",
              samples);
    }
    print_margins(run);
    return exit_fine;
}

} // namespace clrender::cli
