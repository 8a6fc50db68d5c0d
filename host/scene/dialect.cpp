#include "dialect.h"

#include "../log.h"
#include "dialect_rules.h"
#include "mitsuba_text.h"

#include <cctype>

namespace clrender::mitsuba {

namespace {

bool is_lower(char c) {
    return std::islower(static_cast<unsigned char>(c)) != 0;
}

bool is_upper(char c) {
    return std::isupper(static_cast<unsigned char>(c)) != 0;
}

/// "toWorld" is to_world today, and "intIOR" int_ior: a capital after a small letter begins a word,
/// which the capitals that follow belong to.
std::string in_snake_case(std::string_view name) {
    std::string result;
    for (std::size_t i = 0; i < name.size(); ++i) {
        if (i == 0 || !is_upper(name[i]) || !is_lower(name[i - 1])) {
            result += name[i];
            continue;
        }
        result += '_';
        for (; i < name.size() && is_upper(name[i]); ++i)
            result += static_cast<char>(std::tolower(static_cast<unsigned char>(name[i])));
        --i;
    }
    return result;
}

std::string_view name_of(pugi::xml_node property) {
    return property.attribute("name").value();
}

/// Elements that are a property of the object that they stand in.
bool is_property(pugi::xml_node child) {
    return child.type() == pugi::node_element && child.attribute("name") &&
           std::string_view(child.name()) != "default";
}

/// Warns of what a change leaves out, if there is something.
void say(const SourceLocation &where, const char *said) {
    if (*said != '\0')
        log::warn(where, said);
}

} // namespace

Dialect::Dialect(const XmlFile &file) : before_2_(true) {
    const pugi::xml_node root = file.root();
    const SourceLocation where = file.where(root);
    const pugi::xml_attribute attribute = root.attribute("version");
    if (!attribute) {
        log::warn(where, "<" + std::string(root.name()) +
                             "> has no version, expected version=\"3.0.0\": the names of all "
                             "versions are read");
        return;
    }
    const std::string version = attribute.value();
    const std::string major = version.substr(0, version.find('.'));
    const bool is_known = major == "0" || major == "1" || major == "2" || major == "3";
    if (version.find_first_not_of("0123456789.") != std::string::npos || !is_known)
        throw InputError(where, "version is " + in_quotes(version) + ", expected \"3.0.0\"");
    before_2_ = major == "0" || major == "1";
}

void Dialect::upgrade_tag(pugi::xml_node node, XmlFile &file) const {
    for (const TagRule *rule = tag_rules; rule->old_name != nullptr; ++rule)
        if (applies(rule->versions) && std::string_view(node.name()) == rule->old_name)
            file.rename(node, rule->name);
}

void Dialect::apply_property_rules(pugi::xml_node property, const std::string &tag,
                                   const std::string &type) const {
    for (const PropertyRule *rule = property_rules; rule->tag != nullptr; ++rule)
        if (applies(rule->versions) && tag == rule->tag && is_listed(rule->types, type) &&
            name_of(property) == rule->old_name) {
            property.attribute("name").set_value(rule->name);
            return;
        }
}

void Dialect::apply_value_rules(pugi::xml_node property, const std::string &tag,
                                const std::string &type, const XmlFile &file) const {
    const std::string value = to_lower(property.attribute("value").value());
    for (const ValueRule *rule = value_rules; rule->tag != nullptr; ++rule)
        if (applies(rule->versions) && tag == rule->tag && is_listed(rule->types, type) &&
            name_of(property) == rule->name && is_listed(rule->old_values, value)) {
            property.attribute("value").set_value(rule->value);
            say(file.where(property), rule->said);
            return;
        }
}

void Dialect::apply_dropped_rules(pugi::xml_node property, const std::string &tag,
                                  const std::string &type, const XmlFile &file) const {
    for (const DroppedRule *rule = dropped_rules; rule->tag != nullptr; ++rule) {
        if (!applies(rule->versions) || tag != rule->tag || !is_listed(rule->types, type) ||
            name_of(property) != rule->name)
            continue;
        if (!is_listed(rule->harmless, to_lower(property.attribute("value").value())))
            log::warn(file.where(property),
                      in_quotes(name_of(property)) + " is left out: " + rule->said);
        property.parent().remove_child(property);
        return;
    }
}

void Dialect::upgrade_properties(pugi::xml_node object, const std::string &type,
                                 XmlFile &file) const {
    const std::string tag = object.name();
    for (pugi::xml_node child = object.first_child(); child;) {
        const pugi::xml_node property = child;
        child = child.next_sibling(); // before the property may go
        if (!is_property(property))
            continue;
        apply_property_rules(property, tag, type);
        apply_value_rules(property, tag, type, file);
        apply_dropped_rules(property, tag, type, file);
    }
}

void Dialect::upgrade_type(pugi::xml_node object, const std::string &type,
                           const XmlFile &file) const {
    const std::string_view tag = object.name();
    for (const TypeRule *rule = type_rules; rule->tag != nullptr; ++rule)
        if (applies(rule->versions) && tag == rule->tag && type == rule->old_type) {
            say(file.where(object), rule->said);
            object.attribute("type").set_value(rule->type);
            return;
        }
}

void Dialect::upgrade(pugi::xml_node node, XmlFile &file) const {
    const std::string old_tag = node.name();
    upgrade_tag(node, file);
    if (old_tag == "transform") {
        for (const pugi::xml_node step : node.children())
            upgrade_tag(step, file);
        return;
    }
    if (old_tag == "blackbody") {
        upgrade_blackbody(node, file);
        return;
    }
    if (!node.attribute("type")) {
        upgrade_colour(node, file);
        return;
    }

    // The names of properties first, so that the rules can tell each by one name. Up to version 0.6
    // capitals in a type did not matter.
    if (before_2_)
        node.attribute("type").set_value(to_lower(node.attribute("type").value()).c_str());
    const std::string type = node.attribute("type").value();
    if (before_2_) {
        for (const pugi::xml_node child : node.children())
            if (is_property(child))
                child.attribute("name").set_value(in_snake_case(name_of(child)).c_str());
        upgrade_forms(node, old_tag, type, file);
    }
    upgrade_properties(node, type, file);
    upgrade_type(node, type, file);
}

} // namespace clrender::mitsuba
