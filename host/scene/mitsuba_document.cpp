#include "mitsuba_document.h"

#include "../input_file.h"
#include "../log.h"
#include "dialect.h"
#include "mitsuba_parameters.h"
#include "mitsuba_text.h"
#include "mitsuba_transform.h"
#include "xml_file.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

namespace clrender::mitsuba {

namespace {

constexpr std::size_t max_include_depth = 16;
constexpr std::size_t max_files = 4096; ///< includes may fan out: 16 levels alone are no limit

const std::vector<std::string> object_tags{
    "bsdf",    "emitter", "film",  "integrator", "medium",  "phase", "rfilter",
    "sampler", "sensor",  "shape", "subsurface", "texture", "volume"};
const std::vector<std::string> value_tags{"boolean", "float",    "integer",   "point", "rgb",
                                          "string",  "spectrum", "transform", "vector"};
const std::vector<std::string> other_tags{"alias", "default", "include", "path", "ref"};

bool contains(const std::vector<std::string> &list, const std::string &item) {
    return std::find(list.begin(), list.end(), item) != list.end();
}

/// Walks the XML in document order and fills a Document.
class DocumentReader {
public:
    DocumentReader(const std::map<std::string, std::string> &defines, bool all_faults)
        : parameters_(defines) {
        document_.all_faults = all_faults;
    }

    Document read(const std::string &path) {
        read_file(path, {}, none, "");
        resolve_references();
        for (const std::string &name : parameters_.unused_defines())
            log::warn(std::string("-D ").append(name).append(": nothing in ").append(path) +
                      " uses it");
        return std::move(document_);
    }

private:
    struct Place {
        XmlFile &xml;
        const Dialect &dialect;
        int file;   ///< index into Document::files
        int parent; ///< index into Document::objects, or none at the root
    };

    void read_file(const std::string &path, const SourceLocation &referrer, int parent,
                   const std::string &name);
    void check_include(const std::string &path, const SourceLocation &referrer) const;
    void read_children(pugi::xml_node node, const Place &place);
    void attempt_element(pugi::xml_node node, const Place &place);
    void read_element(pugi::xml_node node, const Place &place);
    int read_object(pugi::xml_node node, const Place &place);
    void read_value(pugi::xml_node node, const Place &place);
    void read_reference(pugi::xml_node node, const Place &place);
    void read_alias(pugi::xml_node node, const Place &place);
    void read_default(pugi::xml_node node, const Place &place);
    void read_include(pugi::xml_node node, const Place &place);
    void read_path(pugi::xml_node node, const Place &place);
    void resolve_references();

    PropertyValue parse_value(pugi::xml_node node, const Place &place);
    Object &object(int index) { return document_.objects.at(static_cast<std::size_t>(index)); }
    SourceFile &source(int index) { return document_.files.at(static_cast<std::size_t>(index)); }

    Document document_;
    Parameters parameters_;
    std::map<std::string, int> ids_;
    std::vector<std::string> open_files_; ///< canonical, outermost first
    std::uintmax_t bytes_ = 0;
};

void DocumentReader::check_include(const std::string &path, const SourceLocation &referrer) const {
    if (contains(open_files_, path))
        throw InputError(referrer, "the file includes itself by way of " + quoted_path(path) +
                                       ", expected includes without a cycle");
    if (open_files_.size() >= max_include_depth)
        throw InputError(referrer, "includes nested too deep, expected at most " +
                                       std::to_string(max_include_depth) + " levels");
    if (document_.files.size() >= max_files)
        throw InputError(referrer,
                         "too many includes, expected at most " + std::to_string(max_files));
}

void DocumentReader::read_file(const std::string &path, const SourceLocation &referrer, int parent,
                               const std::string &name) {
    std::error_code ignored;
    const std::string canonical = std::filesystem::weakly_canonical(path, ignored).string();
    if (parent != none)
        check_include(canonical, referrer);

    XmlFile xml(path, referrer);
    bytes_ += xml.size();
    if (bytes_ > max_xml_bytes)
        throw InputError(referrer, "the included files are too large, expected at most 256 MiB "
                                   "in all");

    // A file looks in its own folder first, then where the file that includes it looks.
    SourceFile file{path, {std::filesystem::path(path).parent_path().string()}};
    if (parent != none) {
        const auto &folders = source(object(parent).file).folders;
        file.folders.insert(file.folders.end(), folders.begin(), folders.end());
    }
    document_.files.push_back(std::move(file));
    open_files_.push_back(canonical);

    pugi::xml_node root = xml.root();
    parameters_.substitute(root, xml);
    const std::string tag = root.name();
    if (parent == none && tag != "scene")
        throw InputError(xml.where(root),
                         "the root element is " + in_quotes(tag) + ", expected <scene>");
    const Dialect dialect(xml);
    const Place place{xml, dialect, static_cast<int>(document_.files.size()) - 1, parent};

    // An included <scene> adds its content, any other root is itself a child.
    if (tag == "scene") {
        check_attributes(root, xml, {}, {"version", "id", "name", "type"});
        Place inside = place;
        if (parent == none) {
            document_.objects.push_back({tag, tag, "", place.file, xml.where(root).line, {}, {}});
            inside.parent = 0;
        }
        read_children(root, inside);
    } else {
        root.remove_attribute("version");
        read_element(root, place);
        if (!name.empty() && !object(parent).children.empty())
            object(parent).children.back().name = name;
    }
    open_files_.pop_back();
}

void DocumentReader::read_children(pugi::xml_node node, const Place &place) {
    for (const pugi::xml_node child : node.children()) {
        if (child.type() == pugi::node_element)
            attempt_element(child, place);
        else if (child.type() == pugi::node_pcdata)
            log::warn(place.xml.where(child), "text " + in_quotes(child.value()) + " is ignored");
    }
}

/// Reads an element; where all faults are asked for, notes what is wrong with it.
void DocumentReader::attempt_element(pugi::xml_node node, const Place &place) {
    const std::size_t open_files = open_files_.size();
    try {
        read_element(node, place);
    } catch (const InputError &error) {
        if (!document_.all_faults)
            throw;
        document_.faults.emplace_back(error.what());
        open_files_.resize(open_files);
    }
}

void DocumentReader::read_element(pugi::xml_node node, const Place &place) {
    using Reader = void (DocumentReader::*)(pugi::xml_node, const Place &);
    static const std::map<std::string, Reader> readers{{"ref", &DocumentReader::read_reference},
                                                       {"alias", &DocumentReader::read_alias},
                                                       {"default", &DocumentReader::read_default},
                                                       {"include", &DocumentReader::read_include},
                                                       {"path", &DocumentReader::read_path}};

    parameters_.substitute(node, place.xml);
    place.dialect.upgrade(node, place.xml);
    const std::string tag = node.name();
    const bool is_spectrum_object = tag == "spectrum" && node.attribute("type");
    if (contains(object_tags, tag) || is_spectrum_object) {
        const std::string name = node.attribute("name").value();
        const int line = place.xml.where(node).line;
        const int index = read_object(node, place);
        object(place.parent).children.push_back({name, index, "", line});
        return;
    }
    if (contains(value_tags, tag)) {
        read_value(node, place);
    } else if (const auto reader = readers.find(tag); reader != readers.end()) {
        (this->*reader->second)(node, place);
    } else {
        std::vector<std::string> known = object_tags;
        known.insert(known.end(), value_tags.begin(), value_tags.end());
        known.insert(known.end(), other_tags.begin(), other_tags.end());
        throw InputError(place.xml.where(node),
                         "unknown element " + in_quotes(tag) + ", " + expected_one_of(tag, known));
    }

    // All but objects and transformations end here.
    if (tag != "transform")
        for (const pugi::xml_node child : node.children())
            if (child.type() == pugi::node_element)
                throw InputError(place.xml.where(child), "element " + in_quotes(child.name()) +
                                                             " inside of <" + tag +
                                                             ">, expected none there");
}

int DocumentReader::read_object(pugi::xml_node node, const Place &place) {
    check_attributes(node, place.xml, {"type"}, {"id", "name"});
    const SourceLocation where = place.xml.where(node);
    const std::string id = node.attribute("id").value();
    const int index = static_cast<int>(document_.objects.size());
    if (!id.empty() && !ids_.emplace(id, index).second)
        throw InputError(where, "the id " + in_quotes(id) + " is taken by " +
                                    document_.where(object(ids_.at(id))).str() +
                                    ", expected another one");
    document_.objects.push_back(
        {node.name(), node.attribute("type").value(), id, place.file, where.line, {}, {}});
    read_children(node, {place.xml, place.dialect, place.file, index});
    return index;
}

void DocumentReader::read_value(pugi::xml_node node, const Place &place) {
    const SourceLocation where = place.xml.where(node);
    const std::string name = node.attribute("name").value();
    if (name.empty())
        throw InputError(where, "<" + std::string(node.name()) +
                                    "> has no attribute \"name\", expected name=\"...\"");
    Object &parent = object(place.parent);
    const auto same = std::find_if(parent.properties.begin(), parent.properties.end(),
                                   [&](const Property &other) { return other.name == name; });
    if (same != parent.properties.end()) {
        const std::string fault =
            in_quotes(name) + " is already set in line " + std::to_string(same->line);
        if (!place.dialect.last_property_holds())
            throw InputError(where, fault + ", expected it once");
        log::warn(where, fault + ": this value holds");
        parent.properties.erase(same);
    }
    parent.properties.push_back({name, parse_value(node, place), where.line});
}

Spectrum parse_spectrum(const SourceLocation &where, const std::string &text) {
    // Either one value for all wavelengths ...
    const auto parts = split_list(text);
    if (parts.size() == 1 && parts[0].find(':') == std::string_view::npos)
        return {{}, {parse_number(where, "<spectrum>", parts[0])}};

    // ... or wavelength:value pairs.
    Spectrum spectrum;
    for (const std::string_view part : parts) {
        const std::size_t colon = part.find(':');
        if (colon == std::string_view::npos)
            throw InputError(where, "<spectrum> has " + in_quotes(part) +
                                        ", expected one value or wavelength:value pairs");
        spectrum.wavelengths.push_back(parse_number(where, "wavelength", part.substr(0, colon)));
        spectrum.values.push_back(parse_number(where, "spectrum value", part.substr(colon + 1)));
    }
    return spectrum;
}

/// One "wavelength value" pair a line; # starts a comment.
Spectrum read_spectrum_file(const std::string &path) {
    constexpr std::uintmax_t max_bytes = std::uintmax_t{16} << 20U;
    std::error_code error;
    if (std::filesystem::file_size(path, error) > max_bytes || error)
        throw InputError({path, 0}, "the file is too large, expected at most 16 MiB");
    note_input_file(path);
    std::ifstream stream(path);
    Spectrum spectrum;
    std::string text;
    for (int line = 1; std::getline(stream, text); ++line) {
        if (text.empty() || text[0] == '#' || split_list(text).empty())
            continue;
        const auto numbers = parse_numbers({path, line}, "value", text);
        if (numbers.size() != 2)
            throw InputError({path, line}, "the line has " + std::to_string(numbers.size()) +
                                               " numbers, expected a wavelength and a value");
        spectrum.wavelengths.push_back(numbers[0]);
        spectrum.values.push_back(numbers[1]);
    }
    return spectrum;
}

Spectrum parse_spectrum_element(pugi::xml_node node, const XmlFile &xml, const SourceFile &file) {
    check_attributes(node, xml, {"name"}, {"value", "filename"});
    const SourceLocation where = xml.where(node);
    const std::string value = node.attribute("value").value();
    const std::string filename = node.attribute("filename").value();
    if (value.empty() == filename.empty())
        throw InputError(where, "<spectrum> needs a value or a filename, expected one of the two");
    Spectrum spectrum = value.empty() ? read_spectrum_file(find_file(file, filename, where))
                                      : parse_spectrum(where, value);
    if (value.empty() ? spectrum.values.size() < 2
                      : spectrum.wavelengths.size() == 1 || spectrum.values.empty())
        throw InputError(where, "<spectrum> has fewer than two wavelengths, expected at least two");
    for (std::size_t i = 1; i < spectrum.wavelengths.size(); ++i)
        if (!(spectrum.wavelengths[i] > spectrum.wavelengths[i - 1]))
            throw InputError(
                where,
                "the wavelengths of <spectrum> do not ascend, expected each one once, in order");
    return spectrum;
}

Rgb parse_rgb(const SourceLocation &where, const std::string &text) {
    const std::vector<double> numbers = parse_numbers(where, "<rgb>", text);
    if (numbers.size() == 1)
        return Rgb(numbers[0]);
    if (numbers.size() == 3)
        return {numbers[0], numbers[1], numbers[2]};
    throw InputError(where,
                     "<rgb> has " + std::to_string(numbers.size()) + " numbers, expected 3 or 1");
}

PropertyValue DocumentReader::parse_value(pugi::xml_node node, const Place &place) {
    const SourceLocation where = place.xml.where(node);
    const std::string tag = node.name();
    if (tag == "transform") {
        check_attributes(node, place.xml, {"name"});
        return parse_transform(node, place.xml, parameters_);
    }
    if (tag == "spectrum")
        return parse_spectrum_element(node, place.xml, source(place.file));
    if (tag == "point" || tag == "vector") {
        if (node.attribute("value"))
            check_attributes(node, place.xml, {"name", "value"}, {"x", "y", "z"});
        else
            check_attributes(node, place.xml, {"name", "x", "y", "z"});
        return Triple{parse_triple(node, place.xml, 0)};
    }

    check_attributes(node, place.xml, {"name", "value"});
    const std::string text = node.attribute("value").value();
    const std::string what = in_quotes(node.attribute("name").value());
    if (tag == "float")
        return parse_number(where, what, text);
    if (tag == "integer")
        return parse_integer(where, what, text);
    if (tag == "boolean")
        return parse_boolean(where, what, text);
    if (tag == "rgb")
        return Colour{parse_rgb(where, text)};
    return text;
}

void DocumentReader::read_reference(pugi::xml_node node, const Place &place) {
    check_attributes(node, place.xml, {"id"}, {"name"});
    object(place.parent)
        .children.push_back({node.attribute("name").value(), none, node.attribute("id").value(),
                             place.xml.where(node).line});
}

void DocumentReader::read_alias(pugi::xml_node node, const Place &place) {
    check_attributes(node, place.xml, {"id", "as"});
    const std::string id = node.attribute("id").value();
    const std::string alias = node.attribute("as").value();
    const auto target = ids_.find(id);
    if (target == ids_.end())
        throw InputError(place.xml.where(node), "<alias> of " + in_quotes(id) +
                                                    ", expected the id of an object before it");
    if (!ids_.emplace(alias, target->second).second)
        throw InputError(place.xml.where(node),
                         "the id " + in_quotes(alias) + " is taken, expected another one");
}

void DocumentReader::read_default(pugi::xml_node node, const Place &place) {
    check_attributes(node, place.xml, {"name", "value"});
    const std::string name = node.attribute("name").value();
    if (name.empty())
        throw InputError(place.xml.where(node), "<default> with an empty name, expected a name");
    parameters_.set_default(name, node.attribute("value").value());
}

void DocumentReader::read_include(pugi::xml_node node, const Place &place) {
    check_attributes(node, place.xml, {"filename"}, {"name"});
    const SourceLocation where = place.xml.where(node);
    read_file(find_file(source(place.file), node.attribute("filename").value(), where), where,
              place.parent, node.attribute("name").value());
}

void DocumentReader::read_path(pugi::xml_node node, const Place &place) {
    check_attributes(node, place.xml, {"value"});
    SourceFile &file = source(place.file);
    const std::filesystem::path value = node.attribute("value").value();
    std::error_code ignored;
    for (const std::filesystem::path folder : file.folders)
        if (std::filesystem::is_directory(folder / value, ignored)) {
            file.folders.insert(file.folders.begin(), (folder / value).string());
            return;
        }
    throw InputError(place.xml.where(node),
                     "<path> " + quoted_path(value.string()) + " not found, expected a folder");
}

void DocumentReader::resolve_references() {
    std::vector<std::string> known;
    for (const auto &[id, unused] : ids_)
        if (known.size() < 1000)
            known.push_back(id);
    const auto resolve = [&](const Object &parent, Child &child) {
        if (child.object != none)
            return true;
        const auto target = ids_.find(child.ref_id);
        if (target != ids_.end()) {
            child.object = target->second;
            return true;
        }
        const InputError error(document_.where(parent, child.line),
                               "<ref> to the unknown id " + in_quotes(child.ref_id) + ", " +
                                   (known.empty() ? "but no object of the scene has an id"
                                                  : expected_one_of(child.ref_id, known)));
        if (!document_.all_faults)
            throw error;
        document_.faults.emplace_back(error.what());
        return false;
    };
    for (Object &parent : document_.objects) {
        auto &children = parent.children;
        children.erase(std::remove_if(children.begin(), children.end(),
                                      [&](Child &child) { return !resolve(parent, child); }),
                       children.end());
    }
}

} // namespace

std::string type_name(const PropertyValue &value) {
    constexpr std::array<const char *, std::variant_size_v<PropertyValue>> names{
        "a float", "an integer", "a boolean",  "a string",
        "a point", "an rgb",     "a spectrum", "a transform"};
    return names.at(value.index());
}

Document read_document(const std::string &path, const std::map<std::string, std::string> &defines,
                       bool all_faults) {
    return DocumentReader(defines, all_faults).read(path);
}

std::string find_file(const SourceFile &file, const std::string &name,
                      const SourceLocation &where) {
    std::vector<std::string> folders = file.folders;
    folders.emplace_back(); // as a last resort, the current folder
    for (const std::filesystem::path folder : folders) {
        const std::filesystem::path candidate = folder / name;
        std::error_code ignored;
        const auto status = std::filesystem::status(candidate, ignored);
        if (!std::filesystem::exists(status) || name.empty())
            continue;
        if (!std::filesystem::is_regular_file(status))
            throw InputError(where, quoted_path(name) + " is not a regular file, expected one");
        return candidate.string();
    }
    throw InputError(where, "the file " + quoted_path(name) +
                                " does not exist, expected one, relative to the scene's folder");
}

} // namespace clrender::mitsuba
