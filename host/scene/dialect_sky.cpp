/// The skies of Mitsuba 0.5 and 0.6 as the `sunsky` of today.

#include "../log.h"
#include "dialect_rules.h"

#include <fmt/format.h>
#include <string_view>

namespace clrender::mitsuba {

namespace {

pugi::xml_node property_of(pugi::xml_node object, const char *name) {
    return object.find_child_by_attribute("name", name);
}

void add_value(pugi::xml_node object, const char *tag, const char *name, const std::string &value,
               XmlFile &file) {
    pugi::xml_node added = file.append(object, tag, object);
    added.append_attribute("name").set_value(name);
    added.append_attribute("value").set_value(value.c_str());
}

/// `scale` is that of both; a sky has no sun, and a sun no sky.
void upgrade_scales(pugi::xml_node emitter, std::string_view type, XmlFile &file) {
    const pugi::xml_node scale = property_of(emitter, "scale");
    const std::string value = scale ? scale.attribute("value").value() : "1";
    for (const char *name : {"sky_scale", "sun_scale"}) {
        const bool is_shown = type == "sunsky" || std::string_view(name).substr(0, 3) == type;
        if (!property_of(emitter, name))
            add_value(emitter, "float", name, is_shown ? value : "0", file);
    }
    emitter.remove_child(scale);
}

/// The sun's disk, whose radius of 0 stood for a directional light: it becomes narrower than any
/// picture shows.
void upgrade_radius(pugi::xml_node emitter, XmlFile &file) {
    const pugi::xml_node radius = property_of(emitter, "sun_radius_scale");
    if (!radius)
        return;
    constexpr double degrees = 0.5358, narrow = 0.002;
    const double factor = radius.attribute("value").as_double(1);
    add_value(emitter, "float", "sun_aperture",
              fmt::format("{}", factor == 0 ? narrow : degrees * factor), file);
    emitter.remove_child(radius);
}

/// Up was +y, north -z and east +x, which are +z, -x and -y today.
void upgrade_axes(pugi::xml_node emitter, XmlFile &file) {
    pugi::xml_node transform = property_of(emitter, "to_world");
    if (!transform) {
        transform = file.append(emitter, "transform", emitter);
        transform.append_attribute("name").set_value("to_world");
    }
    file.prepend(transform, "matrix", transform)
        .append_attribute("value")
        .set_value("0 -1 0 0  0 0 1 0  1 0 0 0  0 0 0 1");
}

} // namespace

void upgrade_sky(pugi::xml_node emitter, const std::string &type, XmlFile &file) {
    if (type != "sky")
        log::warn(file.where(emitter),
                  "the sun is that of Hosek and Wilkie, as in Mitsuba 3: that of "
                  "Mitsuba 0.6 was Preetham's");
    upgrade_scales(emitter, type, file);
    upgrade_radius(emitter, file);
    upgrade_axes(emitter, file);
    if (!property_of(emitter, "albedo"))
        add_value(emitter, "float", "albedo", "0.2", file);
}

} // namespace clrender::mitsuba
