#pragma once
/// Small OpenEXR files, byte by byte: uncompressed scan lines ("OpenEXR File Layout").

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace test {

enum class ExrType : std::int32_t { uint32, half, float32 };

/// Values in rows from the top, as many as the sampling leaves of the picture; half takes the bits.
struct ExrChannel {
    std::string name;
    ExrType type = ExrType::float32;
    std::vector<double> values;
    int sampling = 1;
};

template <class T> void append_raw(std::string &bytes, T value) {
    std::string raw(sizeof(T), '\0');
    std::memcpy(raw.data(), &value, sizeof(T));
    bytes += raw;
}

inline void append_attribute(std::string &bytes, const std::string &name, const std::string &type,
                             const std::string &value) {
    bytes += name + '\0' + type + '\0';
    append_raw(bytes, static_cast<std::int32_t>(value.size()));
    bytes += value;
}

template <class T> std::string raw_values(const std::vector<T> &values) {
    std::string bytes;
    for (const T value : values)
        append_raw(bytes, value);
    return bytes;
}

inline void append_value(std::string &bytes, ExrType type, double value) {
    if (type == ExrType::uint32)
        append_raw(bytes, static_cast<std::uint32_t>(value));
    else if (type == ExrType::half)
        append_raw(bytes, static_cast<std::uint16_t>(value));
    else
        append_raw(bytes, static_cast<float>(value));
}

/// A file of that size; `chromaticities` are eight numbers, or none.
inline std::string exr_bytes(int width, int height, std::vector<ExrChannel> channels,
                             const std::vector<float> &chromaticities = {}) {
    std::sort(channels.begin(), channels.end(),
              [](const ExrChannel &a, const ExrChannel &b) { return a.name < b.name; });
    std::string list;
    for (const ExrChannel &c : channels) {
        list += c.name + '\0';
        list += raw_values<std::int32_t>(
            {static_cast<std::int32_t>(c.type), 0, c.sampling, c.sampling});
    }
    list += '\0';
    const std::string window = raw_values<std::int32_t>({0, 0, width - 1, height - 1});
    std::string bytes = raw_values<std::int32_t>({20000630, 2});
    append_attribute(bytes, "channels", "chlist", list);
    if (!chromaticities.empty())
        append_attribute(bytes, "chromaticities", "chromaticities", raw_values(chromaticities));
    append_attribute(bytes, "compression", "compression", std::string(1, '\0'));
    append_attribute(bytes, "dataWindow", "box2i", window);
    append_attribute(bytes, "displayWindow", "box2i", window);
    append_attribute(bytes, "lineOrder", "lineOrder", std::string(1, '\0'));
    append_attribute(bytes, "pixelAspectRatio", "float", raw_values<float>({1}));
    append_attribute(bytes, "screenWindowCenter", "v2f", raw_values<float>({0, 0}));
    append_attribute(bytes, "screenWindowWidth", "float", raw_values<float>({1}));
    bytes += '\0';

    // Each line: its number, its length, and for each channel the values that it has there.
    std::vector<std::string> lines;
    for (int y = 0; y < height; ++y) {
        std::string line;
        for (const ExrChannel &c : channels) {
            const int columns = width / c.sampling;
            for (int x = 0; y % c.sampling == 0 && x < columns; ++x)
                append_value(line, c.type,
                             c.values.at(static_cast<std::size_t>(y / c.sampling * columns + x)));
        }
        lines.push_back(line);
    }
    std::uint64_t offset = bytes.size() + 8 * lines.size();
    for (const std::string &line : lines) {
        append_raw(bytes, offset);
        offset += 8 + line.size();
    }
    for (int y = 0; y < height; ++y) {
        append_raw(bytes, y);
        append_raw(bytes, static_cast<std::int32_t>(lines[static_cast<std::size_t>(y)].size()));
        bytes += lines[static_cast<std::size_t>(y)];
    }
    return bytes;
}

/// One pixel.
inline std::string exr_pixel(const std::vector<std::pair<std::string, double>> &channels,
                             const std::vector<float> &chromaticities = {}) {
    std::vector<ExrChannel> all;
    for (const auto &[name, value] : channels)
        all.push_back({name, ExrType::float32, {value}});
    return exr_bytes(1, 1, all, chromaticities);
}

} // namespace test
