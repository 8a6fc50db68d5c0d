#include "device_film.h"

#include <algorithm>

namespace clrender {

namespace {

std::size_t tile_count(const Band &band) {
    return (band.tiles.end_row - band.tiles.first_row) * band.tiles.columns;
}

} // namespace

DeviceFilm::DeviceFilm(const cl::Context &context, const cl::CommandQueue &queue,
                       const PictureTiles &tiles, const std::vector<Band> &bands,
                       const ControlLayout &control)
    : queue_(queue), tiles_(tiles), row_bytes_(tiles.width * sizeof(FilmPixel)),
      control_bytes_(control.bytes()) {
    for (const Band &band : bands) {
        film_bytes_ = std::max(film_bytes_, (band.end_row - band.first_row) * row_bytes_);
        counter_bytes_ = std::max(counter_bytes_, tile_count(band) * sizeof(ItemCounters));
    }
    with_device("making the film", [&] {
        film_ = cl::Buffer(context, CL_MEM_READ_WRITE, film_bytes_);
        counters_ = cl::Buffer(context, CL_MEM_READ_WRITE, counter_bytes_);
        // A buffer has to have some size.
        control_ =
            cl::Buffer(context, CL_MEM_READ_WRITE, std::max(control_bytes_, sizeof(ControlPixel)));
    });
}

void DeviceFilm::begin(const Band &band) {
    // A band has more rows of its own than it shares with the next one, so the rows that are moved
    // do not overlap their new place.
    const std::size_t kept =
        kept_end_row_ > band.first_row ? (kept_end_row_ - band.first_row) * row_bytes_ : 0;
    with_device("clearing the film", [&] {
        if (kept > 0)
            queue_.enqueueCopyBuffer(film_, film_, (band.first_row - band_.first_row) * row_bytes_,
                                     0, kept);
        queue_.enqueueFillBuffer(film_, cl_uint{0}, kept,
                                 (band.end_row - band.first_row) * row_bytes_ - kept);
        queue_.enqueueFillBuffer(counters_, cl_uint{0}, 0, tile_count(band) * sizeof(ItemCounters));
        queue_.finish();
    });
    band_ = band;
    kept_end_row_ = band.end_row;
}

void DeviceFilm::forget() {
    kept_end_row_ = 0;
    if (control_bytes_ > 0)
        with_device("clearing the control tiles",
                    [&] { queue_.enqueueFillBuffer(control_, cl_uint{0}, 0, control_bytes_); });
}

cl_uint DeviceFilm::bind(cl::Kernel &kernel, cl_uint index) const {
    kernel.setArg(index++, film_);
    kernel.setArg(index++, counters_);
    kernel.setArg(index++, control_);
    return index;
}

FilmWindow DeviceFilm::window() const {
    return {static_cast<cl_uint>(band_.first_row), static_cast<cl_uint>(band_.end_row),
            static_cast<cl_uint>(band_.tiles.first_row * band_.tiles.columns)};
}

void DeviceFilm::read_rows(std::size_t first_row, std::size_t count, FilmPixel *pixels) const {
    with_device("reading the film", [&] {
        queue_.enqueueReadBuffer(film_, CL_TRUE, (first_row - band_.first_row) * row_bytes_,
                                 count * row_bytes_, pixels);
    });
}

std::vector<ItemCounters> DeviceFilm::read_counters() const {
    std::vector<ItemCounters> counters(tile_count(band_));
    with_device("reading the counters", [&] {
        queue_.enqueueReadBuffer(counters_, CL_TRUE, 0, counters.size() * sizeof(ItemCounters),
                                 counters.data());
    });
    return counters;
}

std::vector<ControlPixel> DeviceFilm::read_control() const {
    std::vector<ControlPixel> pixels(control_bytes_ / sizeof(ControlPixel));
    if (!pixels.empty())
        with_device("reading the control tiles", [&] {
            queue_.enqueueReadBuffer(control_, CL_TRUE, 0, control_bytes_, pixels.data());
        });
    return pixels;
}

} // namespace clrender
