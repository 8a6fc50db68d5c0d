#include "color.h"
#include "exr_channels.h"
#include "formats.h"

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
#include <ImfVersion.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

namespace clrender::image_format {

namespace {

/// Compressed blocks shrink zeros by about a thousand; below `always_fine` bytes nobody is hurt.
constexpr std::uint64_t max_expansion = 2048;
constexpr std::uint64_t always_fine = std::uint64_t{64} << 20;

/// What decides how much memory the library takes as soon as it opens a file.
struct Extent {
    std::int64_t width = 0, height = 0;
    std::int64_t tile_width = 0, tile_height = 0; ///< 0: scan lines
    std::uint64_t channels = 0;
    int compression = 0;
};

std::string_view take(std::string_view &bytes, std::size_t count) {
    if (bytes.size() < count)
        throw FormatError("the file ends within its header (truncated)");
    const std::string_view taken = bytes.substr(0, count);
    bytes.remove_prefix(count);
    return taken;
}

std::string_view take_name(std::string_view &bytes) {
    const std::string_view name = bytes.substr(0, bytes.find('\0'));
    take(bytes, name.size() + 1);
    return name;
}

std::int64_t take_int(std::string_view &bytes) {
    std::uint32_t value = 0;
    const std::string_view raw = take(bytes, 4);
    for (std::size_t i = 4; i-- > 0;)
        value = value << 8 | static_cast<unsigned char>(raw[i]);
    return static_cast<std::int32_t>(value);
}

/// Reads the attributes of the first header: name, type, size, value, up to an empty name.
Extent read_extent(std::string_view bytes) {
    Extent extent;
    take(bytes, 8);
    for (std::string_view name = take_name(bytes); !name.empty(); name = take_name(bytes)) {
        (void)take_name(bytes);
        const std::int64_t size = take_int(bytes);
        if (size < 0)
            throw FormatError("damaged header (an attribute of negative size)");
        std::string_view value = take(bytes, static_cast<std::size_t>(size));
        if (name == "dataWindow") {
            const std::int64_t x = take_int(value);
            const std::int64_t y = take_int(value);
            extent.width = take_int(value) - x + 1;
            extent.height = take_int(value) - y + 1;
        } else if (name == "tiles") {
            extent.tile_width = take_int(value);
            extent.tile_height = take_int(value);
        } else if (name == "compression") {
            extent.compression = static_cast<unsigned char>(take(value, 1)[0]);
        } else if (name == "channels") {
            // Per channel: its name, type, flags and samplings; an empty name ends the list.
            while (!take_name(value).empty()) {
                take(value, 16);
                ++extent.channels;
            }
        }
    }
    return extent;
}

/// Throws if the header asks for more memory than the file's length can justify.
void check_extent(std::string_view bytes) {
    const Extent extent = read_extent(bytes);
    check_size(extent.width, extent.height, bytes.size(), std::numeric_limits<double>::infinity());

    // The library holds whole blocks: up to 32 rows, with DWAB up to 256, or a tile.
    const std::int64_t rows = extent.compression == Imf::DWAB_COMPRESSION ? 256 : 32;
    const auto image = static_cast<std::uint64_t>(extent.width * std::max(extent.height, rows));
    if (extent.tile_width < 0 || extent.tile_height < 0)
        throw FormatError("damaged header (a tile of negative size)");
    const auto tile = static_cast<std::uint64_t>(extent.tile_width) *
                      static_cast<std::uint64_t>(extent.tile_height);
    const std::uint64_t limit = std::max(always_fine, max_expansion * bytes.size());
    if (std::max(image, tile) > limit / sizeof(float) / std::max<std::uint64_t>(extent.channels, 1))
        throw FormatError("size " + std::to_string(extent.width) + " x " +
                          std::to_string(extent.height) + " promised, but the file has only " +
                          std::to_string(bytes.size()) + " bytes");
}

class MemoryInput : public Imf::IStream {
public:
    explicit MemoryInput(std::string_view bytes) : IStream("image"), bytes_(bytes) {}

    bool read(char *target, int count) override {
        const auto wanted = static_cast<std::uint64_t>(count);
        if (count < 0 || offset_ > bytes_.size() || wanted > bytes_.size() - offset_)
            throw FormatError("the file ends before its last pixel (truncated)");
        std::memcpy(target, bytes_.data() + offset_, wanted);
        offset_ += wanted;
        return offset_ < bytes_.size();
    }
    std::uint64_t tellg() override { return offset_; }
    void seekg(std::uint64_t offset) override { offset_ = offset; }

private:
    std::string_view bytes_;
    std::uint64_t offset_ = 0;
};

class MemoryOutput : public Imf::OStream {
public:
    MemoryOutput() : OStream("image") {}

    void write(const char *source, int count) override {
        const auto size = static_cast<std::size_t>(count);
        if (offset_ + size > bytes.size())
            bytes.resize(offset_ + size);
        std::memcpy(bytes.data() + offset_, source, size);
        offset_ += size;
    }
    std::uint64_t tellp() override { return offset_; }
    void seekp(std::uint64_t offset) override { offset_ = offset; }

    std::string bytes;

private:
    std::uint64_t offset_ = 0;
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

Image decode(std::string_view bytes, std::vector<std::string> &remarks) {
    check_extent(bytes);
    MemoryInput stream(bytes);
    Imf::InputFile file(stream, 0);
    const Imath::Box2i window = file.header().dataWindow();
    const ExrChannels chosen = choose_exr_channels(file.header().channels());
    remark_on_layers(chosen, remarks);
    if (Imf::isMultiPart(file.version()))
        remarks.emplace_back("of its parts the first one is read");

    Image image;
    image.width = window.max.x - window.min.x + 1;
    image.height = window.max.y - window.min.y + 1;
    image.channels = static_cast<int>(chosen.names.size());
    if (!file.isComplete())
        throw FormatError("the file ends before its last pixel (truncated)");

    image.f32.resize(static_cast<std::size_t>(image.width) *
                     static_cast<std::size_t>(image.height) * chosen.names.size());
    if (chosen.colors == ExrColors::luma_chroma)
        read_luma_chroma(bytes, chosen.layer, image);
    else
        read_channels(file, chosen.names, image);
    convert_colors(file.header(), chosen.colors, image, remarks);
    return image;
}

} // namespace

Image decode_exr(std::string_view bytes, std::vector<std::string> &remarks) {
    try {
        return decode(bytes, remarks);
    } catch (const FormatError &) {
        throw;
    } catch (const std::exception &error) {
        throw FormatError(std::string("cannot be decoded (") + error.what() + ")");
    }
}

std::string encode_exr(const Image &image, const std::map<std::string, std::string> &metadata,
                       const std::vector<ImageLayer> &extra_layers) {
    // One flat list of planes: the main layer, then the others with their prefix.
    std::vector<ImageLayer> layers = {{"", &image}};
    layers.insert(layers.end(), extra_layers.begin(), extra_layers.end());
    Imf::Header header(image.width, image.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const auto &[name, value] : metadata)
        header.insert(name, Imf::StringAttribute(value));
    if (image.color_space == ColorSpace::xyz)
        Imf::addChromaticities(header, xyz_chromaticities());

    Imf::FrameBuffer buffer;
    for (const ImageLayer &layer : layers) {
        if (layer.image->width != image.width || layer.image->height != image.height)
            throw FormatError("layer " + layer.name + " has another size than the image");
        const auto names = channel_names(layer.name, *layer.image);
        for (std::size_t c = 0; c < names.size(); ++c) {
            header.channels().insert(names[c], Imf::Channel(Imf::FLOAT));
            buffer.insert(names[c], slice(layer.image->f32.data(), header.dataWindow(),
                                          layer.image->channels, static_cast<int>(c)));
        }
    }

    MemoryOutput stream;
    {
        Imf::OutputFile file(stream, header, 0);
        file.setFrameBuffer(buffer);
        file.writePixels(image.height);
    }
    return std::move(stream.bytes);
}

} // namespace clrender::image_format
