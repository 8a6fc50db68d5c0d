#include "mesh_attributes.h"

#include "../image/image.h"
#include "../log.h"
#include "obj_lines.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace clrender {

namespace {

/// The letters that properties of one attribute end in, one row for each way to count.
constexpr std::array<std::string_view, 4> suffixes{"xyzw", "rgba", "0123", "1234"};
constexpr std::size_t suffixes_of_colors = 1;

/// The largest number of an integer type, 0 for floats.
double whole_of(PlyType type) {
    switch (type) {
    case PlyType::int8:
        return 0x7f;
    case PlyType::uint8:
        return 0xff;
    case PlyType::int16:
        return 0x7fff;
    case PlyType::uint16:
        return 0xffff;
    case PlyType::int32:
        return 0x7fffffff;
    case PlyType::uint32:
        return 0xffffffff;
    case PlyType::float32:
    case PlyType::float64:
        break;
    }
    return 0;
}

std::optional<std::size_t> find_property(const PlyElement &element, std::string_view name) {
    for (std::size_t i = 0; i < element.properties.size(); ++i)
        if (element.properties[i].name == name && !element.properties[i].is_list)
            return i;
    return std::nullopt;
}

/// A property's name as that of an attribute and a suffix of one letter.
struct SplitName {
    std::string_view name;
    char suffix;
};

std::optional<SplitName> split_name(const PlyProperty &property) {
    const std::string_view text = property.name;
    if (property.is_list || text.size() < 3 || text[text.size() - 2] != '_')
        return std::nullopt;
    return SplitName{text.substr(0, text.size() - 2), text.back()};
}

} // namespace

bool is_face_attribute(const std::string &name) {
    return name.starts_with("face_");
}

PlyAttributes::PlyAttributes(const PlyElement &element, const std::string &prefix,
                             const std::set<std::string> &wanted, const std::string &path) {
    if (wanted.empty())
        return;
    places_.resize(element.properties.size());
    add_colors(element, prefix, wanted, path);
    add_runs(element, prefix, wanted);
    const bool any = std::any_of(places_.begin(), places_.end(),
                                 [](const Place &place) { return place.attribute != none; });
    if (!any)
        places_.clear();
}

void PlyAttributes::add(const std::string &name, const PlyElement &element,
                        const std::vector<std::size_t> &properties,
                        const std::set<std::string> &wanted) {
    if (std::any_of(attributes_.begin(), attributes_.end(),
                    [&](const MeshAttribute &other) { return other.name == name; }))
        return;
    MeshAttribute attribute;
    attribute.name = name;
    attribute.channels = properties.size();
    attribute.whole = whole_of(element.properties[properties[0]].type);
    if (wanted.count(name) != 0)
        for (std::size_t c = 0; c < properties.size(); ++c)
            places_[properties[c]] = {static_cast<int>(attributes_.size()), c};
    attributes_.push_back(std::move(attribute));
    element_.emplace_back();
}

void PlyAttributes::add_colors(const PlyElement &element, const std::string &prefix,
                               const std::set<std::string> &wanted, const std::string &path) {
    for (const auto &names :
         {std::array{"r", "g", "b", "a"}, std::array{"red", "green", "blue", "alpha"}}) {
        std::vector<std::size_t> properties;
        for (std::size_t c = 0; c < 3; ++c)
            if (const auto found = find_property(element, names[c]))
                properties.push_back(*found);
        if (properties.size() != 3)
            continue;
        const std::string name = prefix + "color";
        add(name, element, properties, wanted);
        if (wanted.count(name) != 0 && find_property(element, names[3]))
            log::warn(SourceLocation{path, element.line}, std::string("the property ") + names[3] +
                                                              " of the attribute " + name +
                                                              " is ignored");
        return;
    }
}

void PlyAttributes::add_runs(const PlyElement &element, const std::string &prefix,
                             const std::set<std::string> &wanted) {
    const auto &all = element.properties;
    for (std::size_t first = 0; first < all.size();) {
        const auto begin = split_name(all[first]);
        std::vector<std::size_t> run;
        for (std::size_t i = first; begin && i < all.size(); ++i) {
            const auto next = split_name(all[i]);
            if (!next || next->name != begin->name)
                break;
            run.push_back(i);
        }
        first += std::max<std::size_t>(run.size(), 1);
        if (run.size() != 1 && run.size() != 3)
            continue;
        for (std::size_t row = 0; row < suffixes.size(); ++row) {
            const bool fits = std::all_of(run.begin(), run.end(), [&](std::size_t i) {
                return all[i].name.back() == suffixes[row][i - run[0]];
            });
            if (!fits)
                continue;
            add(prefix + std::string(begin->name) + (row == suffixes_of_colors ? "_color" : ""),
                element, run, wanted);
            break;
        }
    }
}

void PlyAttributes::set(std::size_t property, double value) {
    const Place &place = places_[property];
    element_[static_cast<std::size_t>(place.attribute)][place.channel] = static_cast<float>(value);
}

void PlyAttributes::finish_element() {
    if (places_.empty())
        return;
    std::vector<bool> done(attributes_.size());
    for (const Place &place : places_) {
        const auto i = static_cast<std::size_t>(place.attribute);
        if (place.attribute == none || done[i])
            continue;
        done[i] = true;
        MeshAttribute &attribute = attributes_[i];
        attribute.values.insert(attribute.values.end(), element_[i].begin(),
                                element_[i].begin() +
                                    static_cast<std::ptrdiff_t>(attribute.channels));
    }
}

std::uint64_t PlyAttributes::bytes(std::uint64_t elements) const {
    const auto channels = std::count_if(places_.begin(), places_.end(),
                                        [](const Place &place) { return place.attribute != none; });
    return elements * static_cast<std::uint64_t>(channels) * sizeof(float);
}

void PlyAttributes::move_to(Mesh &mesh, const std::vector<std::uint32_t> *element_of) {
    for (MeshAttribute &attribute : attributes_) {
        if (element_of != nullptr && !attribute.values.empty()) {
            std::vector<float> values;
            values.reserve(element_of->size() * attribute.channels);
            for (const std::uint32_t element : *element_of)
                for (std::size_t c = 0; c < attribute.channels; ++c)
                    values.push_back(attribute.values[element * attribute.channels + c]);
            attribute.values = std::move(values);
        }
        mesh.attributes.push_back(std::move(attribute));
    }
    attributes_.clear();
}

const MeshAttribute *find_attribute(const Mesh &mesh, const std::string &name) {
    for (const MeshAttribute &attribute : mesh.attributes)
        if (attribute.name == name)
            return &attribute;
    return nullptr;
}

double largest_value(const MeshAttribute &attribute) {
    const auto largest = std::max_element(attribute.values.begin(), attribute.values.end());
    return largest == attribute.values.end() ? 0 : double{*largest};
}

void decode_colors(MeshAttribute &attribute) {
    const double unit = attribute.whole > 0 ? attribute.whole : 1;
    for (float &value : attribute.values)
        value = static_cast<float>(srgb_decode(std::clamp(value / unit, 0.0, 1.0)));
    attribute.whole = 0;
}

} // namespace clrender
