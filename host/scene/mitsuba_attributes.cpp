/// Textures that show attributes of meshes.

#include "../log.h"
#include "mesh_attributes.h"
#include "mitsuba_scene.h"
#include "mitsuba_text.h"
#include "scene/limits.h"

#include <fmt/format.h>

#include <algorithm>

namespace clrender::mitsuba {

namespace {

/// The objects among those that `object` holds, at any depth, that are such textures.
void find_textures(const Document &document, int object, std::set<int> &seen,
                   std::vector<int> &found) {
    if (!seen.insert(object).second)
        return;
    const Object &at = document.at(object);
    if (at.tag == "texture" && at.type == "mesh_attribute")
        found.push_back(object);
    for (const Child &child : at.children)
        find_textures(document, child.object, seen, found);
}

std::string names_of(const Mesh &mesh) {
    std::string names;
    for (const MeshAttribute &attribute : mesh.attributes)
        names += (names.empty() ? "" : ", ") + in_quotes(attribute.name);
    return names.empty() ? "a mesh that has attributes" : "one that it has: " + names;
}

/// Whether the mesh has what the texture shows, as a texture can show it.
void check_attribute(const Mesh &mesh, const Texture &texture, SpectrumUse use,
                     const SourceLocation &where, const std::string &shape) {
    const std::string subject = "texture \"mesh_attribute\": " + in_quotes(texture.attribute);
    const MeshAttribute *attribute = find_attribute(mesh, texture.attribute);
    if (attribute == nullptr)
        throw InputError(where, subject + " is no attribute of the " + shape + ", expected " +
                                    names_of(mesh));
    if (texture.is_number && attribute->channels != 1)
        throw InputError(where, subject + " of the " + shape +
                                    " has 3 channels where a number is asked for, expected 1");
    const double largest = largest_value(*attribute) * texture.scale.r;
    if (largest > max_radiance)
        throw InputError(where,
                         fmt::format("{} of the {} is too large, expected no value above {:g}",
                                     subject, shape, max_radiance));
    const auto negative = std::count_if(attribute->values.begin(), attribute->values.end(),
                                        [](float value) { return value < 0; });
    if (negative > 0)
        throw InputError(where, subject + " of the " + shape +
                                    " has negative values, expected none below 0");
    constexpr double rounding = 1e-4;
    if (use == SpectrumUse::reflectance && largest > 1 + rounding)
        log::warn(where,
                  fmt::format("{} of the {} goes up to {:g}: the surface gives more light "
                              "than it gets{}",
                              subject, shape, largest,
                              attribute->whole > 0
                                  ? fmt::format(" (integers are taken as they are; \"scale\" "
                                                "{:.6g} takes them to 1)",
                                                1 / attribute->whole)
                                  : ""));
}

} // namespace

int SceneReader::read_mesh_attribute(Properties &properties) {
    Texture texture;
    texture.kind = TextureKind::attribute;
    const auto name = properties.string("name");
    if (!name || (!name->starts_with("vertex_") && !name->starts_with("face_")))
        properties.fail("name", (name ? "is " + in_quotes(*name) : std::string("is missing")) +
                                    ", expected the name of an attribute, which begins with "
                                    "\"vertex_\" or \"face_\"");
    texture.attribute = *name;
    const double scale = properties.number("scale", 1);
    texture.scale = Rgb(scale);
    if (!(scale >= 0 && scale <= max_radiance))
        properties.fail(
            "scale", fmt::format("is {:g}, expected a number from 0 to {:g}", scale, max_radiance));
    files_.want_attribute(texture.attribute);
    scene_.textures.push_back(std::move(texture));
    return static_cast<int>(scene_.textures.size()) - 1;
}

void SceneReader::read_attributes_of(int object, Shape &shape) {
    std::set<int> seen;
    std::vector<int> found;
    find_textures(document_, object, seen, found);
    for (const int texture : found) {
        const SourceLocation where = document_.where(document_.at(texture));
        const std::string name =
            "shape " + in_quotes(document_.at(object).type) +
            (shape.where.line > 0 ? " of line " + std::to_string(shape.where.line) : "");
        for (auto known = textures_.lower_bound({texture, SpectrumUse{}});
             known != textures_.end() && known->first.first == texture; ++known) {
            const auto &[key, index] = *known;
            if (!shape.mesh) {
                const Texture &shown = scene_.textures.at(static_cast<std::size_t>(index));
                throw InputError(where, "texture \"mesh_attribute\": the " + name +
                                            " has no attributes, expected a mesh with " +
                                            in_quotes(shown.attribute));
            }
            shape.attribute_textures.push_back(index);
            files_.then([this, mesh = shape.mesh, index = index, use = key.second, where, name] {
                check_attribute(*mesh, scene_.textures.at(static_cast<std::size_t>(index)), use,
                                where, name);
            });
        }
    }
}

} // namespace clrender::mitsuba
