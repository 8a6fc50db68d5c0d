/// Colours that are written otherwise today.

#include "../image/image.h"
#include "../log.h"
#include "dialect_rules.h"
#include "mitsuba_text.h"

#include <array>
#include <fmt/format.h>
#include <optional>

namespace clrender::mitsuba {

namespace {

using Channels = std::array<double, 3>;

/// "#ff8000", as HTML writes colours, with channels from 0 to 1.
std::optional<Channels> hexadecimal(std::string_view text) {
    constexpr std::size_t digits = 6;
    const bool is_one = text.size() == 1 + digits && text[0] == '#';
    if (!is_one || text.find_first_not_of("0123456789abcdefABCDEF", 1) != std::string_view::npos)
        return std::nullopt;
    const unsigned long bytes = std::stoul(std::string(text.substr(1)), nullptr, 16);
    constexpr unsigned long byte = 0xff;
    return Channels{static_cast<double>(bytes >> 16U & byte) / byte,
                    static_cast<double>(bytes >> 8U & byte) / byte,
                    static_cast<double>(bytes & byte) / byte};
}

Channels parse_srgb(const SourceLocation &where, const std::string &text) {
    const auto parts = split_list(text);
    if (parts.size() == 1)
        if (const auto channels = hexadecimal(parts[0]))
            return *channels;
    if (text.find('#') != std::string::npos || (parts.size() != 3 && parts.size() != 1))
        throw InputError(where, "<srgb> is " + in_quotes(text) +
                                    ", expected \"#rrggbb\" or 3 numbers or 1");
    const auto numbers = parse_numbers(where, "<srgb>", text);
    return numbers.size() == 1 ? Channels{numbers[0], numbers[0], numbers[0]}
                               : Channels{numbers[0], numbers[1], numbers[2]};
}

void make_rgb(pugi::xml_node value, XmlFile &file, const Channels &linear) {
    file.rename(value, "rgb");
    value.attribute("value").set_value(
        fmt::format("{} {} {}", linear[0], linear[1], linear[2]).c_str());
}

} // namespace

void upgrade_colour(pugi::xml_node value, XmlFile &file) {
    const std::string tag = value.name();
    const bool is_srgb = tag == "srgb";
    if (!is_srgb && tag != "rgb" && tag != "spectrum")
        return;
    value.remove_attribute("intent"); // of spectral rendering alone
    const SourceLocation where = file.where(value);
    if (is_srgb && !value.attribute("value"))
        throw InputError(where, "<srgb> has no value, expected \"#rrggbb\" or 3 numbers or 1");
    if (!value.attribute("value"))
        return;
    const std::string text = value.attribute("value").value();

    if (is_srgb) {
        Channels channels = parse_srgb(where, text);
        for (double &channel : channels)
            channel = srgb_decode(channel);
        make_rgb(value, file, channels);
        return;
    }
    const auto parts = split_list(text);
    if (parts.size() == 1)
        if (const auto channels = hexadecimal(parts[0])) {
            log::warn(where, "the colour " + text +
                                 " is taken as linear, as Mitsuba 0.6 takes it in <" + tag +
                                 ">; <srgb> decodes it");
            make_rgb(value, file, *channels);
        }

    // Mitsuba 0.6 knew three wavelengths, those of red, green and blue.
    if (tag == "spectrum" && parts.size() == 3 && text.find(':') == std::string::npos)
        file.rename(value, "rgb");
}

void upgrade_blackbody(pugi::xml_node value, XmlFile &file) {
    file.rename(value, "spectrum");
    value.append_attribute("type").set_value("blackbody");
    for (const char *name : {"temperature", "scale"}) {
        const pugi::xml_attribute attribute = value.attribute(name);
        if (!attribute)
            continue;
        std::string number = attribute.value();
        if (number.ends_with('K') || number.ends_with('k'))
            number.pop_back();
        pugi::xml_node property = file.append(value, "float", value);
        property.append_attribute("name").set_value(name);
        property.append_attribute("value").set_value(number.c_str());
        value.remove_attribute(name);
    }
}

} // namespace clrender::mitsuba
