#include "color.h"
#include "exr_channels.h"
#include "exr_io.h"

#include <ImfChannelList.h>
#include <ImfCompression.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <ImfVersion.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace clrender::image_format {

namespace {

class FileOutput : public Imf::OStream {
public:
    explicit FileOutput(AtomicFile &file) : OStream("image"), file_(file) {}

    void write(const char *source, int count) override {
        file_.write({source, static_cast<std::size_t>(count)});
    }
    std::uint64_t tellp() override { return file_.position(); }
    void seekp(std::uint64_t position) override { file_.seek(position); }

private:
    AtomicFile &file_;
};

std::vector<std::string> channel_names(const std::string &layer, const Image &image) {
    std::vector<std::string> names = {"R", "G", "B", "A"};
    if (image.channels <= 2)
        names = {"Y", "A"};
    else if (image.color_space == ColorSpace::xyz)
        names = {"X", "Y", "Z", "A"};
    names.resize(static_cast<std::size_t>(image.channels));
    for (std::string &name : names)
        name.insert(0, layer.empty() ? "" : layer + ".");
    return names;
}

Imf::Slice slice(const float *pixels, const Imath::Box2i &window, int channels, int channel) {
    const auto columns =
        static_cast<std::size_t>(window.max.x) + 1 - static_cast<std::size_t>(window.min.x);
    const std::size_t x_stride = sizeof(float) * static_cast<std::size_t>(channels);
    return Imf::Slice::Make(Imf::FLOAT, pixels + channel, window, x_stride, x_stride * columns);
}

/// The attribute of files whose three colours are X, Y and Z.
Imf::Chromaticities xyz_chromaticities() {
    return {{1, 0}, {0, 1}, {0, 0}, {1.0F / 3, 1.0F / 3}};
}

/// Reads the chosen channels one by one, whatever their types, as floats.
void read_channels(Imf::InputFile &file, const std::vector<std::string> &names, Image &image) {
    const Imath::Box2i window = file.header().dataWindow();
    Imf::FrameBuffer buffer;
    for (int c = 0; c < image.channels; ++c)
        buffer.insert(names[static_cast<std::size_t>(c)],
                      slice(image.f32.data(), window, image.channels, c));
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
}

/// Luma at every pixel, chroma at every second one: the library makes RGB of them, in half.
void read_luma_chroma(std::string_view bytes, const std::string &layer, Image &image) {
    // The library filters 27 rows and keeps 4 more; one is ours.
    constexpr std::size_t rows = 32;
    claim_pixels(image.width, 1, rows * sizeof(Imf::Rgba));
    MemoryInput stream(bytes);
    Imf::RgbaInputFile file(stream, layer, 0);
    const Imath::Box2i window = file.dataWindow();
    const auto columns = static_cast<std::size_t>(image.width);
    const auto channels = static_cast<std::size_t>(image.channels);
    std::vector<Imf::Rgba> row(columns);
    for (int y = 0; y < image.height; ++y) {
        // A row stride of 0: every row is put into the same place.
        file.setFrameBuffer(row.data() - window.min.x, 1, 0);
        file.readPixels(window.min.y + y);
        float *target = &image.f32[static_cast<std::size_t>(y) * columns * channels];
        for (const Imf::Rgba &pixel : row) {
            const std::array<float, 4> values = {pixel.r, pixel.g, pixel.b, pixel.a};
            target = std::copy_n(values.begin(), channels, target);
        }
    }
}

/// Brings colours that are not linear sRGB there.
void convert_colors(const Imf::Header &header, ExrColors colors, Image &image,
                    std::vector<std::string> &remarks) {
    if (colors == ExrColors::grey)
        return;
    if (colors == ExrColors::xyz) {
        image.color_space = ColorSpace::xyz;
        image = in_linear_srgb(std::move(image));
        image.is_converted = true;
        return;
    }
    if (!Imf::hasChromaticities(header))
        return;
    const Imf::Chromaticities &stated = Imf::chromaticities(header);
    const auto xy = [](const Imath::V2f &v) { return glm::dvec2(v.x, v.y); };
    const auto matrix =
        to_srgb({xy(stated.red), xy(stated.green), xy(stated.blue), xy(stated.white)});
    if (!matrix) {
        remarks.emplace_back("its chromaticities span no colour space and are ignored");
    } else if (*matrix != glm::dmat3(1)) {
        transform_colors(image, *matrix);
        image.is_converted = true;
    }
}

void remark_on_layers(const ExrChannels &chosen, std::vector<std::string> &remarks) {
    constexpr std::size_t shown = 6;
    const std::vector<std::string> &others = chosen.other_layers;
    if (others.empty())
        return;
    std::string list;
    for (std::size_t i = 0; i < std::min(others.size(), shown); ++i)
        list += (i == 0 ? "" : ", ") + (others[i].empty() ? "(none)" : others[i]);
    if (others.size() > shown)
        list += ", and " + std::to_string(others.size() - shown) + " more";
    remarks.push_back("layer " + chosen.layer + " is read, these are not: " + list);
}

/// An image for the channels of a complete file, without its pixels.
Image allocate(const Imf::InputFile &file, const ExrChannels &chosen) {
    const Imath::Box2i window = file.header().dataWindow();
    Image image;
    image.width = window.max.x - window.min.x + 1;
    image.height = window.max.y - window.min.y + 1;
    image.channels = static_cast<int>(chosen.names.size());
    if (!file.isComplete())
        throw FormatError("the file ends before its last pixel (truncated)");

    claim_pixels(image.width, image.height, chosen.names.size() * sizeof(float));
    image.f32.resize(static_cast<std::size_t>(image.width) *
                     static_cast<std::size_t>(image.height) * chosen.names.size());
    return image;
}

Image decode(std::string_view bytes, std::vector<std::string> &remarks) {
    check_exr_header(bytes);
    MemoryInput stream(bytes);
    Imf::InputFile file(stream, 0);
    const ExrChannels chosen = choose_exr_channels(file.header().channels());
    remark_on_layers(chosen, remarks);
    if (Imf::isMultiPart(file.version()))
        remarks.emplace_back("of its parts the first one is read");

    Image image = allocate(file, chosen);
    if (chosen.colors == ExrColors::luma_chroma)
        read_luma_chroma(bytes, chosen.layer, image);
    else
        read_channels(file, chosen.names, image);
    convert_colors(file.header(), chosen.colors, image, remarks);
    return image;
}

std::optional<Image> decode_layer(std::string_view bytes, const std::string &layer) {
    check_exr_header(bytes);
    MemoryInput stream(bytes);
    Imf::InputFile file(stream, 0);
    const auto chosen = find_exr_layer(file.header().channels(), layer);
    if (!chosen)
        return std::nullopt;
    Image image = allocate(file, *chosen);
    image.color_space = chosen->colors == ExrColors::xyz ? ColorSpace::xyz : ColorSpace::srgb;
    read_channels(file, chosen->names, image);
    return image;
}

/// What the library throws as a FormatError.
template <typename Decode> auto with_reason(Decode decode_file) {
    try {
        return decode_file();
    } catch (const FormatError &) {
        throw;
    } catch (const std::exception &error) {
        throw FormatError(std::string("cannot be decoded (") + error.what() + ")");
    }
}

} // namespace

Image decode_exr(std::string_view bytes, std::vector<std::string> &remarks) {
    return with_reason([&] { return decode(bytes, remarks); });
}

std::optional<Image> decode_exr_layer(std::string_view bytes, const std::string &layer) {
    return with_reason([&] { return decode_layer(bytes, layer); });
}

void encode_exr(const Image &image, const std::map<std::string, std::string> &metadata,
                const std::vector<ImageLayer> &extra_layers, bool fast, AtomicFile &file) {
    encode_exr(image, metadata, extra_layers, fast, file, {});
}

void encode_exr(const Image &image, const std::map<std::string, std::string> &metadata,
                const std::vector<ImageLayer> &extra_layers, bool fast, AtomicFile &file,
                const AddToExr &add_more) {
    // One flat list of planes: the main layer, then the others with their prefix.
    std::vector<ImageLayer> layers = {{"", &image}};
    layers.insert(layers.end(), extra_layers.begin(), extra_layers.end());
    Imf::Header header(image.width, image.height);
    header.compression() = fast ? Imf::RLE_COMPRESSION : Imf::ZIP_COMPRESSION;
    for (const auto &[name, value] : metadata)
        header.insert(name, Imf::StringAttribute(value));
    if (image.color_space == ColorSpace::xyz)
        Imf::addChromaticities(header, xyz_chromaticities());

    Imf::FrameBuffer buffer;
    for (const ImageLayer &layer : layers) {
        if (layer.image->width != image.width || layer.image->height != image.height)
            throw FormatError("layer " + layer.name + " has another size than the image");
        const auto names =
            layer.channels.empty() ? channel_names(layer.name, *layer.image) : layer.channels;
        for (std::size_t c = 0; c < names.size(); ++c) {
            header.channels().insert(names[c], Imf::Channel(Imf::FLOAT));
            buffer.insert(names[c], slice(layer.image->f32.data(), header.dataWindow(),
                                          layer.image->channels, static_cast<int>(c)));
        }
    }
    if (add_more)
        add_more(header, buffer);

    const int threads = tbb::this_task_arena::max_concurrency();
    if (Imf::globalThreadCount() < threads)
        Imf::setGlobalThreadCount(threads);
    FileOutput stream(file);
    Imf::OutputFile output(stream, header, threads);
    output.setFrameBuffer(buffer);
    output.writePixels(image.height);
}

} // namespace clrender::image_format
