#pragma once
/// The picture that a render's bands are put together to.

#include "bands.h"
#include "device_film.h"
#include "film/control.h"
#include "film/film.h"
#include "scene/scene.h"

#include <vector>

namespace clrender {

/// Channels of a picture.
std::size_t channels_of(PixelFormat format);

class Picture {
public:
    /// What there is besides the image.
    struct Layers {
        bool variance = false, samples = false;
    };

    /// Black, in the channels of `format`; with the layers that are wanted. `exponent`: as Film.
    Picture(const PictureTiles &tiles, PixelFormat format, Layers layers, int exponent,
            const ControlLayout &control);

    /// Takes over the band that is in `film`, as far as the launches of `plan` have got: the pixels
    /// of tiles without samples stay as they are, and those of the band above that this one reaches
    /// are replaced.
    void take(const DeviceFilm &film, const Band &band, const LaunchPlan &plan);
    /// All bands will be taken again.
    void begin_again() { clamped = {}; }

    /// Gives each pixel that never had a sample the colour of the nearest one in its row that has,
    /// or else of the nearest row, and an infinite variance. Returns how many there are.
    std::size_t fill_gaps();

    /// Pixels with sums beyond the film's range, and the first of them.
    struct Clamped {
        std::size_t count = 0, first = 0;
        std::size_t rows = 0; ///< that have been counted
    };

    Image image;
    Image variance; ///< were the samples independent; empty where it is not wanted
    Image samples;  ///< of each pixel, one channel; empty where it is not wanted
    Clamped clamped;
    std::vector<double> control_means; ///< as ControlSums

private:
    /// Which tiles of a row of them have samples: all, or those marked, or none.
    struct Tiles {
        bool all = false;
        std::vector<bool> some;

        [[nodiscard]] bool has_any() const { return all || !some.empty(); }
        [[nodiscard]] bool has(std::size_t column) const {
            return all || (!some.empty() && some[column]);
        }
    };

    void take_rows(const Film &film, std::size_t film_row, std::size_t first, std::size_t end,
                   const Band &band, const LaunchPlan &plan);
    void take_control_means(const Film &film, std::size_t film_row, std::size_t first,
                            std::size_t end);
    void count_clamped(const std::vector<FilmPixel> &pixels, std::size_t film_row, std::size_t end);
    void mark(const Band &band, const LaunchPlan &plan);
    std::size_t fill_row(std::size_t row, const Tiles &tiles);

    PictureTiles tiles_;
    PixelFormat format_;
    int exponent_;
    ControlLayout control_;
    std::vector<Tiles> rows_; ///< of tiles
};

} // namespace clrender
