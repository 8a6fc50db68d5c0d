#include "scene/mesh_attributes.h"
#include "shape_parts.h"

#include <set>
#include <string>
#include <vector>

namespace clrender::inline CLR_PRECISION {

namespace {

const Texture &texture_of(const Flattening &work, int texture) {
    return work.scene.textures[static_cast<std::size_t>(texture)];
}

/// A value of an attribute; numbers give the same for all channels.
glm::dvec3 value_of(const MeshAttribute &attribute, std::size_t index) {
    const float *value = &attribute.values[index * attribute.channels];
    return attribute.channels == 1 ? glm::dvec3(value[0])
                                   : glm::dvec3(value[0], value[1], value[2]);
}

/// The attributes that a texture shows.
std::vector<std::string> names_of(const Texture &texture) {
    std::vector<std::string> names;
    for (const std::string &name : {texture.attribute, texture.product, texture.coordinates})
        if (!name.empty())
            names.push_back(name);
    return names;
}

void append(const glm::dvec3 &value, FlatScene &flat) {
    for (int c = 0; c < 3; ++c)
        flat.attributes.push_back(static_cast<clr_real>(value[c]));
}

void append_values(const MeshAttribute &attribute, const PlacedMesh &placed, FlatScene &flat) {
    if (is_face_attribute(attribute.name)) {
        for (const std::uint32_t triangle : placed.sources)
            append(value_of(attribute, triangle), flat);
        return;
    }
    for (std::size_t i = 0; i < attribute.values.size() / attribute.channels; ++i)
        append(value_of(attribute, i), flat);
    for (const auto &[parent, w] : placed.added)
        append(value_of(attribute, parent[0]) * w.x + value_of(attribute, parent[1]) * w.y +
                   value_of(attribute, parent[2]) * w.z,
               flat);
}

} // namespace

void number_attributes(Flattening &work) {
    const auto take = [&](const std::vector<Shape> &shapes) {
        for (const Shape &shape : shapes)
            for (const int texture : shape.attribute_textures)
                for (const std::string &name : names_of(texture_of(work, texture)))
                    work.attribute_index.try_emplace(
                        name, static_cast<uint>(work.attribute_index.size()));
    };
    take(work.scene.shapes);
    for (const ShapeGroup &group : work.scene.groups)
        take(group.shapes);
}

void append_attributes(const Shape &shape, const PlacedMesh &placed, Flattening &work) {
    std::set<std::string> names;
    for (const int texture : shape.attribute_textures)
        for (const std::string &name : names_of(texture_of(work, texture)))
            names.insert(name);
    for (const std::string &name : names) {
        const MeshAttribute *attribute = find_attribute(*shape.mesh, name);
        if (attribute == nullptr)
            continue;
        const uint first = is_face_attribute(name) ? placed.first_triangle : placed.first_vertex;
        work.flat.attribute_places[placed.shape * work.attribute_index.size() +
                                   work.attribute_index.at(name)] =
            static_cast<uint>(work.flat.attributes.size() / 3) - first;
        append_values(*attribute, placed, work.flat);
    }
}

} // namespace clrender::inline CLR_PRECISION
