#include "gltf_draco.h"

#include "../memory_limit.h"

#include <draco/compression/decode.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <exception>
#include <memory>

namespace clrender::gltf {

namespace {

/// What the library takes for a triangle and its corners at its peak, without attributes.
constexpr std::uint64_t bytes_per_face = 160;

/// Triangles that a byte may stand for. Real data have one or less.
constexpr std::uint64_t max_faces_per_byte = 256;

/// A number of 7 bits a byte, the lowest first; none where the data ends.
std::optional<std::uint64_t> varint(std::string_view &data) {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 63 && !data.empty(); shift += 7) {
        const auto byte = static_cast<unsigned char>(data.front());
        data.remove_prefix(1);
        value |= std::uint64_t{byte & 0x7fU} << shift;
        if ((byte & 0x80U) == 0)
            return value;
    }
    return std::nullopt;
}

/// Triangles and vertices that the header of a mesh states ("Draco 3D Graphics Compression",
/// bitstream 2.2, which the extension asks for); none where it is no such header.
std::optional<std::array<std::uint64_t, 2>> stated_sizes(std::string_view data) {
    constexpr unsigned char mesh = 1;
    constexpr unsigned char edgebreaker = 1;
    constexpr std::size_t header_bytes = 11;
    if (data.size() < header_bytes + 1 || !data.starts_with(std::string_view("DRACO\2\2", 7)) ||
        static_cast<unsigned char>(data[7]) != mesh)
        return std::nullopt;
    const bool has_metadata = (static_cast<unsigned char>(data[10]) & 0x80U) != 0;
    const bool is_edgebreaker = static_cast<unsigned char>(data[8]) == edgebreaker;
    if (has_metadata)
        return std::nullopt;
    data.remove_prefix(header_bytes + (is_edgebreaker ? 1 : 0));
    const auto first = varint(data);
    const auto second = varint(data);
    if (!first || !second)
        return std::nullopt;
    return is_edgebreaker ? std::array{*second, *first} : std::array{*first, *second};
}

void check_sizes(const Document &document, std::string_view data, std::size_t attributes,
                 const std::string &place) {
    const auto sizes = stated_sizes(data);
    if (!sizes)
        throw document.error(place, "no Draco mesh of bitstream 2.2 without metadata");
    const auto [faces, vertices] = *sizes;
    if (faces > max_faces_per_byte * data.size() || vertices > 3 * faces)
        throw document.error(place, fmt::format("{} triangles and {} vertices in {} bytes of "
                                                "Draco data",
                                                faces, vertices, data.size()));
    // An attribute has at most four numbers for each corner, and is copied twice.
    const std::uint64_t bytes = faces * (bytes_per_face + sizeof(float) * 3 * 4 * 3 * attributes);
    if (const std::string reason = claim_memory(bytes); !reason.empty())
        throw document.error(place, reason);
}

std::unique_ptr<draco::Mesh> decode(const Document &document, std::string_view data,
                                    const std::string &place) {
    draco::DecoderBuffer buffer;
    buffer.Init(data.data(), data.size());
    std::string fault;
    try {
        draco::Decoder decoder;
        auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
        if (mesh.ok())
            return std::move(mesh).value();
        fault = mesh.status().error_msg_string();
    } catch (const std::exception &error) {
        fault = error.what();
    }
    throw document.error(place, "broken Draco data: " + fault.substr(0, 200));
}

Numbers numbers_of(const Document &document, const draco::Mesh &mesh, int id,
                   const tinygltf::Accessor &accessor, const std::string &place) {
    const draco::PointAttribute *attribute =
        id < 0 ? nullptr : mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(id));
    if (attribute == nullptr || attribute->num_components() < 1 || attribute->num_components() > 4)
        throw document.error(place, fmt::format("the Draco data has no attribute {}", id));
    Numbers numbers;
    numbers.components = static_cast<std::size_t>(attribute->num_components());
    numbers.values.reserve(mesh.num_points() * numbers.components);
    for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
        std::array<float, 4> values{};
        const auto at = attribute->mapped_index(draco::PointIndex(i));
        if (at.value() >= attribute->size() || !attribute->ConvertValue<float>(at, values.data()))
            throw document.error(place, "broken Draco data: an attribute ends early");
        for (std::size_t c = 0; c < numbers.components; ++c) {
            const bool is_raw = accessor.normalized && !attribute->normalized();
            const float value = is_raw ? normalised(values[c], accessor.componentType) : values[c];
            if (!std::isfinite(value))
                throw document.error(place, "a number of the Draco data is not finite");
            numbers.values.push_back(value);
        }
    }
    return numbers;
}

} // namespace

std::optional<CompressedPrimitive>
decompress(const Document &document, const tinygltf::Primitive &source, const std::string &place) {
    const auto found = source.extensions.find("KHR_draco_mesh_compression");
    if (found == source.extensions.end())
        return std::nullopt;
    const tinygltf::Value &extension = found->second;
    const std::string own = place + ".KHR_draco_mesh_compression";
    if (!extension.Has("bufferView") || !extension.Get("bufferView").IsInt() ||
        !extension.Has("attributes") || !extension.Get("attributes").IsObject())
        throw document.error(own, "has no bufferView or no attributes");
    const auto &attributes = extension.Get("attributes").Get<tinygltf::Value::Object>();
    const std::string_view data = document.view(extension.Get("bufferView").GetNumberAsInt(), own);
    check_sizes(document, data, attributes.size(), own);
    const std::unique_ptr<draco::Mesh> mesh = decode(document, data, own);

    CompressedPrimitive primitive;
    primitive.vertices = mesh->num_points();
    primitive.triangles.reserve(mesh->num_faces());
    for (std::uint32_t i = 0; i < mesh->num_faces(); ++i) {
        const draco::Mesh::Face &face = mesh->face(draco::FaceIndex(i));
        const std::array<std::uint32_t, 3> t = {face[0].value(), face[1].value(), face[2].value()};
        for (const std::uint32_t corner : t)
            if (corner >= primitive.vertices)
                throw document.error(own, "broken Draco data: a triangle has no such vertex");
        primitive.triangles.push_back(t);
    }
    for (const auto &[name, id] : attributes) {
        const auto accessor = source.attributes.find(name);
        if (accessor == source.attributes.end() || !id.IsInt())
            continue;
        primitive.attributes[name] = numbers_of(
            document, *mesh, id.GetNumberAsInt(),
            element(document, document.model.accessors, accessor->second, "accessor", own), own);
    }
    return primitive;
}

} // namespace clrender::gltf
