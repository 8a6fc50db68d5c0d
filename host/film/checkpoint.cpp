#include "checkpoint.h"

#include "checksum.h"
#include "error.h"
#include "film_blocks.h"
#include "film_sums.h"
#include "image/exr_io.h"
#include "input_file.h"
#include "output_file.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStringAttribute.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstring>
#include <fmt/core.h>

namespace clrender {

namespace {

constexpr const char *state_name = "clrender.state";
constexpr const char *options_name = "clrender.options";
constexpr const char *control_name = "clrender.control";

/// The version of the sums' meaning.
constexpr int sums_version = 1;

constexpr std::size_t pixel_words = sizeof(FilmPixel) / sizeof(uint);
constexpr std::size_t moment_words = sizeof(FilmMoments) / sizeof(uint);

std::string checksum_of(const Checkpoint &checkpoint) {
    std::uint64_t sum = 0;
    const auto add = [&](const auto &values) {
        sum = checksum(sum, values.data(), values.size() * sizeof(values[0]));
    };
    add(checkpoint.film.pixels);
    add(checkpoint.film.moments);
    add(checkpoint.control);
    return fmt::format("{:016x}", sum);
}

nlohmann::json state_of(const Checkpoint &checkpoint) {
    const FilmLayout &layout = checkpoint.layout;
    nlohmann::json work = nlohmann::json::array();
    for (const WorkPiece &piece : checkpoint.work)
        work.push_back(
            {piece.first_block, piece.end_block, piece.colour, piece.first_item, piece.end_item});
    return {{"sums", sums_version},
            {"exponent", layout.exponent},
            {"lanes", layout.lanes},
            {"format", static_cast<int>(layout.format)},
            {"columns", layout.grid.columns},
            {"rows", layout.grid.rows},
            {"by_colour", layout.grid.by_colour},
            {"control_side", layout.control.side},
            {"control_group", layout.control.group},
            {"measured", layout.measured},
            {"work", work},
            {"checksum", checksum_of(checkpoint)}};
}

/// Names and places of the words of a pixel's record, for Imf::FrameBuffer.
template <typename Record, typename Visit>
void for_each_word(const char *layer, std::size_t words, Record *records, Visit visit) {
    for (std::size_t i = 0; i < words; ++i)
        visit(fmt::format("{}.{:02}", layer, i),
              reinterpret_cast<char *>(records) + i * sizeof(uint), sizeof(Record));
}

/// Visits all words of the sums: name, place of the first pixel's, bytes from pixel to pixel.
template <typename Visit> void for_each_sum(Film &film, Visit visit) {
    for_each_word("sums", pixel_words, film.pixels.data(), visit);
    if (!film.moments.empty())
        for_each_word("moments", moment_words, film.moments.data(), visit);
}

Imf::Slice sums_slice(const Film &film, char *first, std::size_t stride) {
    return {Imf::UINT, first, stride, stride * static_cast<std::size_t>(film.width)};
}

std::string bytes_of(const std::vector<ControlPixel> &control) {
    return {reinterpret_cast<const char *>(control.data()), control.size() * sizeof(control[0])};
}

void check(bool is_right, const std::string &path, const std::string &what) {
    if (!is_right)
        throw InputError({path, 0}, what);
}

void read_state(const nlohmann::json &state, Checkpoint &checkpoint) {
    FilmLayout &layout = checkpoint.layout;
    layout.exponent = checkpoint.film.exponent = state.at("exponent");
    layout.lanes = state.at("lanes");
    layout.format = static_cast<PixelFormat>(state.at("format").get<int>());
    layout.grid = {state.at("columns"), state.at("rows"), state.at("by_colour")};
    layout.control = {static_cast<std::size_t>(layout.width),
                      static_cast<std::size_t>(layout.height), state.at("control_side"),
                      state.at("control_group")};
    layout.measured = state.at("measured");
    for (const nlohmann::json &piece : state.at("work"))
        checkpoint.work.push_back(
            {piece.at(0), piece.at(1), piece.at(2), piece.at(3), piece.at(4)});
}

/// What a state may say, so that nothing that follows from it goes beyond its bounds.
bool is_sound(const FilmLayout &layout, const Work &work) {
    const std::size_t side = layout.control.side;
    const auto sides = [&](int pixels) {
        return (static_cast<std::uint64_t>(pixels) + side - 1) / std::max<std::size_t>(side, 1);
    };
    if (side < 1 || side > 64 || layout.grid.columns != sides(layout.width) ||
        layout.grid.rows != sides(layout.height) ||
        static_cast<unsigned>(layout.format) > static_cast<unsigned>(PixelFormat::xyza))
        return false;
    constexpr int most_blocks = 1 << 25;
    const Work all = all_work(layout.grid, 0, most_blocks);
    for (std::size_t i = 0; i < work.size(); ++i)
        if (work[i].first_block < 0 ||
            overlap({work[i]}, Work(work.begin() + static_cast<std::ptrdiff_t>(i) + 1, work.end())))
            return false;
    return missing_work(work, all).empty();
}

Checkpoint decode(const std::string &path, const std::string &bytes) {
    image_format::check_exr_header(bytes);
    image_format::MemoryInput stream(bytes);
    Imf::InputFile file(stream);
    const auto *state_text = file.header().findTypedAttribute<Imf::StringAttribute>(state_name);
    const auto *options = file.header().findTypedAttribute<Imf::StringAttribute>(options_name);
    check(state_text != nullptr && options != nullptr, path,
          "is no checkpoint, expected one that --checkpoint or --part has written");
    check(file.isComplete(), path, "is a damaged checkpoint (truncated)");
    const nlohmann::json state = nlohmann::json::parse(state_text->value());
    check(
        state.at("sums") == sums_version, path,
        fmt::format("has sums of version {}, expected {}", state.at("sums").dump(), sums_version));

    Checkpoint checkpoint;
    checkpoint.options = options->value();
    const Imath::Box2i window = file.header().dataWindow();
    check(window.min == Imath::V2i(0, 0), path, "is a damaged checkpoint (its window is moved)");
    checkpoint.layout.width = checkpoint.film.width = window.max.x + 1;
    checkpoint.layout.height = checkpoint.film.height = window.max.y + 1;
    read_state(state, checkpoint);
    check(is_sound(checkpoint.layout, checkpoint.work), path,
          "is a damaged checkpoint (its state)");
    const std::size_t pixels =
        static_cast<std::size_t>(window.max.x + 1) * static_cast<std::size_t>(window.max.y + 1);
    image_format::claim_pixels(window.max.x + 1, window.max.y + 1,
                               sizeof(FilmPixel) +
                                   (checkpoint.layout.measured ? sizeof(FilmMoments) : 0));
    checkpoint.film.pixels.resize(pixels);
    checkpoint.film.moments.resize(checkpoint.layout.measured ? pixels : 0);
    Imf::FrameBuffer buffer;
    for_each_sum(checkpoint.film, [&](const std::string &name, char *first, std::size_t stride) {
        check(file.header().channels().findChannel(name) != nullptr, path,
              "is a damaged checkpoint (it lacks the layer " + name + ")");
        buffer.insert(name, sums_slice(checkpoint.film, first, stride));
    });
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);

    const auto *control = file.header().findTypedAttribute<Imf::StringAttribute>(control_name);
    const std::size_t control_bytes = checkpoint.layout.control.bytes();
    check((control != nullptr ? control->value().size() : 0) == control_bytes, path,
          "is a damaged checkpoint (its control tiles)");
    checkpoint.control.resize(checkpoint.layout.control.pixels());
    if (control_bytes > 0)
        std::memcpy(checkpoint.control.data(), control->value().data(), control_bytes);
    check(state.at("checksum") == checksum_of(checkpoint), path,
          "is a damaged checkpoint (its checksum differs)");
    return checkpoint;
}

} // namespace

bool FilmLayout::operator==(const FilmLayout &other) const {
    return width == other.width && height == other.height && exponent == other.exponent &&
           lanes == other.lanes && format == other.format && grid == other.grid &&
           control.side == other.control.side && control.group == other.control.group &&
           measured == other.measured;
}

void write_checkpoint(const std::string &path, const Checkpoint &checkpoint, const Image &picture,
                      const std::map<std::string, std::string> &metadata) {
    const auto add_sums = [&](Imf::Header &header, Imf::FrameBuffer &buffer) {
        header.insert(state_name, Imf::StringAttribute(state_of(checkpoint).dump()));
        header.insert(options_name, Imf::StringAttribute(checkpoint.options));
        if (!checkpoint.control.empty())
            header.insert(control_name, Imf::StringAttribute(bytes_of(checkpoint.control)));
        // The library does not write to what it writes from.
        auto &film = const_cast<Film &>(checkpoint.film);
        for_each_sum(film, [&](const std::string &name, char *first, std::size_t stride) {
            header.channels().insert(name, Imf::Channel(Imf::UINT));
            buffer.insert(name, sums_slice(film, first, stride));
        });
    };
    // The lower words are noise: what packs them better takes many times the time.
    write_encoded_file(path, [&](AtomicFile &file) {
        image_format::encode_exr(picture, metadata, {}, true, file, add_sums);
    });
}

Checkpoint read_checkpoint(const std::string &path) {
    const std::string bytes = read_input_file(path);
    try {
        return decode(path, bytes);
    } catch (const InputError &) {
        throw;
    } catch (const std::bad_alloc &) {
        throw;
    } catch (const std::exception &error) {
        throw InputError({path, 0},
                         std::string("is no checkpoint that can be read (") + error.what() + ")");
    }
}

void add_checkpoint(Checkpoint &sum, const Checkpoint &part) {
    for (std::size_t i = 0; i < sum.film.pixels.size(); ++i)
        add_pixel(sum.film.pixels[i], part.film.pixels[i]);
    for (std::size_t i = 0; i < sum.film.moments.size(); ++i)
        add_moments(sum.film.moments[i], part.film.moments[i]);
    for (std::size_t i = 0; i < sum.control.size(); ++i)
        for (std::size_t k = 0; k < std::size(sum.control[i].rendering); ++k) {
            add_pixel(sum.control[i].rendering[k].sums, part.control[i].rendering[k].sums);
            add_moments(sum.control[i].rendering[k].moments, part.control[i].rendering[k].moments);
        }
    sum.work.insert(sum.work.end(), part.work.begin(), part.work.end());
    sum.work = joined(std::move(sum.work));
}

int samples_of(const Checkpoint &checkpoint) {
    int end = 0;
    for (const WorkPiece &piece : checkpoint.work)
        end = std::max(end, piece.end_block);
    const Work missing = missing_work(all_work(checkpoint.layout.grid, 0, end), checkpoint.work);
    for (const WorkPiece &piece : missing)
        end = std::min(end, piece.first_block);
    return CLR_BLOCK_START(end);
}

} // namespace clrender
