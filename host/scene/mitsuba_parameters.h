#pragma once
/// The $parameters of a scene file.

#include "xml_file.h"

#include <map>
#include <string>
#include <vector>

namespace clrender::mitsuba {

class Parameters {
public:
    explicit Parameters(const std::map<std::string, std::string> &defines);

    /// <default>: gives `name` a value unless it has one.
    void set_default(const std::string &name, const std::string &value);

    /// Replaces each $name in the attributes of `node` in place. As in Mitsuba, the longest known
    /// name that fits is taken, "\$" is a dollar sign, and an unknown name is an error.
    void substitute(pugi::xml_node node, const XmlFile &file);

    /// The defines that met neither a <default> nor a $name.
    [[nodiscard]] std::vector<std::string> unused_defines() const;

private:
    struct Parameter {
        std::string name, value;
        bool used;
    };

    [[nodiscard]] std::string substituted(const std::string &text, const SourceLocation &where);

    std::vector<Parameter> parameters_; ///< longest name first
};

} // namespace clrender::mitsuba
