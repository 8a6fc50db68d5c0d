#pragma once
/// The table of names that have changed, and the upgrades that are more than a name. Sources: the
/// style sheets upgrade_0.3.0.xsl to upgrade_0.6.0.xsl of Mitsuba 0.6, the manuals of Mitsuba 0.6
/// and 3, and the upgrade that Mitsuba 3 makes of files of versions below 2.

#include "xml_file.h"

#include <string>
#include <string_view>

namespace clrender::mitsuba {

enum class Versions { all, before_2 };

/// Whether `word` is one of the words or numbers of `list`, which are separated by blanks; "*" has
/// all.
bool is_listed(std::string_view list, std::string_view word);

/// <camera> is <sensor> today.
struct TagRule {
    Versions versions;
    const char *old_name, *name;
};

/// <film type="ldrfilm"> is <film type="hdrfilm"> today.
struct TypeRule {
    Versions versions;
    const char *tag, *old_type, *type;
    const char *said; ///< what the change leaves out, for a warning, or ""
};

/// What is called `old_name` in an object of one of `types` is called `name` today.
struct PropertyRule {
    Versions versions;
    const char *tag, *types, *old_name, *name;
};

/// A string that is one of `old_values` is `value` today.
struct ValueRule {
    Versions versions;
    const char *tag, *types, *name, *old_values, *value;
    const char *said;
};

/// Values that have no successor: removed, with a warning if the picture depends on it.
struct DroppedRule {
    Versions versions;
    const char *tag, *types, *name;
    const char *harmless; ///< values that leave the picture as it is, as a list
    const char *said;     ///< why another value is left out
};

/// The tables; each ends with a row of null pointers.
extern const TagRule tag_rules[];
extern const TypeRule type_rules[];
extern const PropertyRule property_rules[];
extern const ValueRule value_rules[];
extern const DroppedRule dropped_rules[];

/// Upgrades of an object before version 2 that are more than other names. Its properties' names
/// are in snake case; `tag` and `type` are what the file calls it.
void upgrade_forms(pugi::xml_node object, const std::string &tag, const std::string &type,
                   XmlFile &file);

/// Makes an emitter of type `sky`, `sun` or `sunsky` before version 2 what `sunsky` is today: its
/// properties and its axes (dialect_sky.cpp).
void upgrade_sky(pugi::xml_node emitter, const std::string &type, XmlFile &file);

/// Makes <srgb>, hexadecimal colours, and spectra of three numbers an <rgb>. Throws InputError.
void upgrade_colour(pugi::xml_node value, XmlFile &file);

/// Makes <blackbody temperature="5000K"> a <spectrum type="blackbody">.
void upgrade_blackbody(pugi::xml_node value, XmlFile &file);

} // namespace clrender::mitsuba
