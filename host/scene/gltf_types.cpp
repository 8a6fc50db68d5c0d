#include "gltf_types.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

namespace clrender::gltf {

namespace {

using nlohmann::json;

enum class Type {
    index, ///< of an element of the file, or a constant
    size,  ///< whole, of bytes or elements
    number,
    numbers, ///< an array of so many
    indices, ///< an array
    object,
    objects, ///< an array
    text,
    flag,
};

struct Member {
    const char *name;
    Type type;
    std::size_t count = 0; ///< of numbers; 0: any
};

using Members = std::vector<Member>;

bool is_index(const json &value) {
    return value.is_number_integer() &&
           (!value.is_number_unsigned() ||
            value.get<std::uint64_t>() <= std::numeric_limits<int>::max()) &&
           value.get<std::int64_t>() >= std::numeric_limits<int>::min();
}

template <typename Test> bool is_array_of(const json &value, const Test &test) {
    return value.is_array() && std::all_of(value.begin(), value.end(), test);
}

bool fits(const json &value, const Member &member) {
    switch (member.type) {
    case Type::index:
        return is_index(value) && value.get<int>() >= 0;
    case Type::size:
        return value.is_number_unsigned();
    case Type::number:
        return value.is_number();
    case Type::numbers:
        return is_array_of(value, [](const json &v) { return v.is_number(); }) &&
               (member.count == 0 || value.size() == member.count);
    case Type::indices:
        return is_array_of(value, is_index);
    case Type::object:
        return value.is_object();
    case Type::objects:
        return is_array_of(value, [](const json &v) { return v.is_object(); });
    case Type::text:
        return value.is_string();
    case Type::flag:
        return value.is_boolean();
    }
    return false;
}

std::string expected(const Member &member) {
    switch (member.type) {
    case Type::index:
    case Type::size:
        return "a whole number from 0 on";
    case Type::number:
        return "a number";
    case Type::numbers:
        return member.count == 0 ? "an array of numbers"
                                 : fmt::format("an array of {} numbers", member.count);
    case Type::indices:
        return "an array of whole numbers";
    case Type::object:
        return "an object";
    case Type::objects:
        return "an array of objects";
    case Type::text:
        return "a string";
    case Type::flag:
        return "true or false";
    }
    return {};
}

class TypeChecker {
public:
    explicit TypeChecker(const Document &document) : document_(document) {}

    void check(const json &object, const std::string &place, const Members &members) const {
        for (const Member &member : members)
            if (const auto found = object.find(member.name);
                found != object.end() && !fits(*found, member))
                throw document_.error(place,
                                      fmt::format("its \"{}\" is {}, expected {}", member.name,
                                                  shown(*found), expected(member)));
    }

    /// An object all of whose members are indices.
    void check_indices(const json &object, const std::string &place) const {
        for (auto member = object.begin(); member != object.end(); ++member)
            check(object, place, {{member.key().c_str(), Type::index}});
    }

    /// The objects of an array that check() has seen; `also` looks at what lies in each.
    template <typename Also>
    void each(const json &object, const std::string &before, const char *list,
              const Members &members, const Also &also) const {
        const auto found = object.find(list);
        if (found == object.end())
            return;
        int index = 0;
        for (const json &element : *found) {
            const std::string place = before + place_of(list, index++);
            check(element, place, members);
            also(element, place);
        }
    }
    void each(const json &object, const char *list, const Members &members) const {
        each(object, "", list, members, [](const json &, const std::string &) {});
    }

private:
    static std::string shown(const json &value) {
        const std::string text = value.dump();
        return text.size() <= 60 ? text : std::string(value.type_name());
    }

    const Document &document_;
};

const Members root_members = {
    {"scene", Type::index},       {"scenes", Type::objects},    {"nodes", Type::objects},
    {"meshes", Type::objects},    {"accessors", Type::objects}, {"bufferViews", Type::objects},
    {"materials", Type::objects}, {"textures", Type::objects},  {"samplers", Type::objects},
    {"cameras", Type::objects},   {"skins", Type::objects},     {"extensions", Type::object}};
const Members node_members = {
    {"mesh", Type::index},          {"camera", Type::index},     {"skin", Type::index},
    {"children", Type::indices},    {"matrix", Type::numbers},   {"translation", Type::numbers, 3},
    {"rotation", Type::numbers, 4}, {"scale", Type::numbers, 3}, {"extensions", Type::object}};
const Members primitive_members = {{"attributes", Type::object},
                                   {"indices", Type::index},
                                   {"material", Type::index},
                                   {"mode", Type::index},
                                   {"extensions", Type::object}};
const Members accessor_members = {{"bufferView", Type::index},    {"byteOffset", Type::size},
                                  {"componentType", Type::index}, {"count", Type::size},
                                  {"type", Type::text},           {"normalized", Type::flag},
                                  {"sparse", Type::object},       {"extensions", Type::object}};
const Members view_members = {{"buffer", Type::index},
                              {"byteOffset", Type::size},
                              {"byteLength", Type::size},
                              {"byteStride", Type::size}};
const Members material_members = {{"pbrMetallicRoughness", Type::object},
                                  {"normalTexture", Type::object},
                                  {"occlusionTexture", Type::object},
                                  {"emissiveTexture", Type::object},
                                  {"emissiveFactor", Type::numbers, 3},
                                  {"alphaMode", Type::text},
                                  {"alphaCutoff", Type::number},
                                  {"doubleSided", Type::flag},
                                  {"extensions", Type::object}};
const Members metal_members = {{"baseColorFactor", Type::numbers, 4},
                               {"metallicFactor", Type::number},
                               {"roughnessFactor", Type::number},
                               {"baseColorTexture", Type::object},
                               {"metallicRoughnessTexture", Type::object}};

} // namespace

void check_types(const json &root, const Document &document) {
    const TypeChecker types(document);
    types.check(root, "", root_members);
    types.each(root, "scenes", {{"nodes", Type::indices}});
    types.each(root, "nodes", node_members);
    types.each(root, "accessors", accessor_members);
    types.each(root, "bufferViews", view_members);
    types.each(root, "textures", {{"source", Type::index}, {"sampler", Type::index}});
    types.each(root, "samplers",
               {{"wrapS", Type::index}, {"wrapT", Type::index}, {"magFilter", Type::index}});
    types.each(root, "skins", {{"joints", Type::indices}, {"inverseBindMatrices", Type::index}});
    types.each(
        root, "cameras",
        {{"type", Type::text}, {"perspective", Type::object}, {"orthographic", Type::object}});
    types.each(root, "", "meshes", {{"primitives", Type::objects}},
               [&](const json &mesh, const std::string &place) {
                   types.each(mesh, place + ".", "primitives", primitive_members,
                              [&](const json &primitive, const std::string &own) {
                                  if (primitive.contains("attributes"))
                                      types.check_indices(primitive["attributes"], own);
                              });
               });
    types.each(root, "", "materials", material_members,
               [&](const json &material, const std::string &place) {
                   if (material.contains("pbrMetallicRoughness"))
                       types.check(material["pbrMetallicRoughness"], place, metal_members);
               });
}

} // namespace clrender::gltf
