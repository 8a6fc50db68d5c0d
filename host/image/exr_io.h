#pragma once
/// What readers and writers of EXR files share.

#include "formats.h"

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>

#include <cstring>
#include <functional>

namespace clrender::image_format {

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

/// Adds attributes and channels to those of a file, before it is written.
using AddToExr = std::function<void(Imf::Header &, Imf::FrameBuffer &)>;

/// encode_exr() of formats.h, with more in the file than pictures.
void encode_exr(const Image &image, const std::map<std::string, std::string> &metadata,
                const std::vector<ImageLayer> &extra_layers, bool fast, AtomicFile &file,
                const AddToExr &add_more);

} // namespace clrender::image_format
