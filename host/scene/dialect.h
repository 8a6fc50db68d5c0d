#pragma once
/// The dialects of scene files. Names that other versions of Mitsuba have become today's while the
/// document is read, so that all other readers know today's only. dialect_rules.cpp has the table.

#include "dialect_rules.h"
#include "xml_file.h"

#include <string>

namespace clrender::mitsuba {

/// How a file has to be read, by the version that its root element states.
class Dialect {
public:
    /// Throws InputError if the version is none of Mitsuba's. A file without one may have the names
    /// of any version, which is warned of.
    explicit Dialect(const XmlFile &file);

    /// Gives an element, whose own parameters are substituted, its form of today: its name, what
    /// its properties are called, and colours. What has no successor of the same meaning is warned
    /// of. Throws InputError for a colour that is none.
    void upgrade(pugi::xml_node node, XmlFile &file) const;

    /// Whether a property may be set twice, as Mitsuba let it up to version 0.6: the last one
    /// holds.
    [[nodiscard]] bool last_property_holds() const { return before_2_; }

private:
    [[nodiscard]] bool applies(Versions versions) const {
        return before_2_ || versions == Versions::all;
    }
    void upgrade_tag(pugi::xml_node node, XmlFile &file) const;
    void upgrade_properties(pugi::xml_node object, const std::string &type, XmlFile &file) const;
    void apply_property_rules(pugi::xml_node property, const std::string &tag,
                              const std::string &type) const;
    void apply_value_rules(pugi::xml_node property, const std::string &tag, const std::string &type,
                           const XmlFile &file) const;
    void apply_dropped_rules(pugi::xml_node property, const std::string &tag,
                             const std::string &type, const XmlFile &file) const;
    void upgrade_type(pugi::xml_node object, const std::string &type, const XmlFile &file) const;

    bool before_2_; ///< names are in camelCase, as Mitsuba had them up to version 0.6
};

} // namespace clrender::mitsuba
