#include "xml_file.h"

#include "../input_file.h"
#include "../memory_limit.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <new>

namespace clrender {

namespace {

/// Finds the first element that is nested too deep, without recursion.
class DepthWalker : public pugi::xml_tree_walker {
public:
    bool for_each(pugi::xml_node &node) override {
        if (depth() < max_xml_depth)
            return true;
        too_deep = node;
        return false;
    }

    pugi::xml_node too_deep;
};

} // namespace

XmlFile::XmlFile(const std::string &path, const SourceLocation &referrer) : path_(path) {
    read(referrer);
    parse();
}

SourceLocation XmlFile::where(const pugi::xml_node &node) const {
    return {path_, line_at(offset_of(node))};
}

std::ptrdiff_t XmlFile::offset_of(const pugi::xml_node &node) const {
    const auto noted = offsets_.find(node.internal_object());
    return noted != offsets_.end() ? noted->second : node.offset_debug();
}

void XmlFile::rename(pugi::xml_node node, const std::string &name) {
    offsets_[node.internal_object()] = offset_of(node);
    node.set_name(name.c_str());
}

pugi::xml_node XmlFile::append(pugi::xml_node parent, const char *name,
                               const pugi::xml_node &like) {
    const pugi::xml_node added = parent.append_child(name);
    offsets_[added.internal_object()] = offset_of(like);
    return added;
}

pugi::xml_node XmlFile::prepend(pugi::xml_node parent, const char *name,
                                const pugi::xml_node &like) {
    const pugi::xml_node added = parent.prepend_child(name);
    offsets_[added.internal_object()] = offset_of(like);
    return added;
}

int XmlFile::line_at(std::ptrdiff_t offset) const {
    const auto end = std::lower_bound(line_ends_.begin(), line_ends_.end(), offset);
    return static_cast<int>(end - line_ends_.begin()) + 1;
}

void XmlFile::read(const SourceLocation &referrer) {
    // Look at what it is before opening it: opening a FIFO would wait for ever.
    const bool referred = !referrer.file.empty();
    const SourceLocation where = referred ? referrer : SourceLocation{path_, 0};
    const std::string prefix = referred ? "\"" + path_ + "\": " : "";
    std::error_code error;
    const auto status = std::filesystem::status(path_, error);
    if (!std::filesystem::exists(status))
        throw InputError(where, prefix + "no such file, expected a scene file");
    if (!std::filesystem::is_regular_file(status))
        throw InputError(where, prefix + "not a regular file, expected a scene file");
    const std::uintmax_t size = std::filesystem::file_size(path_, error);
    if (error || size > max_xml_bytes)
        throw InputError(where, prefix + "the file is too large, expected at most 256 MiB");

    note_input_file(path_);
    std::ifstream stream(path_, std::ios::binary);
    text_.resize(static_cast<std::size_t>(size));
    if (!stream || !stream.read(text_.data(), static_cast<std::streamsize>(size)))
        throw InputError(where, prefix + "cannot be read, expected a readable file");
}

void XmlFile::parse() {
    line_ends_.reserve(static_cast<std::size_t>(std::count(text_.begin(), text_.end(), '\n')));
    for (std::size_t i = 0; i < text_.size(); ++i)
        if (text_[i] == '\n')
            line_ends_.push_back(static_cast<std::uint32_t>(i));
    if (text_.find_first_not_of(" \t\r\n") == std::string::npos)
        throw InputError({path_, 1}, "the file is empty, expected a <scene> element");
    if (const std::size_t nul = text_.find('\0'); nul != std::string::npos)
        throw InputError({path_, line_at(static_cast<std::ptrdiff_t>(nul))},
                         "NUL byte, expected XML in UTF-8, not a binary file");

    // pugixml takes 64 bytes for a node and 40 for an attribute.
    const auto count = [&](char c) {
        return static_cast<std::uint64_t>(std::count(text_.begin(), text_.end(), c));
    };
    if (const std::string reason = claim_memory(text_.size() + 64 * count('<') + 40 * count('='));
        !reason.empty())
        throw InputError({path_, 0}, reason);

    const pugi::xml_parse_result result = document_.load_buffer_inplace(
        text_.data(), text_.size(), pugi::parse_default, pugi::encoding_utf8);
    if (result.status == pugi::status_out_of_memory)
        throw std::bad_alloc();
    if (!result) {
        std::string reason = result.description();
        reason[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(reason[0])));
        throw InputError({path_, line_at(result.offset)},
                         "XML syntax error: " + reason + ", expected well-formed XML");
    }

    DepthWalker walker;
    document_.traverse(walker);
    if (walker.too_deep)
        throw InputError(where(walker.too_deep), "elements nested too deep, expected at most " +
                                                     std::to_string(max_xml_depth) + " levels");
}

} // namespace clrender
