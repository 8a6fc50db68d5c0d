/// Reading the EXR files of make_references.py, which have more layers than the program reads.

#include "z_test.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStringAttribute.h>

#include <stdexcept>

namespace clrender::test {

namespace {

/// The channels of the main layer, in the order of clrender::Image.
std::vector<std::string> channel_names(const Imf::ChannelList &channels) {
    std::vector<std::string> names;
    for (const char *name : {"R", "G", "B", "Y", "A"})
        if (channels.findChannel(name) != nullptr)
            names.emplace_back(name);
    return names;
}

Image read_layer(Imf::InputFile &file, const std::string &prefix,
                 const std::vector<std::string> &names) {
    const Imath::Box2i window = file.header().dataWindow();
    Image image;
    image.width = window.max.x - window.min.x + 1;
    image.height = window.max.y - window.min.y + 1;
    image.channels = static_cast<int>(names.size());
    const std::size_t channels = names.size();
    image.f32.resize(static_cast<std::size_t>(image.width) *
                     static_cast<std::size_t>(image.height) * channels);

    Imf::FrameBuffer target;
    for (std::size_t c = 0; c < channels; ++c)
        target.insert(
            prefix + names[c],
            Imf::Slice::Make(Imf::FLOAT, image.f32.data() + c, window, channels * sizeof(float),
                             channels * sizeof(float) * static_cast<std::size_t>(image.width)));
    file.setFrameBuffer(target);
    file.readPixels(window.min.y, window.max.y);
    return image;
}

} // namespace

MeasuredImage read_reference(const std::string &path) {
    Imf::InputFile file(path.c_str());
    const std::vector<std::string> names = channel_names(file.header().channels());
    MeasuredImage reference{read_layer(file, "", names), read_layer(file, "variance.", names), {}};
    for (const std::string &name : names) {
        const auto *text =
            file.header().findTypedAttribute<Imf::StringAttribute>("mean_se_" + name);
        if (text == nullptr)
            throw std::runtime_error(path + ": no attribute mean_se_" + name);
        reference.mean_se.push_back(std::stod(text->value()));
    }
    return reference;
}

} // namespace clrender::test
