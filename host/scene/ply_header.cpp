#include "ply_header.h"

#include "obj_lines.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <map>

namespace clrender {

namespace {

constexpr std::size_t max_header_line = 4096;
constexpr std::uint64_t max_count = 0x7fffffff;

class HeaderParser {
public:
    HeaderParser(std::string_view bytes, const std::string &path) : bytes_(bytes), path_(path) {}

    PlyHeader parse();

private:
    using Words = std::vector<std::string_view>;

    std::string_view next_line();
    void parse_format(const Words &words);
    void parse_element(const Words &words);
    void parse_property(const Words &words);
    PlyType parse_type(std::string_view word, bool is_integer);
    void check_size(const PlyElement &element) const;
    [[noreturn]] void fail(const std::string &reason) const {
        throw InputError({path_, line_}, reason);
    }

    std::string_view bytes_;
    std::string path_;
    int line_ = 0;
    PlyHeader header_;
};

PlyHeader HeaderParser::parse() {
    // The first line tells how lines end; in the others, a lone carriage return or line feed behind
    // such an end is data or part of a comment.
    const std::size_t first_end = std::min(bytes_.find_first_of("\r\n"), bytes_.size());
    const std::string_view rest = bytes_.substr(first_end);
    if (rest.starts_with('\r') && !rest.starts_with("\r\n"))
        header_.line_end = '\r';
    if (next_line() != "ply")
        fail("not a PLY file, expected 'ply' in the first line");
    bool has_format = false;
    while (true) {
        const std::string_view line = next_line();
        const Words words = split_words(line);
        if (words.empty() || words[0] == "comment" || words[0] == "obj_info")
            continue;
        if (words[0] == "end_header")
            break;
        if (words[0] == "format") {
            parse_format(words);
            has_format = true;
        } else if (words[0] == "element") {
            parse_element(words);
        } else if (words[0] == "property") {
            parse_property(words);
        } else {
            fail(quoted(words[0]) + ", expected format, comment, element, property or end_header");
        }
    }
    if (!has_format)
        fail("no format line before end_header");
    header_.body_line = line_ + 1;
    for (const PlyElement &element : header_.elements)
        check_size(element);
    return std::move(header_);
}

std::string_view HeaderParser::next_line() {
    ++line_;
    const std::string_view rest = bytes_.substr(header_.body_offset);
    const std::size_t end = rest.substr(0, max_header_line).find(header_.line_end);
    if (end == std::string_view::npos)
        fail(rest.size() > max_header_line ? "header line longer than 4096 bytes"
                                           : "the file ends within the header");
    header_.body_offset += end + 1;
    std::string_view line = rest.substr(0, end);
    if (line.ends_with('\r'))
        line.remove_suffix(1);
    return line;
}

void HeaderParser::parse_format(const Words &words) {
    static const std::map<std::string_view, PlyFormat> formats = {
        {"ascii", PlyFormat::ascii},
        {"binary_little_endian", PlyFormat::little_endian},
        {"binary_big_endian", PlyFormat::big_endian}};
    const auto found = words.size() == 3 ? formats.find(words[1]) : formats.end();
    if (found == formats.end() || words[2] != "1.0")
        fail("bad format, expected ascii, binary_little_endian or binary_big_endian, and 1.0");
    header_.format = found->second;
}

void HeaderParser::parse_element(const Words &words) {
    if (words.size() != 3)
        fail("bad element, expected: element NAME COUNT");
    PlyElement element;
    element.name = words[1];
    element.line = line_;
    const char *end = words[2].data() + words[2].size();
    const auto [next, error] = std::from_chars(words[2].data(), end, element.count);
    if (error != std::errc() || next != end || element.count > max_count)
        fail(
            fmt::format("count {}, expected an integer from 0 to {}", quoted(words[2]), max_count));
    header_.elements.push_back(std::move(element));
}

void HeaderParser::parse_property(const Words &words) {
    if (header_.elements.empty())
        fail("property before any element");
    const bool is_list = words.size() > 1 && words[1] == "list";
    if (words.size() != (is_list ? 5U : 3U))
        fail("bad property, expected: property TYPE NAME, or: property list TYPE TYPE NAME");
    PlyProperty property;
    property.is_list = is_list;
    if (is_list)
        property.count_type = parse_type(words[2], true);
    property.type = parse_type(words[words.size() - 2], false);
    property.name = words.back();
    header_.elements.back().properties.push_back(std::move(property));
}

PlyType HeaderParser::parse_type(std::string_view word, bool is_integer) {
    static const std::map<std::string_view, PlyType> types = {
        {"char", PlyType::int8},      {"int8", PlyType::int8},       {"uchar", PlyType::uint8},
        {"uint8", PlyType::uint8},    {"short", PlyType::int16},     {"int16", PlyType::int16},
        {"ushort", PlyType::uint16},  {"uint16", PlyType::uint16},   {"int", PlyType::int32},
        {"int32", PlyType::int32},    {"uint", PlyType::uint32},     {"uint32", PlyType::uint32},
        {"float", PlyType::float32},  {"float32", PlyType::float32}, {"double", PlyType::float64},
        {"float64", PlyType::float64}};
    const auto found = types.find(word);
    if (found == types.end())
        fail("type " + quoted(word) +
             ", expected char, uchar, short, ushort, int, uint, float, "
             "double or the names with bits");
    if (is_integer && (found->second == PlyType::float32 || found->second == PlyType::float64))
        fail("a list's length has type " + quoted(word) + ", expected an integer type");
    return found->second;
}

void HeaderParser::check_size(const PlyElement &element) const {
    // The least that one element takes: a digit and a blank per value in text, empty lists.
    std::uint64_t row = 0;
    for (const PlyProperty &property : element.properties) {
        if (header_.format == PlyFormat::ascii)
            row += 2;
        else
            row += ply_type_size(property.is_list ? property.count_type : property.type);
    }
    const std::uint64_t left = bytes_.size() - header_.body_offset + 1;
    if (element.count > 0 && (row == 0 || element.count > left / row))
        throw InputError({path_, element.line},
                         fmt::format("{} elements {} promised, but the file ends before",
                                     element.count, quoted(element.name)));
}

} // namespace

std::size_t ply_type_size(PlyType type) {
    constexpr std::array<std::size_t, 8> sizes = {1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[static_cast<std::size_t>(type)];
}

PlyHeader parse_ply_header(std::string_view bytes, const std::string &path) {
    return HeaderParser(bytes, path).parse();
}

} // namespace clrender
