#pragma once
/// One XML file in memory that knows the line of every element.

#include "../error.h"

#include <cstdint>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace clrender {

/// No scene needs deeper nesting; whoever walks an XmlFile may therefore recurse.
inline constexpr int max_xml_depth = 64;
inline constexpr std::uintmax_t max_xml_bytes = std::uintmax_t{256} << 20U;

class XmlFile {
public:
    /// Reads and parses `path`: a regular file of UTF-8 text, at most `max_xml_bytes` long, nested
    /// at most `max_xml_depth` deep. Never blocks. Throws InputError, at `referrer` (if it names a
    /// file) where the file cannot be opened, else at the offending line.
    explicit XmlFile(const std::string &path, const SourceLocation &referrer = {});

    [[nodiscard]] pugi::xml_node root() const { return document_.document_element(); }
    [[nodiscard]] const std::string &path() const { return path_; }
    [[nodiscard]] std::size_t size() const { return text_.size(); }

    /// The place of an element.
    [[nodiscard]] SourceLocation where(const pugi::xml_node &node) const;

    /// Gives an element another name; it keeps its place.
    void rename(pugi::xml_node node, const std::string &name);
    /// A new element at the end of `parent`, or at its beginning, placed where `like` is.
    pugi::xml_node append(pugi::xml_node parent, const char *name, const pugi::xml_node &like);
    pugi::xml_node prepend(pugi::xml_node parent, const char *name, const pugi::xml_node &like);

private:
    [[nodiscard]] int line_at(std::ptrdiff_t offset) const;
    [[nodiscard]] std::ptrdiff_t offset_of(const pugi::xml_node &node) const;
    void read(const SourceLocation &referrer);
    void parse();

    std::string path_;
    std::string text_;                     ///< parsed in place; must outlive the document
    std::vector<std::uint32_t> line_ends_; ///< max_xml_bytes fits
    pugi::xml_document document_;
    /// Offsets of elements whose names are not the file's: pugixml knows those of others.
    std::unordered_map<const void *, std::ptrdiff_t> offsets_;
};

} // namespace clrender
