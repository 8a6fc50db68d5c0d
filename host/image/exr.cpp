#include "formats.h"

#include <ImfChannelList.h>
#include <ImfCompression.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>

#include <array>
#include <cstring>

namespace clrender::image_format {

namespace {

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

/// The channels we take, in our order.
std::vector<std::string> choose_channels(const Imf::ChannelList &channels) {
    const auto has = [&](const char *name) { return channels.findChannel(name) != nullptr; };
    std::vector<std::string> names;
    if (has("R") && has("G") && has("B")) {
        names = {"R", "G", "B"};
    } else if (has("Y") && !has("RY") && !has("BY")) {
        names = {"Y"};
    } else {
        std::string found;
        for (auto it = channels.begin(); it != channels.end() && found.size() < 80; ++it)
            found += std::string(found.empty() ? "" : ", ") + it.name();
        throw FormatError("channels " + found + ", expected R, G, B or Y, with or without A");
    }
    if (has("A"))
        names.emplace_back("A");
    for (const std::string &name : names) {
        const Imf::Channel &channel = channels[name];
        if (channel.xSampling != 1 || channel.ySampling != 1)
            throw FormatError("channel " + name + " is subsampled, expected one value per pixel");
    }
    return names;
}

std::vector<std::string> channel_names(const std::string &layer, int channels) {
    constexpr std::array<const char *, 4> rgba = {"R", "G", "B", "A"};
    constexpr std::array<const char *, 2> grey = {"Y", "A"};
    std::vector<std::string> names;
    for (int c = 0; c < channels; ++c) {
        const auto i = static_cast<std::size_t>(c);
        names.push_back((layer.empty() ? "" : layer + ".") + (channels <= 2 ? grey[i] : rgba[i]));
    }
    return names;
}

Imf::Slice slice(const float *pixels, const Imath::Box2i &window, int channels, int channel) {
    const auto columns =
        static_cast<std::size_t>(window.max.x) + 1 - static_cast<std::size_t>(window.min.x);
    const std::size_t x_stride = sizeof(float) * static_cast<std::size_t>(channels);
    return Imf::Slice::Make(Imf::FLOAT, pixels + channel, window, x_stride, x_stride * columns);
}

Image decode(std::string_view bytes) {
    check_exr_header(bytes);
    MemoryInput stream(bytes);
    Imf::InputFile file(stream, 0);
    const Imath::Box2i window = file.header().dataWindow();
    const std::vector<std::string> names = choose_channels(file.header().channels());

    Image image;
    image.width = window.max.x - window.min.x + 1;
    image.height = window.max.y - window.min.y + 1;
    image.channels = static_cast<int>(names.size());
    if (!file.isComplete())
        throw FormatError("the file ends before its last pixel (truncated)");

    claim_pixels(image.width, image.height, names.size() * sizeof(float));
    image.f32.resize(static_cast<std::size_t>(image.width) *
                     static_cast<std::size_t>(image.height) * names.size());
    Imf::FrameBuffer buffer;
    for (int c = 0; c < image.channels; ++c)
        buffer.insert(names[static_cast<std::size_t>(c)],
                      slice(image.f32.data(), window, image.channels, c));
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
    return image;
}

} // namespace

Image decode_exr(std::string_view bytes) {
    try {
        return decode(bytes);
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

    Imf::FrameBuffer buffer;
    for (const ImageLayer &layer : layers) {
        if (layer.image->width != image.width || layer.image->height != image.height)
            throw FormatError("layer " + layer.name + " has another size than the image");
        const auto names = channel_names(layer.name, layer.image->channels);
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
