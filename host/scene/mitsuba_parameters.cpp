#include "mitsuba_parameters.h"

#include "mitsuba_text.h"

#include <algorithm>
#include <cctype>

namespace clrender::mitsuba {

namespace {

/// Defaults may contain other parameters, so a short file could make a text without end.
constexpr std::size_t longest_attribute = std::size_t{1} << 20U;

std::string name_at(const std::string &text, std::size_t begin) {
    std::size_t end = begin;
    while (end < text.size() &&
           (std::isalnum(static_cast<unsigned char>(text[end])) != 0 || text[end] == '_'))
        ++end;
    return text.substr(begin, end - begin);
}

} // namespace

Parameters::Parameters(const std::map<std::string, std::string> &defines) {
    for (const auto &[name, value] : defines)
        parameters_.push_back({name, value, false});
    std::stable_sort(parameters_.begin(), parameters_.end(),
                     [](const auto &a, const auto &b) { return a.name.size() > b.name.size(); });
}

void Parameters::set_default(const std::string &name, const std::string &value) {
    for (Parameter &parameter : parameters_)
        if (parameter.name == name) {
            parameter.used = true;
            return;
        }
    const auto shorter =
        std::find_if(parameters_.begin(), parameters_.end(),
                     [&](const auto &parameter) { return parameter.name.size() < name.size(); });
    parameters_.insert(shorter, {name, value, true});
}

void Parameters::substitute(pugi::xml_node node, const XmlFile &file) {
    for (pugi::xml_attribute attribute : node.attributes()) {
        const std::string text = attribute.value();
        if (text.find('$') != std::string::npos)
            attribute.set_value(substituted(text, file.where(node)).c_str());
    }
}

std::string Parameters::substituted(const std::string &text, const SourceLocation &where) {
    std::string result;
    for (std::size_t at = 0; at < text.size();) {
        // An escaped dollar sign loses its backslash; everything but a dollar sign is copied.
        if (text.compare(at, 2, "\\$") == 0) {
            result += '$';
            at += 2;
            continue;
        }
        if (text[at] != '$') {
            result += text[at++];
            continue;
        }

        const auto found =
            std::find_if(parameters_.begin(), parameters_.end(), [&](const auto &parameter) {
                return text.compare(at + 1, parameter.name.size(), parameter.name) == 0;
            });
        if (found == parameters_.end())
            throw InputError(where, "nothing defines the parameter " +
                                        in_quotes("$" + name_at(text, at + 1)) +
                                        ", expected a <default> before it or -D name=value");
        found->used = true;
        result += found->value;
        at += 1 + found->name.size();
        if (result.size() > longest_attribute)
            throw InputError(where, "a value grows too long by its parameters, expected at most "
                                    "1 MiB");
    }
    return result;
}

std::vector<std::string> Parameters::unused_defines() const {
    std::vector<std::string> names;
    for (const Parameter &parameter : parameters_)
        if (!parameter.used)
            names.push_back(parameter.name);
    return names;
}

} // namespace clrender::mitsuba
