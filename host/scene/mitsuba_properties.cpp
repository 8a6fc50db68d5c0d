#include "mitsuba_properties.h"

#include "../log.h"
#include "mitsuba_text.h"
#include "mitsuba_transform.h"
#include "unsupported.h"

#include <algorithm>
#include <cmath>

namespace clrender::mitsuba {

Properties::Properties(const Document &document, int object)
    : document_(document), object_(document.at(object)),
      used_properties_(object_.properties.size()), used_children_(object_.children.size()) {}

std::string Properties::description() const {
    return object_.tag + " " + in_quotes(object_.type);
}

SourceLocation Properties::where(const std::string &name) const {
    for (const Property &property : object_.properties)
        if (property.name == name)
            return document_.where(object_, property.line);
    for (const Child &child : object_.children)
        if (child.name == name)
            return document_.where(object_, child.line);
    return where();
}

bool Properties::has(const std::string &name) const {
    const auto is_it = [&](const auto &item) { return item.name == name; };
    return std::any_of(object_.properties.begin(), object_.properties.end(), is_it) ||
           std::any_of(object_.children.begin(), object_.children.end(), is_it);
}

const Property *Properties::find(const std::string &name) {
    known_.push_back(name);
    for (std::size_t i = 0; i < object_.properties.size(); ++i)
        if (object_.properties[i].name == name) {
            used_properties_[i] = true;
            return &object_.properties[i];
        }
    return nullptr;
}

const Child *Properties::child(const std::string &name) {
    known_.push_back(name);
    for (std::size_t i = 0; i < object_.children.size(); ++i)
        if (object_.children[i].name == name) {
            used_children_[i] = true;
            return &object_.children[i];
        }
    return nullptr;
}

std::vector<const Child *> Properties::children(const std::string &tag) {
    std::vector<const Child *> found;
    for (std::size_t i = 0; i < object_.children.size(); ++i)
        if (document_.at(object_.children[i].object).tag == tag) {
            used_children_[i] = true;
            found.push_back(&object_.children[i]);
        }
    return found;
}

template <typename T> const T *Properties::get(const std::string &name, const char *expected) {
    const Property *property = find(name);
    if (property == nullptr)
        return nullptr;
    if (const T *value = std::get_if<T>(&property->value))
        return value;
    fail(name, "is " + type_name(property->value) + ", expected " + expected);
}

std::optional<double> Properties::number(const std::string &name) {
    const Property *property = find(name);
    if (property == nullptr)
        return std::nullopt;
    if (const auto *integer = std::get_if<std::int64_t>(&property->value))
        return static_cast<double>(*integer);
    return *get<double>(name, "a float");
}

double Properties::number(const std::string &name, double fallback) {
    return number(name).value_or(fallback);
}

std::int64_t Properties::integer(const std::string &name, std::int64_t fallback,
                                 std::int64_t lowest, std::int64_t highest) {
    const auto *stated = get<std::int64_t>(name, "an integer");
    const std::int64_t value = stated != nullptr ? *stated : fallback;
    if (value < lowest || value > highest)
        fail(name, "is " + std::to_string(value) + ", expected " + std::to_string(lowest) + " to " +
                       std::to_string(highest));
    return value;
}

bool Properties::boolean(const std::string &name, bool fallback) {
    const bool *value = get<bool>(name, "a boolean");
    return value != nullptr ? *value : fallback;
}

std::optional<std::string> Properties::string(const std::string &name) {
    const auto *value = get<std::string>(name, "a string");
    return value != nullptr ? std::optional(*value) : std::nullopt;
}

std::size_t Properties::choice(const std::string &name, std::size_t fallback,
                               const std::vector<std::string> &choices) {
    const auto stated = string(name);
    if (!stated)
        return fallback;
    const auto found = std::find(choices.begin(), choices.end(), to_lower(*stated));
    if (found == choices.end())
        fail(name, "is " + in_quotes(*stated) + ", " + expected_one_of(*stated, choices));
    return static_cast<std::size_t>(found - choices.begin());
}

std::optional<glm::dvec3> Properties::point(const std::string &name) {
    const auto *triple = get<Triple>(name, "a point");
    return triple != nullptr ? std::optional(triple->value) : std::nullopt;
}

glm::dmat4 Properties::transform(const std::string &name) {
    const auto *matrix = get<glm::dmat4>(name, "a transform");
    if (matrix == nullptr)
        return glm::dmat4(1);
    if (is_singular(glm::dmat3(*matrix)))
        fail(name, "is singular, expected an invertible transformation");
    return *matrix;
}

glm::dmat3 Properties::uv_transform(const std::string &name) {
    const auto *stated = get<glm::dmat4>(name, "a transform");
    const glm::dmat4 m = stated != nullptr ? *stated : glm::dmat4(1);
    const glm::dmat3 matrix(m[0][0], m[0][1], m[0][3], m[1][0], m[1][1], m[1][3], m[3][0], m[3][1],
                            m[3][3]);
    if (!(std::abs(m[0][0] * m[1][1] - m[0][1] * m[1][0]) > 0))
        fail(name, "is singular, expected an invertible transformation of u and v");
    return matrix;
}

std::string Properties::file(const std::string &name) {
    const auto filename = string(name);
    if (!filename)
        throw InputError(where(), description() + " has no " + in_quotes(name) +
                                      ", expected a <string name=\"" + name + "\">");
    return find_file(document_.files.at(static_cast<std::size_t>(object_.file)), *filename,
                     where(name));
}

void Properties::ignore(const std::vector<std::string> &names) {
    for (const std::string &name : names)
        if (find(name) != nullptr)
            tell_ignored(name);
}

void Properties::tell_ignored(const std::string &name) const {
    const std::string text = where(name).str() + ": " + in_quotes(name) + " of " + description() +
                             " does not change the picture";
    if (document_.all_faults)
        log::info(text);
    else
        log::detail(text);
}

void Properties::ignore_rest() {
    for (std::size_t i = 0; i < used_properties_.size(); ++i) {
        const Property &property = object_.properties[i];
        if (used_properties_[i] || is_misspelt(property.name, known_))
            continue;
        used_properties_[i] = true;
        tell_ignored(property.name);
    }
    std::fill(used_children_.begin(), used_children_.end(), true);
}

std::string Properties::fault_of(const Child &child, const std::vector<std::string> &known) const {
    const Object &target = document_.at(child.object);
    const std::string what = target.tag + " " + in_quotes(target.type) +
                             (child.name.empty() ? "" : " named " + in_quotes(child.name));
    if (const std::string nearest = nearest_supported(target.tag, target.type);
        !nearest.empty() && (target.tag == "medium" || target.tag == "subsurface"))
        return what + " in " + description() + " is not supported, the nearest that is: " + nearest;
    return description() + " has the unexpected child " + what + ", " +
           expected_one_of(child.name, known);
}

void Properties::finish() const {
    std::vector<std::string> known = known_;
    std::sort(known.begin(), known.end());
    known.erase(std::unique(known.begin(), known.end()), known.end());
    std::vector<std::string> faults;
    for (std::size_t i = 0; i < used_properties_.size(); ++i)
        if (!used_properties_[i]) {
            const Property &property = object_.properties[i];
            faults.push_back(document_.where(object_, property.line).str() + ": " + description() +
                             " has the unknown property " + in_quotes(property.name) + ", " +
                             expected_one_of(property.name, known));
        }
    for (std::size_t i = 0; i < used_children_.size(); ++i)
        if (!used_children_[i]) {
            const Child &child = object_.children[i];
            faults.push_back(document_.where(object_, child.line).str() + ": " +
                             fault_of(child, known));
        }
    if (faults.empty())
        return;
    if (!document_.all_faults)
        faults.resize(1);
    throw InputError(faults);
}

void Properties::fail(const std::string &name, const std::string &what) const {
    throw InputError(where(name), description() + ": " + in_quotes(name) + " " + what);
}

void fail_unsupported(const Document &document, const Object &object,
                      const std::vector<std::string> &types) {
    const SourceLocation where = document.where(object);
    if (const std::string nearest = nearest_supported(object.tag, object.type); !nearest.empty())
        throw UnsupportedError(where, object.tag + " " + in_quotes(object.type) +
                                          " is not supported, the nearest that is: " + nearest);
    throw UnsupportedError(where, object.tag + " of type " + in_quotes(object.type) +
                                      " is not supported, " + expected_one_of(object.type, types));
}

} // namespace clrender::mitsuba
