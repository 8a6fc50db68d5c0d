#pragma once
/// The text at the beginning of a PLY file: which elements follow, of which types.

#include "../error.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace clrender {

enum class PlyFormat { ascii, little_endian, big_endian };
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::float32;
    bool is_list = false;
    PlyType count_type = PlyType::uint8; ///< list: type of the length in front of the items
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
    int line = 0;
};

struct PlyHeader {
    PlyFormat format = PlyFormat::ascii;
    std::vector<PlyElement> elements;
    std::size_t body_offset = 0; ///< bytes
    int body_line = 0;           ///< number of the first line after the header
    char line_end = '\n';        ///< the last byte of each line: line feed or carriage return
};

/// Bytes of one value in a binary file.
std::size_t ply_type_size(PlyType type);

/// Throws InputError if the text is no PLY header or if it promises more elements than `bytes`,
/// the whole file, can hold.
PlyHeader parse_ply_header(std::string_view bytes, const std::string &path);

} // namespace clrender
