#pragma once
/// The film on the device: the sums of the pixels that one band reaches, and its tiles' counters.

#include "bands.h"
#include "device/cl_context.h"
#include "film/control.h"
#include "film/film.h"
#include "shared/launch_data.h"

#include <optional>
#include <vector>

namespace clrender {

/// What a launch has to be told of the band: the pixel rows that the buffer holds, and the tile
/// that its first counters belong to.
struct FilmWindow {
    cl_uint first_row, end_row, first_tile;
};

class DeviceFilm {
public:
    /// Room for each of `bands`, one at a time, and for the control tiles of all. The first band is
    /// made room for at once, since what takes time is the first touch of the memory. Throws
    /// DeviceError.
    DeviceFilm(const cl::Context &context, const cl::CommandQueue &queue, const PictureTiles &tiles,
               const std::vector<Band> &bands, const ControlLayout &control);

    /// Makes room for a band. Rows that the band before it reaches as well keep their sums, if it
    /// was that one's turn before; all others, and the counters, become zero.
    void begin(const Band &band);
    /// The next band does not follow on the last one: it is the first of a new picture, and the
    /// control tiles become zero.
    void forget();

    /// Keeps the sums as they are, in as much memory again, for restore(). Throws DeviceError.
    void set_aside(const cl::Context &context);
    /// The sums, the counters and the control tiles become what they were then.
    void restore();

    /// The sums of all rows, moments and control tiles become these; the first band is all there
    /// is.
    void load(const Film &film, const std::vector<ControlPixel> &control);

    /// Binds the buffers to arguments from `index` on; returns the index behind them.
    cl_uint bind(cl::Kernel &kernel, cl_uint index) const;
    [[nodiscard]] FilmWindow window() const;

    /// The sums of `count` rows of pixels, counted over the whole picture, and their moments where
    /// the variance is wanted.
    void read_rows(std::size_t first_row, std::size_t count, Film &film) const {
        read_rows(*sums_, first_row, count, film);
    }
    /// The same of all rows, where `aside` as set_aside() has kept them; and the control tiles.
    void read_all(bool aside, Film &film, std::vector<ControlPixel> &control) const;
    /// The counters of the band's tiles.
    [[nodiscard]] std::vector<ItemCounters> read_counters() const;

    /// Of all control tiles, in the order of control.h.
    [[nodiscard]] std::vector<ControlPixel> read_control() const { return read_control(*sums_); }

    [[nodiscard]] std::size_t bytes() const {
        return film_bytes_ + counter_bytes_ + control_bytes_;
    }

private:
    cl::CommandQueue queue_;
    PictureTiles tiles_;
    std::size_t film_bytes_ = 0, counter_bytes_ = 0, control_bytes_ = 0;
    struct Sums {
        cl::Buffer film, counters, control;
    };
    [[nodiscard]] Sums make_sums(const cl::Context &context) const;
    void copy(const Sums &from, const Sums &to) const;
    void read_rows(const Sums &sums, std::size_t first_row, std::size_t count, Film &film) const;
    [[nodiscard]] std::vector<ControlPixel> read_control(const Sums &sums) const;

    std::optional<Sums> sums_, aside_;
    Band band_;
    std::size_t kept_end_row_ = 0; ///< end of the rows in the buffer whose sums go on
    bool unused_ = false;          ///< the first band has room and zeros already
};

} // namespace clrender
