#pragma once
/// Which of the channels of an OpenEXR file are the picture.

#include <ImfChannelList.h>

#include <optional>
#include <string>
#include <vector>

namespace clrender::image_format {

enum class ExrColors { grey, rgb, xyz, luma_chroma };

/// The channels that are read.
struct ExrChannels {
    ExrColors colors = ExrColors::rgb;
    std::string layer;                     ///< what stands in front of the last dot, or ""
    std::vector<std::string> names;        ///< as in the file: the colours, then maybe alpha
    std::vector<std::string> other_layers; ///< that have colours too; empty if `layer` is ""
};

/// Finds R G B, X Y Z, Y RY BY (luma and chroma) or Y, each with A or without, in any case and
/// under their English names. The channels without a layer come first; else a layer whose name says
/// that it is the whole picture, else the first one, those with R G B before the others. Throws
/// FormatError.
ExrChannels choose_exr_channels(const Imf::ChannelList &channels);

/// The same for the layer called `layer`; none where there is no such layer with colours.
std::optional<ExrChannels> find_exr_layer(const Imf::ChannelList &channels,
                                          const std::string &layer);

} // namespace clrender::image_format
