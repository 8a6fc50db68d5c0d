#include "gltf_uri.h"

#include <cctype>
#include <cstdint>

namespace clrender::gltf {

namespace {

int value_of_hex(char c) {
    if (c >= '0' && c <= '9')
        return c - '0';
    if (c >= 'a' && c <= 'f')
        return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

int value_of_base64(char c) {
    if (c >= 'A' && c <= 'Z')
        return c - 'A';
    if (c >= 'a' && c <= 'z')
        return c - 'a' + 26;
    if (c >= '0' && c <= '9')
        return c - '0' + 52;
    if (c == '+' || c == '-') // '-' and '_' where an exporter writes the alphabet for URLs
        return 62;
    return c == '/' || c == '_' ? 63 : -1;
}

std::optional<std::string> decode_percent(std::string_view text) {
    std::string bytes;
    bytes.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '%') {
            bytes += text[i];
            continue;
        }
        const int high = i + 2 < text.size() ? value_of_hex(text[i + 1]) : -1;
        const int low = high >= 0 ? value_of_hex(text[i + 2]) : -1;
        if (low < 0)
            return std::nullopt;
        bytes += static_cast<char>(16 * high + low);
        i += 2;
    }
    return bytes;
}

std::optional<std::string> decode_base64(std::string_view text) {
    while (text.ends_with('='))
        text.remove_suffix(1);
    if (text.size() % 4 == 1)
        return std::nullopt;
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3 + 2);
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
        const int value = value_of_base64(c);
        if (value < 0)
            return std::nullopt;
        bits = bits << 6 | static_cast<std::uint32_t>(value);
        count += 6;
        if (count >= 8) {
            count -= 8;
            bytes += static_cast<char>(bits >> count & 0xffU);
        }
    }
    return bytes;
}

} // namespace

std::optional<std::string> decode_data_uri(std::string_view uri) {
    const std::size_t comma = uri.find(',');
    if (!is_data_uri(uri) || comma == std::string_view::npos)
        return std::nullopt;
    const std::string_view data = uri.substr(comma + 1);
    return uri.substr(0, comma).ends_with(";base64") ? decode_base64(data) : decode_percent(data);
}

std::optional<std::string> path_of_uri(std::string_view uri) {
    // A scheme is a letter, then letters, digits, '+', '-' and '.'; one letter alone is a drive.
    std::size_t i = 0;
    while (i < uri.size() && (std::isalnum(static_cast<unsigned char>(uri[i])) != 0 ||
                              uri[i] == '+' || uri[i] == '-' || uri[i] == '.'))
        ++i;
    if (i > 1 && i < uri.size() && uri[i] == ':')
        return std::nullopt;
    return decode_percent(uri);
}

} // namespace clrender::gltf
