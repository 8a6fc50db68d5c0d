#include "device_film.h"

#include <algorithm>
#include <utility>

namespace clrender {

namespace {

std::size_t tile_count(const Band &band) {
    return (band.tiles.end_row - band.tiles.first_row) * band.tiles.columns;
}

} // namespace

DeviceFilm::DeviceFilm(const cl::Context &context, const cl::CommandQueue &queue,
                       const PictureTiles &tiles, const std::vector<Band> &bands,
                       const ControlLayout &control)
    : queue_(queue), tiles_(tiles), control_bytes_(control.bytes()) {
    for (const Band &band : bands) {
        film_bytes_ = std::max(film_bytes_, (band.end_row - band.first_row) * tiles.row_bytes());
        counter_bytes_ = std::max(counter_bytes_, tile_count(band) * sizeof(ItemCounters));
    }
    sums_.emplace(make_sums(context));
    begin(bands.front());
    unused_ = true;
}

DeviceFilm::Sums DeviceFilm::make_sums(const cl::Context &context) const {
    Sums sums;
    with_device("making the film", [&] {
        sums.film = cl::Buffer(context, CL_MEM_READ_WRITE, film_bytes_);
        sums.counters = cl::Buffer(context, CL_MEM_READ_WRITE, counter_bytes_);
        // A buffer has to have some size.
        sums.control =
            cl::Buffer(context, CL_MEM_READ_WRITE, std::max(control_bytes_, sizeof(ControlPixel)));
    });
    return sums;
}

void DeviceFilm::copy(const Sums &from, const Sums &to) const {
    with_device("copying the film", [&] {
        queue_.enqueueCopyBuffer(from.film, to.film, 0, 0, film_bytes_);
        queue_.enqueueCopyBuffer(from.counters, to.counters, 0, 0, counter_bytes_);
        if (control_bytes_ > 0)
            queue_.enqueueCopyBuffer(from.control, to.control, 0, 0, control_bytes_);
        queue_.finish();
    });
}

void DeviceFilm::set_aside(const cl::Context &context) {
    if (!aside_)
        aside_.emplace(make_sums(context));
    copy(*sums_, *aside_);
}

void DeviceFilm::restore() {
    copy(*aside_, *sums_);
}

void DeviceFilm::begin(const Band &band) {
    if (std::exchange(unused_, false)) {
        kept_end_row_ = band.end_row;
        return;
    }
    const std::size_t row = tiles_.row_bytes();
    // A band has more rows of its own than it shares with the next one, so the rows that are moved
    // do not overlap their new place.
    const std::size_t kept =
        kept_end_row_ > band.first_row ? (kept_end_row_ - band.first_row) * row : 0;
    with_device("clearing the film", [&] {
        if (kept > 0)
            queue_.enqueueCopyBuffer(sums_->film, sums_->film,
                                     (band.first_row - band_.first_row) * row, 0, kept);
        queue_.enqueueFillBuffer(sums_->film, cl_uint{0}, kept,
                                 (band.end_row - band.first_row) * row - kept);
        queue_.enqueueFillBuffer(sums_->counters, cl_uint{0}, 0,
                                 tile_count(band) * sizeof(ItemCounters));
        queue_.finish();
    });
    band_ = band;
    kept_end_row_ = band.end_row;
}

void DeviceFilm::forget() {
    kept_end_row_ = 0;
    if (control_bytes_ > 0)
        with_device("clearing the control tiles", [&] {
            queue_.enqueueFillBuffer(sums_->control, cl_uint{0}, 0, control_bytes_);
        });
}

cl_uint DeviceFilm::bind(cl::Kernel &kernel, cl_uint index) const {
    kernel.setArg(index++, sums_->film);
    kernel.setArg(index++, sums_->counters);
    kernel.setArg(index++, sums_->control);
    return index;
}

FilmWindow DeviceFilm::window() const {
    return {static_cast<cl_uint>(band_.first_row), static_cast<cl_uint>(band_.end_row),
            static_cast<cl_uint>(band_.tiles.first_row * band_.tiles.columns)};
}

void DeviceFilm::load(const Film &film, const std::vector<ControlPixel> &control) {
    forget();
    unused_ = false;
    with_device("loading the film", [&] {
        const auto write = [&](const cl::Buffer &to, const auto &values) {
            if (!values.empty())
                queue_.enqueueWriteBuffer(to, CL_TRUE, 0, values.size() * sizeof(values[0]),
                                          values.data());
        };
        if (tiles_.measured) {
            std::vector<MeasuredPixel> measured(film.pixels.size());
            for (std::size_t i = 0; i < measured.size(); ++i)
                measured[i] = {film.pixels[i], film.moments[i]};
            write(sums_->film, measured);
        } else {
            write(sums_->film, film.pixels);
        }
        write(sums_->control, control);
    });
    kept_end_row_ = band_.end_row;
}

void DeviceFilm::read_all(bool aside, Film &film, std::vector<ControlPixel> &control) const {
    const Sums &sums = aside ? *aside_ : *sums_;
    read_rows(sums, band_.first_row, band_.end_row - band_.first_row, film);
    control = read_control(sums);
}

void DeviceFilm::read_rows(const Sums &sums, std::size_t first_row, std::size_t count,
                           Film &film) const {
    const std::size_t pixels = count * tiles_.width;
    film.width = static_cast<int>(tiles_.width);
    film.height = static_cast<int>(count);
    film.pixels.resize(pixels);
    const auto read = [&](void *to) {
        with_device("reading the film", [&] {
            queue_.enqueueReadBuffer(sums.film, CL_TRUE,
                                     (first_row - band_.first_row) * tiles_.row_bytes(),
                                     count * tiles_.row_bytes(), to);
        });
    };
    if (!tiles_.measured) {
        read(film.pixels.data());
        return;
    }
    std::vector<MeasuredPixel> measured(pixels);
    read(measured.data());
    film.moments.resize(pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
        film.pixels[i] = measured[i].sums;
        film.moments[i] = measured[i].moments;
    }
}

std::vector<ItemCounters> DeviceFilm::read_counters() const {
    std::vector<ItemCounters> counters(tile_count(band_));
    with_device("reading the counters", [&] {
        queue_.enqueueReadBuffer(sums_->counters, CL_TRUE, 0,
                                 counters.size() * sizeof(ItemCounters), counters.data());
    });
    return counters;
}

std::vector<ControlPixel> DeviceFilm::read_control(const Sums &sums) const {
    std::vector<ControlPixel> pixels(control_bytes_ / sizeof(ControlPixel));
    if (!pixels.empty())
        with_device("reading the control tiles", [&] {
            queue_.enqueueReadBuffer(sums.control, CL_TRUE, 0, control_bytes_, pixels.data());
        });
    return pixels;
}

} // namespace clrender
