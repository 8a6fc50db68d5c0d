#include "gltf_primitives.h"

#include "../memory_limit.h"
#include "gltf_draco.h"
#include "mesh_normals.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

namespace clrender::gltf {

namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// What vertices and triangles take while a primitive becomes a mesh.
constexpr std::uint64_t bytes_per_vertex = 80;
constexpr std::uint64_t bytes_per_triangle = 24;

/// An accessor of a primitive, or -1.
int attribute_of(const tinygltf::Primitive &source, const std::string &name) {
    const auto found = source.attributes.find(name);
    return found == source.attributes.end() ? -1 : found->second;
}

/// The triangles of a list, strip or fan of vertices; triangles of a strip that name a vertex twice
/// only join its parts.
std::vector<Triangle> triangles_of(int mode, std::size_t count, const auto &vertex) {
    std::vector<Triangle> triangles;
    if (mode == TINYGLTF_MODE_TRIANGLES) {
        triangles.reserve(count / 3);
        for (std::size_t i = 0; i + 2 < count; i += 3)
            triangles.push_back({vertex(i), vertex(i + 1), vertex(i + 2)});
        return triangles;
    }
    triangles.reserve(std::max<std::size_t>(count, 2) - 2);
    for (std::size_t i = 0; i + 2 < count; ++i) {
        const bool is_fan = mode == TINYGLTF_MODE_TRIANGLE_FAN;
        const std::size_t odd = is_fan ? 0 : i % 2;
        const Triangle t = {vertex(is_fan ? 0 : i), vertex(i + 1 + odd), vertex(i + 2 - odd)};
        if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0])
            triangles.push_back(t);
    }
    return triangles;
}

void read_triangles(const Document &document, const tinygltf::Primitive &source,
                    std::optional<CompressedPrimitive> &compressed, Primitive &primitive) {
    if (compressed) {
        primitive.mesh.triangles = std::move(compressed->triangles);
        return;
    }
    const std::size_t vertices = primitive.mesh.positions.size();
    std::vector<std::uint32_t> indices;
    if (source.indices >= 0)
        indices = read_indices(document, source.indices, vertices, primitive.place + ".indices");
    const std::size_t count = source.indices >= 0 ? indices.size() : vertices;
    if (const std::string reason = claim_memory(count * bytes_per_triangle); !reason.empty())
        throw document.error(primitive.place, reason);
    primitive.mesh.triangles = triangles_of(source.mode, count, [&](std::size_t i) {
        return source.indices >= 0 ? indices[i] : static_cast<std::uint32_t>(i);
    });
    if (source.mode == TINYGLTF_MODE_TRIANGLES && count % 3 != 0)
        document.warn(primitive.place, fmt::format("{} corners are no triangles, the last {} are "
                                                   "left out",
                                                   count, count % 3));
}

/// Unit vectors; those without a direction are 0.
std::vector<glm::vec3> unit_vectors(const Numbers &numbers) {
    std::vector<glm::vec3> vectors;
    vectors.reserve(numbers.values.size() / 3);
    for (std::size_t i = 0; i < numbers.values.size(); i += 3) {
        const glm::dvec3 n(numbers.values[i], numbers.values[i + 1], numbers.values[i + 2]);
        const double length = glm::length(n);
        vectors.emplace_back(length > 0 ? n / length : glm::dvec3(0));
    }
    return vectors;
}

/// Reads the attribute `name`, out of the compressed data where it is there; none where it is
/// not.
Numbers read_attribute(const Document &document, const tinygltf::Primitive &source,
                       const std::string &name, int least, int most, const std::string &place,
                       std::optional<CompressedPrimitive> &compressed) {
    const int accessor = attribute_of(source, name);
    if (accessor < 0)
        return {};
    const std::string own = place + "." + name;
    if (compressed && compressed->attributes.count(name) > 0) {
        Numbers numbers = std::move(compressed->attributes[name]);
        if (numbers.components < static_cast<std::size_t>(least) ||
            numbers.components > static_cast<std::size_t>(most))
            throw document.error(own, fmt::format("{} numbers a vertex, expected {} to {}",
                                                  numbers.components, least, most));
        return numbers;
    }
    return read_numbers(document, accessor, least, most, own, name != "POSITION");
}

/// The number at the end of "TEXCOORD_<n>", or -1.
int set_of(const std::string &name) {
    const std::string prefix = "TEXCOORD_";
    int set = -1;
    if (!name.starts_with(prefix))
        return -1;
    const char *end = name.data() + name.size();
    const auto [next, error] = std::from_chars(name.data() + prefix.size(), end, set);
    return error == std::errc() && next == end ? set : -1;
}

/// An attribute of channels `first` to `first` + `count` of the numbers of each vertex.
MeshAttribute attribute_of(const std::string &name, const Numbers &numbers, std::size_t first,
                           std::size_t count, std::size_t channels) {
    MeshAttribute attribute;
    attribute.name = name;
    attribute.channels = channels;
    attribute.values.reserve(numbers.count() * channels);
    for (std::size_t i = 0; i < numbers.count(); ++i)
        for (std::size_t c = 0; c < channels; ++c)
            attribute.values.push_back(
                c < count ? numbers.values[i * numbers.components + first + c] : 0);
    return attribute;
}

/// Colours are numbers from 0 to 1 that are not below 0, as floats can be.
void clamp(std::vector<float> &values) {
    for (float &value : values)
        value = std::clamp(value, 0.0F, 1.0F);
}

/// Whether (u, v) of a triangle are mirrored: seen from its front, v does not turn clockwise from
/// u, as it does in a picture whose first row is at v = 0.
bool is_mirrored(const Mesh &mesh, const Triangle &t) {
    const glm::dvec3 side1 = mesh.positions[t[1]] - mesh.positions[t[0]];
    const glm::dvec3 side2 = mesh.positions[t[2]] - mesh.positions[t[0]];
    const glm::dvec3 normal = glm::cross(side1, side2);
    const glm::dvec2 uv1(mesh.uvs[t[1]] - mesh.uvs[t[0]]);
    const glm::dvec2 uv2(mesh.uvs[t[2]] - mesh.uvs[t[0]]);
    double side = 1;
    if (!mesh.normals.empty())
        side = glm::dot(normal,
                        glm::dvec3(mesh.normals[t[0]] + mesh.normals[t[1]] + mesh.normals[t[2]]));
    return (uv1.x * uv2.y - uv1.y * uv2.x) * side > 0;
}

} // namespace

Primitive read_primitive(const Document &document, const tinygltf::Primitive &source,
                         const std::string &place, bool is_skinned) {
    Primitive primitive;
    primitive.material = source.material;
    primitive.place = place;
    if (source.mode >= TINYGLTF_MODE_POINTS && source.mode < TINYGLTF_MODE_TRIANGLES) {
        document.warn(place, "points and lines are ignored");
        return primitive;
    }
    if (source.mode < TINYGLTF_MODE_POINTS || source.mode > TINYGLTF_MODE_TRIANGLE_FAN)
        throw document.error(place,
                             fmt::format("mode {}, expected a number from 0 to 6", source.mode));
    if (attribute_of(source, "POSITION") < 0) {
        document.warn(place, "has no POSITION and is ignored");
        return primitive;
    }
    auto compressed = decompress(document, source, place);
    const auto read = [&](const std::string &name, int least, int most) {
        Numbers numbers = read_attribute(document, source, name, least, most, place, compressed);
        const std::size_t expected =
            compressed ? compressed->vertices : primitive.mesh.positions.size();
        if (!numbers.values.empty() && (compressed || name != "POSITION") &&
            numbers.count() != expected)
            throw document.error(place + "." + name, fmt::format("{} elements for {} vertices",
                                                                 numbers.count(), expected));
        return numbers;
    };
    const Numbers positions = read("POSITION", 3, 3);
    if (const std::string reason = claim_memory(positions.values.size() / 3 * bytes_per_vertex);
        !reason.empty())
        throw document.error(place, reason);
    for (std::size_t i = 0; i < positions.values.size(); i += 3)
        primitive.mesh.positions.emplace_back(positions.values[i], positions.values[i + 1],
                                              positions.values[i + 2]);
    read_triangles(document, source, compressed, primitive);
    primitive.mesh.normals = unit_vectors(read("NORMAL", 3, 3));
    if (!primitive.mesh.normals.empty())
        complete_normals(primitive.mesh);
    for (const auto &[name, accessor] : source.attributes)
        if (const int set = set_of(name); set >= 0)
            primitive.coordinates[set] = read(name, 2, 2);
    primitive.colors = read("COLOR_0", 3, 4);
    for (int set = 0; is_skinned && attribute_of(source, "JOINTS_" + std::to_string(set)) >= 0;
         ++set) {
        primitive.joints.push_back(read("JOINTS_" + std::to_string(set), 4, 4));
        primitive.weights.push_back(read("WEIGHTS_" + std::to_string(set), 4, 4));
        if (primitive.weights.back().values.size() != primitive.joints.back().values.size())
            throw document.error(place, fmt::format("has no WEIGHTS_{} for its joints", set));
    }
    clamp(primitive.colors.values);
    if (!source.targets.empty())
        document.warn(place, "morph targets are ignored");
    return primitive;
}

std::vector<SurfacedMesh> surfaced(const Document &document, Primitive primitive,
                                   SurfaceMaker &surfaces) {
    Mesh &mesh = primitive.mesh;
    SurfaceNeeds needs;
    needs.material = primitive.material;
    needs.has_colors = !primitive.colors.values.empty();
    needs.has_alphas = needs.has_colors && primitive.colors.components == 4;
    const Surface &surface = surfaces.surface(needs);

    for (const int set : surface.sets) {
        Numbers &numbers = primitive.coordinates[set];
        if (numbers.values.empty()) {
            document.warn(primitive.place, fmt::format("has no TEXCOORD_{}, which its material "
                                                       "asks for: (0, 0) is taken",
                                                       set));
            numbers.components = 2;
            numbers.values.resize(2 * mesh.positions.size());
        }
        if (set != surface.set)
            mesh.attributes.push_back(attribute_of(coordinates_attribute(set), numbers, 0, 2, 3));
        else
            for (std::size_t i = 0; i < numbers.values.size(); i += 2)
                mesh.uvs.emplace_back(numbers.values[i], numbers.values[i + 1]);
    }
    if (needs.has_colors)
        mesh.attributes.push_back(attribute_of(color_attribute, primitive.colors, 0, 3, 3));
    if (needs.has_alphas)
        mesh.attributes.push_back(attribute_of(alpha_attribute, primitive.colors, 3, 1, 1));

    std::vector<SurfacedMesh> parts;
    if (surface.has_normal_map && !mesh.uvs.empty()) {
        const auto middle =
            std::stable_partition(mesh.triangles.begin(), mesh.triangles.end(),
                                  [&](const Triangle &t) { return !is_mirrored(mesh, t); });
        if (middle != mesh.triangles.end()) {
            Mesh mirrored = mesh;
            mirrored.triangles.assign(middle, mesh.triangles.end());
            mesh.triangles.erase(middle, mesh.triangles.end());
            needs.flips_normals = true;
            parts.push_back(
                {std::make_shared<const Mesh>(std::move(mirrored)), surfaces.surface(needs)});
        }
    }
    needs.flips_normals = false;
    if (!mesh.triangles.empty())
        parts.push_back({std::make_shared<const Mesh>(std::move(mesh)), surfaces.surface(needs)});
    return parts;
}

} // namespace clrender::gltf
