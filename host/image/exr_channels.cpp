#include "exr_channels.h"

#include "formats.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>

namespace clrender::image_format {

namespace {

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

/// The name that OpenEXR gives to what a channel is called, or "" if it is no colour.
std::string role_of(const std::string &name) {
    static const std::map<std::string, std::string> roles = {
        {"r", "R"},         {"red", "R"},  {"g", "G"},   {"green", "G"}, {"b", "B"},
        {"blue", "B"},      {"a", "A"},    {"x", "X"},   {"y", "Y"},     {"z", "Z"},
        {"alpha", "A"},     {"ry", "RY"},  {"by", "BY"}, {"l", "Y"},     {"luma", "Y"},
        {"luminance", "Y"}, {"grey", "Y"}, {"gray", "Y"}};
    const auto found = roles.find(lower(name));
    return found == roles.end() ? "" : found->second;
}

/// The channels of one layer, by role.
using Layer = std::map<std::string, std::string>;

/// By the name in front of the last dot, in the order of the file.
std::map<std::string, Layer> layers_of(const Imf::ChannelList &channels) {
    std::map<std::string, Layer> layers;
    for (auto it = channels.begin(); it != channels.end(); ++it) {
        const std::string name = it.name();
        const std::size_t dot = name.rfind('.');
        const std::string own = dot == std::string::npos ? name : name.substr(dot + 1);
        const std::string role = role_of(own);
        if (role.empty())
            continue;
        std::string &channel = layers[dot == std::string::npos ? "" : name.substr(0, dot)][role];
        if (channel.empty() || own == role)
            channel = name;
    }
    return layers;
}

std::optional<ExrColors> colors_of(const Layer &layer) {
    const auto has = [&](const char *role) { return layer.count(role) != 0; };
    if (has("R") && has("G") && has("B"))
        return ExrColors::rgb;
    if (has("X") && has("Y") && has("Z"))
        return ExrColors::xyz;
    if (has("Y") && has("RY") && has("BY"))
        return ExrColors::luma_chroma;
    if (has("Y") && !has("RY") && !has("BY"))
        return ExrColors::grey;
    return std::nullopt;
}

/// How far a layer is from being taken: the first of the lowest rank is.
int rank_of(const std::string &name, ExrColors colors) {
    if (name.empty())
        return 0;
    // X, Y and Z of a layer may be a place or a normal.
    if (colors == ExrColors::xyz)
        return 4;
    if (colors == ExrColors::grey)
        return 3;
    for (const char *whole : {"combined", "beauty", "rgba", "color", "colour", "composite"})
        if (lower(name).find(whole) != std::string::npos)
            return 1;
    return 2;
}

std::vector<std::string> names_of(const Layer &layer, ExrColors colors) {
    static const std::map<ExrColors, std::vector<std::string>> roles = {
        {ExrColors::grey, {"Y"}},
        {ExrColors::rgb, {"R", "G", "B"}},
        {ExrColors::xyz, {"X", "Y", "Z"}},
        {ExrColors::luma_chroma, {"Y", "RY", "BY"}}};
    std::vector<std::string> names;
    for (const std::string &role : roles.at(colors))
        names.push_back(layer.at(role));
    if (const auto alpha = layer.find("A"); alpha != layer.end())
        names.push_back(alpha->second);
    return names;
}

[[noreturn]] void fail(const Imf::ChannelList &channels) {
    std::string found;
    for (auto it = channels.begin(); it != channels.end() && found.size() < 80; ++it)
        found += std::string(found.empty() ? "" : ", ") + it.name();
    throw FormatError("channels " + found +
                      ", expected R, G, B or X, Y, Z or Y (with RY, BY or without), and maybe A");
}

/// Throws if a channel does not have one value for each pixel.
void check_sampling(const Imf::ChannelList &channels, const ExrChannels &chosen) {
    for (const std::string &name : chosen.names) {
        const Imf::Channel &channel = channels[name];
        if (chosen.colors != ExrColors::luma_chroma &&
            (channel.xSampling != 1 || channel.ySampling != 1))
            throw FormatError("channel " + name + " is subsampled, expected one value per pixel");
    }
}

} // namespace

ExrChannels choose_exr_channels(const Imf::ChannelList &channels) {
    ExrChannels chosen;
    std::optional<int> lowest;
    std::vector<std::string> candidates;
    for (const auto &[name, layer] : layers_of(channels)) {
        const auto colors = colors_of(layer);
        if (!colors)
            continue;
        candidates.push_back(name);
        const int rank = rank_of(name, *colors);
        if (lowest && rank >= *lowest)
            continue;
        lowest = rank;
        chosen.colors = *colors;
        chosen.layer = name;
        chosen.names = names_of(layer, *colors);
    }
    if (!lowest)
        fail(channels);
    if (!chosen.layer.empty())
        std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(chosen.other_layers),
                     [&](const std::string &name) { return name != chosen.layer; });

    check_sampling(channels, chosen);
    return chosen;
}

std::optional<ExrChannels> find_exr_layer(const Imf::ChannelList &channels,
                                          const std::string &layer) {
    const auto layers = layers_of(channels);
    const auto found = layers.find(layer);
    const auto colors = found != layers.end() ? colors_of(found->second) : std::nullopt;
    if (!colors || *colors == ExrColors::luma_chroma)
        return std::nullopt;
    const ExrChannels chosen = {*colors, layer, names_of(found->second, *colors), {}};
    check_sampling(channels, chosen);
    return chosen;
}

} // namespace clrender::image_format
