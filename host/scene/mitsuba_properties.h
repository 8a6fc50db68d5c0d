#pragma once
/// Typed look-up of what a scene file says about one object; whatever nobody asked for is an error.

#include "mitsuba_document.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace clrender::mitsuba {

/// What Mitsuba knows and clrender does not (yet): an error only where a picture needs it.
class UnsupportedError : public InputError {
public:
    UnsupportedError(const SourceLocation &where, const std::string &what)
        : InputError(where, what), where_(where), fault_(what) {}

    /// What the line says, and its place.
    [[nodiscard]] const SourceLocation &where() const { return where_; }
    [[nodiscard]] const std::string &fault() const { return fault_; }

private:
    SourceLocation where_;
    std::string fault_;
};

/// All look-ups throw InputError at the line of a value that has the wrong type or size.
class Properties {
public:
    Properties(const Document &document, int object);

    [[nodiscard]] const Object &object() const { return object_; }
    [[nodiscard]] const Document &document() const { return document_; }
    /// `shape "sphere"`, for messages.
    [[nodiscard]] std::string description() const;
    [[nodiscard]] SourceLocation where() const { return document_.where(object_); }
    /// The line of a value or child, of the object itself if it is not stated.
    [[nodiscard]] SourceLocation where(const std::string &name) const;
    [[nodiscard]] bool has(const std::string &name) const;

    /// Integers also count as numbers.
    std::optional<double> number(const std::string &name);
    double number(const std::string &name, double fallback);
    std::int64_t integer(const std::string &name, std::int64_t fallback, std::int64_t lowest,
                         std::int64_t highest);
    bool boolean(const std::string &name, bool fallback);
    std::optional<std::string> string(const std::string &name);
    /// One of `choices`, by its index.
    std::size_t choice(const std::string &name, std::size_t fallback,
                       const std::vector<std::string> &choices);
    std::optional<glm::dvec3> point(const std::string &name);
    /// An invertible transformation.
    glm::dmat4 transform(const std::string &name);
    /// The 3x3 part that acts on texture coordinates (its third row and column are not used).
    glm::dmat3 uv_transform(const std::string &name);
    /// The file that a string names.
    std::string file(const std::string &name);

    /// A value of any type, or null.
    const Property *find(const std::string &name);
    /// The child with this name, or null.
    const Child *child(const std::string &name);
    /// All children with this tag, whatever their names.
    std::vector<const Child *> children(const std::string &tag);

    /// Accepts values that cannot change the picture; told of where all faults are asked for.
    void ignore(const std::vector<std::string> &names);
    /// Accepts all that has not been asked for likewise, but for what is probably a known name
    /// written wrong.
    void ignore_rest();

    /// Throws InputError if there is a value or child that nobody asked for; with a line for each
    /// if all faults are asked for.
    void finish() const;

    /// Throws InputError about `name`: "shape "sphere": radius is -1, expected ...".
    [[noreturn]] void fail(const std::string &name, const std::string &what) const;

private:
    [[nodiscard]] std::string fault_of(const Child &child,
                                       const std::vector<std::string> &known) const;
    void tell_ignored(const std::string &name) const;
    template <typename T> const T *get(const std::string &name, const char *expected);

    const Document &document_;
    const Object &object_;
    std::vector<bool> used_properties_, used_children_;
    std::vector<std::string> known_;
};

/// Reports a plugin type that is not among `types`.
[[noreturn]] void fail_unsupported(const Document &document, const Object &object,
                                   const std::vector<std::string> &types);

} // namespace clrender::mitsuba
