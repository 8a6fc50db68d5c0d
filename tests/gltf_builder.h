#pragma once
/// glTF files for tests, put together in memory.

#include <nlohmann/json.hpp>

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

namespace test {

inline std::string base64(const std::string &bytes) {
    const char *digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits =
                bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
        for (std::size_t k = 0; k < 4; ++k)
            text += i + k <= bytes.size() ? digits[bits >> (18 - 6 * k) & 63U] : '=';
    }
    return text;
}

/// The lowest byte first, as this machine and glTF have them.
template <typename T> std::string bytes_of(const std::vector<T> &values) {
    std::string bytes(values.size() * sizeof(T), '\0');
    std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
}

/// `json` is the file's text, but for buffer 0, whose bytes are `buffer`.
struct GltfBuilder {
    nlohmann::json json = {{"asset", {{"version", "2.0"}}},
                           {"scene", 0},
                           {"scenes", {{{"nodes", nlohmann::json::array()}}}}};
    std::string buffer;

    /// Appends to an array of the file; returns the index.
    int add(const std::string &list, const nlohmann::json &object) {
        json[list].push_back(object);
        return static_cast<int>(json[list].size()) - 1;
    }
    int view(const std::string &bytes, const nlohmann::json &more = nlohmann::json::object()) {
        buffer.resize((buffer.size() + 3) / 4 * 4);
        nlohmann::json view = {
            {"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}};
        view.update(more);
        buffer += bytes;
        return add("bufferViews", view);
    }
    template <typename T>
    int accessor(const std::vector<T> &values, const std::string &type, std::size_t count,
                 const nlohmann::json &more = nlohmann::json::object()) {
        const int component = std::is_same_v<T, std::int8_t>     ? 5120
                              : std::is_same_v<T, std::uint8_t>  ? 5121
                              : std::is_same_v<T, std::int16_t>  ? 5122
                              : std::is_same_v<T, std::uint16_t> ? 5123
                              : std::is_same_v<T, std::uint32_t> ? 5125
                                                                 : 5126;
        nlohmann::json accessor = {{"bufferView", view(bytes_of(values))},
                                   {"componentType", component},
                                   {"count", count},
                                   {"type", type}};
        accessor.update(more);
        return add("accessors", accessor);
    }
    /// A node of the scene itself.
    int node(const nlohmann::json &object) {
        const int index = add("nodes", object);
        json["scenes"][0]["nodes"].push_back(index);
        return index;
    }
    int mesh(const nlohmann::json &primitive) {
        return add("meshes", {{"primitives", {primitive}}});
    }
    /// The square [-1, 1]^2 in z = 0, with more attributes.
    nlohmann::json square(int material, const nlohmann::json &attributes = {}) {
        nlohmann::json primitive;
        primitive["attributes"]["POSITION"] =
            accessor<float>({-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0}, "VEC3", 4);
        if (!attributes.is_null())
            primitive["attributes"].update(attributes);
        primitive["indices"] = accessor<std::uint8_t>({0, 1, 2, 0, 2, 3}, "SCALAR", 6);
        if (material >= 0)
            primitive["material"] = material;
        return primitive;
    }
    /// (u, v) of it: the whole of a picture, upright.
    int square_uvs() { return accessor<float>({0, 1, 1, 1, 1, 0, 0, 0}, "VEC2", 4); }
    [[nodiscard]] std::string text() const {
        nlohmann::json all = json;
        if (!all.contains("buffers") && !buffer.empty())
            all["buffers"] = {{{"byteLength", buffer.size()},
                               {"uri", "data:application/octet-stream;base64," + base64(buffer)}}};
        return all.dump(1);
    }
    [[nodiscard]] std::string binary() const {
        nlohmann::json all = json;
        all["buffers"] = {{{"byteLength", buffer.size()}}};
        std::string text = all.dump();
        text.resize((text.size() + 3) / 4 * 4, ' ');
        std::string content = buffer;
        content.resize((content.size() + 3) / 4 * 4);
        const auto word = [](std::size_t value) {
            return bytes_of<std::uint32_t>({static_cast<std::uint32_t>(value)});
        };
        return "glTF" + word(2) + word(12 + 16 + text.size() + content.size()) + word(text.size()) +
               "JSON" + text + word(content.size()) + std::string("BIN\0", 4) + content;
    }
};

/// A BMP of 24 bits a pixel, from the RGB of its rows, the top one first.
inline std::string bitmap_file(int width, int height, const std::vector<std::uint8_t> &rgb) {
    const auto word = [](int value) { return bytes_of<std::int32_t>({value}); };
    const int row = (3 * width + 3) / 4 * 4;
    std::string pixels;
    for (int y = height - 1; y >= 0; --y) {
        std::string line;
        for (int x = 0; x < width; ++x)
            for (const int c : {2, 1, 0})
                line += static_cast<char>(rgb[static_cast<std::size_t>(3 * (y * width + x) + c)]);
        line.resize(static_cast<std::size_t>(row));
        pixels += line;
    }
    return "BM" + word(54 + row * height) + word(0) + word(54) + word(40) + word(width) +
           word(height) + bytes_of<std::int16_t>({1, 24}) + word(0) + word(row * height) +
           word(2835) + word(2835) + word(0) + word(0) + pixels;
}

} // namespace test
