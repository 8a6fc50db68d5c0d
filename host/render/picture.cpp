#include "picture.h"

#include "film/film_sums.h"

#include <algorithm>
#include <limits>
#include <tbb/parallel_for.h>
#include <type_traits>

namespace clrender {

namespace {

/// So much of the film is read at a time.
constexpr std::size_t chunk_bytes = std::size_t(32) << 20;
/// Rows of pixels that one thread takes over at a time.
constexpr std::size_t grain_rows = 16;

Image black(const PictureTiles &tiles, std::size_t channels) {
    Image image;
    image.width = static_cast<int>(tiles.width);
    image.height = static_cast<int>(tiles.height);
    image.channels = static_cast<int>(channels);
    image.f32.assign(tiles.pixels() * channels, 0.0f);
    return image;
}

/// The values of the pixels from (column, row) on.
float *pixels_of(Image &image, std::size_t row, std::size_t column) {
    const auto width = static_cast<std::size_t>(image.width);
    return image.f32.data() + (row * width + column) * static_cast<std::size_t>(image.channels);
}

/// Pixels [first, end) of a row to their place in the whole image, `row`.
void copy_pixels(Image &part, std::size_t part_row, std::size_t first, std::size_t end,
                 Image &image, std::size_t row) {
    std::copy(pixels_of(part, part_row, first), pixels_of(part, part_row, end),
              pixels_of(image, row, first));
}

/// The rows [first, end) of a film.
Film part_of(const Film &film, std::size_t first, std::size_t end) {
    const auto rows = [&](const auto &pixels) {
        const auto at = [&](std::size_t row) {
            return pixels.begin() +
                   static_cast<std::ptrdiff_t>(row * static_cast<std::size_t>(film.width));
        };
        return pixels.empty() ? pixels : std::decay_t<decltype(pixels)>(at(first), at(end));
    };
    Film part;
    part.width = film.width;
    part.height = static_cast<int>(end - first);
    part.exponent = film.exponent;
    part.pixels = rows(film.pixels);
    part.moments = rows(film.moments);
    return part;
}

} // namespace

std::size_t channels_of(PixelFormat format) {
    switch (format) {
    case PixelFormat::luminance:
        return 1;
    case PixelFormat::luminance_alpha:
        return 2;
    case PixelFormat::rgb:
    case PixelFormat::xyz:
        return 3;
    case PixelFormat::rgba:
    case PixelFormat::xyza:
        break;
    }
    return 4;
}

Picture::Picture(const PictureTiles &tiles, PixelFormat format, Layers layers, int exponent,
                 const ControlLayout &control)
    : image(black(tiles, channels_of(format))), control_means(3 * control.pixels()), tiles_(tiles),
      format_(format), exponent_(exponent), control_(control), rows_(tiles.rows()) {
    if (layers.variance)
        variance = black(tiles, channels_of(format));
    image.color_space = variance.color_space = color_space(format);
    if (layers.samples)
        samples = black(tiles, 1);
}

void Picture::take(const DeviceFilm &film, const Band &band, const LaunchPlan &plan) {
    // Of the band above the rows that this one's samples reach. What lies below its own tiles is
    // not worth showing before the next band's turn.
    const std::size_t own_row = band.tiles.first_row * tiles_.side;
    const std::size_t first_row = own_row - std::min(tiles_.border, own_row);
    const std::size_t end_row = std::min(band.tiles.end_row * tiles_.side, tiles_.height);
    const std::size_t step = std::max<std::size_t>(chunk_bytes / tiles_.row_bytes(), 1);
    const std::size_t margin = tiles_.border;
    // The next band's samples may still reach the last rows.
    const std::size_t final_row =
        plan.done() && end_row < tiles_.height ? end_row - margin : end_row;
    Film rows;
    rows.exponent = exponent_;
    for (std::size_t first = first_row; first < end_row; first += step) {
        const std::size_t end = std::min(first + step, end_row);
        const std::size_t film_row = std::max(first - std::min(margin, first), band.first_row);
        const std::size_t film_end = std::min(end + margin, band.end_row);
        film.read_rows(film_row, film_end - film_row, rows);
        tbb::parallel_for(first, end, grain_rows, [&](std::size_t row) {
            const std::size_t last = std::min(row + grain_rows, end);
            const std::size_t from = std::max(row - std::min(margin, row), film_row);
            const std::size_t to = std::min(last + margin, film_end);
            take_rows(part_of(rows, from - film_row, to - film_row), from, row, last, band, plan);
        });
        take_control_means(rows, film_row, first, end);
        count_clamped(rows.pixels, film_row, std::min(end, final_row));
    }
    mark(band, plan);
}

/// Takes over the rows [first, end) of pixels from a part of the film that begins with `film_row`.
void Picture::take_rows(const Film &film, std::size_t film_row, std::size_t first, std::size_t end,
                        const Band &band, const LaunchPlan &plan) {
    Image mean = film_mean(film, format_);
    const bool with_variance = !variance.f32.empty();
    Image spread = with_variance ? film_variance(film, format_) : Image{};
    Image counts = samples.f32.empty() ? Image{} : film_samples(film);
    for (std::size_t row = first; row < end; ++row) {
        const auto take = [&](std::size_t left, std::size_t right) {
            copy_pixels(mean, row - film_row, left, right, image, row);
            if (with_variance)
                copy_pixels(spread, row - film_row, left, right, variance, row);
            if (!samples.f32.empty())
                copy_pixels(counts, row - film_row, left, right, samples, row);
        };
        const std::size_t tile_row = row / tiles_.side;
        if (tile_row < band.tiles.first_row || plan.samples_of_all() > 0) {
            take(0, tiles_.width);
            continue;
        }
        for (std::size_t column = 0; column < tiles_.columns(); ++column)
            if (plan.has_samples(column, tile_row))
                take(column * tiles_.side, std::min((column + 1) * tiles_.side, tiles_.width));
    }
}

/// Takes over the means of the control tiles' pixels in the rows [first, end) from a part of the
/// film that begins with `film_row`.
void Picture::take_control_means(const Film &film, std::size_t film_row, std::size_t first,
                                 std::size_t end) {
    const FilmUnits units(exponent_);
    for (std::size_t i = 0; i < control_.count(); ++i)
        for_each_control_pixel(
            control_, i, first, end, [&](std::size_t pixel, std::size_t x, std::size_t y) {
                const PixelSums sums(film.pixels[(y - film_row) * tiles_.width + x], units);
                for (int c = 0; c < 3; ++c)
                    control_means[3 * pixel + static_cast<std::size_t>(c)] = sums.mean(c);
            });
}

/// Counts the rows up to `end` that have not been counted yet; `pixels` begin with row `film_row`.
void Picture::count_clamped(const std::vector<FilmPixel> &pixels, std::size_t film_row,
                            std::size_t end) {
    for (; clamped.rows < end; ++clamped.rows)
        for (std::size_t x = 0; x < tiles_.width; ++x)
            if (pixels[(clamped.rows - film_row) * tiles_.width + x].clamped != 0 &&
                clamped.count++ == 0)
                clamped.first = clamped.rows * tiles_.width + x;
}

void Picture::mark(const Band &band, const LaunchPlan &plan) {
    for (std::size_t row = band.tiles.first_row; row < band.tiles.end_row; ++row) {
        Tiles &tiles = rows_[row];
        tiles.all = tiles.all || plan.samples_of_all() > 0;
        if (tiles.all)
            continue;
        std::vector<bool> some(tiles_.columns());
        for (std::size_t column = 0; column < some.size(); ++column)
            some[column] = plan.has_samples(column, row);
        if (std::find(some.begin(), some.end(), true) != some.end())
            tiles.some = std::move(some);
    }
}

/// Fills the gaps of a row of pixels that has some samples.
std::size_t Picture::fill_row(std::size_t row, const Tiles &tiles) {
    const std::size_t none = tiles_.width;
    std::vector<std::size_t> source(tiles_.width);
    std::size_t nearest = none;
    for (std::size_t x = 0; x < tiles_.width; ++x) {
        if (tiles.has(x / tiles_.side))
            nearest = x;
        source[x] = nearest;
    }
    nearest = none;
    for (std::size_t x = tiles_.width; x-- > 0;) {
        if (source[x] == x)
            nearest = x;
        else if (nearest != none && (source[x] == none || nearest - x < x - source[x]))
            source[x] = nearest;
    }
    std::size_t gaps = 0;
    for (std::size_t x = 0; x < tiles_.width; ++x) {
        if (source[x] == x)
            continue;
        ++gaps;
        std::copy_n(pixels_of(image, row, source[x]), image.channels, pixels_of(image, row, x));
        if (!variance.f32.empty())
            std::fill_n(pixels_of(variance, row, x), variance.channels,
                        std::numeric_limits<float>::infinity());
    }
    return gaps;
}

std::size_t Picture::fill_gaps() {
    std::size_t gaps = 0;
    std::vector<std::size_t> filled; // rows of pixels, from top to bottom
    for (std::size_t row = 0; row < tiles_.height; ++row) {
        const Tiles &tiles = rows_[row / tiles_.side];
        if (!tiles.has_any())
            continue;
        filled.push_back(row);
        if (!tiles.all)
            gaps += fill_row(row, tiles);
    }
    if (filled.empty())
        return tiles_.pixels();
    for (std::size_t row = 0; row < tiles_.height; ++row) {
        if (rows_[row / tiles_.side].has_any())
            continue;
        const auto below = std::lower_bound(filled.begin(), filled.end(), row);
        const bool is_below =
            below == filled.begin() || (below != filled.end() && *below - row < row - *(below - 1));
        const std::size_t source = is_below ? *below : *(below - 1);
        const auto values =
            static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.channels);
        std::copy_n(pixels_of(image, source, 0), values, pixels_of(image, row, 0));
        if (!variance.f32.empty())
            std::fill_n(pixels_of(variance, row, 0), values,
                        std::numeric_limits<float>::infinity());
        gaps += tiles_.width;
    }
    return gaps;
}

} // namespace clrender
