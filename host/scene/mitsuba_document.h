#pragma once
/// A Mitsuba scene file as the tree of objects that it describes: includes, defaults, references
/// and transformations are resolved, values are parsed, nothing is interpreted yet.

#include "scene.h"
#include "spectrum.h"

#include <cstdint>
#include <map>
#include <string>
#include <variant>
#include <vector>

namespace clrender::mitsuba {

struct Triple {
    glm::dvec3 value; ///< of a <point> or <vector>
};

struct Colour {
    Rgb value; ///< of an <rgb>
};

using PropertyValue =
    std::variant<double, std::int64_t, bool, std::string, Triple, Colour, Spectrum, glm::dmat4>;

/// What an element with such a value is called.
std::string type_name(const PropertyValue &value);

struct Property {
    std::string name;
    PropertyValue value;
    int line;
};

/// An object inside of another, written there or referred to.
struct Child {
    std::string name;   ///< "" if none was given
    int object;         ///< index
    std::string ref_id; ///< "" if written in place
    int line;
};

/// <shape type="sphere" id="ball">: tag, type, id.
struct Object {
    std::string tag, type, id;
    int file;
    int line;
    std::vector<Property> properties;
    std::vector<Child> children;
};

struct SourceFile {
    std::string path;
    std::vector<std::string> folders; ///< where relative names are looked up, first hit wins
};

struct Document {
    std::vector<Object> objects; ///< the first one is the scene
    std::vector<SourceFile> files;
    bool all_faults = false;         ///< faults do not end the reading where it can go on
    std::vector<std::string> faults; ///< lines, of those that have not ended it

    [[nodiscard]] const Object &at(int index) const {
        return objects.at(static_cast<std::size_t>(index));
    }
    [[nodiscard]] SourceLocation where(const Object &object, int line) const {
        return {files.at(static_cast<std::size_t>(object.file)).path, line};
    }
    [[nodiscard]] SourceLocation where(const Object &object) const {
        return where(object, object.line);
    }
};

/// Reads `path` with all that it includes. `defines` win over <default>; a define that nothing
/// uses is warned of. Throws InputError, with `all_faults` only for what leaves no document.
Document read_document(const std::string &path, const std::map<std::string, std::string> &defines,
                       bool all_faults = false);

/// The regular file that `name` stands for in `file`. Throws InputError at `where` if there is
/// none.
std::string find_file(const SourceFile &file, const std::string &name, const SourceLocation &where);

} // namespace clrender::mitsuba
