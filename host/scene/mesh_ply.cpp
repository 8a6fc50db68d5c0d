/// PLY files: ASCII and both binary byte orders, any scalar types; what is not a vertex's place,
/// normal or coordinates or a face's indices is passed over.

#include "../input_file.h"
#include "../memory_limit.h"
#include "mesh_io.h"
#include "mesh_normals.h"
#include "obj_lines.h"
#include "ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

namespace clrender {

namespace {

/// Reads one value after the other from the part behind the header.
class PlyValues {
public:
    PlyValues(std::string_view bytes, const PlyHeader &header, const std::string &path)
        : next_(bytes.data() + header.body_offset), end_(bytes.data() + bytes.size()),
          format_(header.format), path_(path), line_(header.body_line) {}

    double number(PlyType type) {
        return format_ == PlyFormat::ascii ? text_number() : binary_number(type);
    }

    /// The length of a list whose items are still in the file.
    std::uint64_t list_length(const PlyProperty &list) {
        const double length = number(list.count_type);
        const std::uint64_t item = format_ == PlyFormat::ascii ? 2 : ply_type_size(list.type);
        const std::uint64_t most = (static_cast<std::uint64_t>(end_ - next_) + 1) / item;
        if (!(length >= 0) || length != std::floor(length) || length > static_cast<double>(most))
            fail(fmt::format("list of {} items, but the file ends before", length));
        return static_cast<std::uint64_t>(length);
    }

    [[noreturn]] void fail(const std::string &reason) const {
        throw InputError({path_, format_ == PlyFormat::ascii ? line_ : 0}, reason);
    }

private:
    double text_number();
    double binary_number(PlyType type);
    template <class T> double load();

    const char *next_, *end_;
    PlyFormat format_;
    std::string path_;
    int line_;
};

double PlyValues::text_number() {
    const auto is_blank = [](char c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
    while (next_ != end_ && is_blank(*next_)) {
        if (*next_ == '\n' && line_ < std::numeric_limits<int>::max())
            ++line_;
        ++next_;
    }
    if (next_ == end_)
        fail("the file ends within its elements");
    const char *word_end = std::find_if(next_, end_, is_blank);
    const std::string_view word(next_, static_cast<std::size_t>(word_end - next_));
    double value = 0;
    const auto [stop, error] = std::from_chars(next_, word_end, value);
    if (error != std::errc() || stop != word_end) {
        // Rare forms, and what is no number at all, take the slow way.
        if (const std::string reason = check_number(word); !reason.empty())
            fail(reason);
        value = std::strtod(std::string(word).c_str(), nullptr);
    }
    next_ = word_end;
    return value;
}

template <class T> double PlyValues::load() {
    if (static_cast<std::size_t>(end_ - next_) < sizeof(T))
        fail("the file ends within its elements");
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), next_, sizeof(T));
    next_ += sizeof(T);
    if ((format_ == PlyFormat::big_endian) == (std::endian::native == std::endian::little))
        std::reverse(bytes.begin(), bytes.end());
    return static_cast<double>(std::bit_cast<T>(bytes));
}

double PlyValues::binary_number(PlyType type) {
    switch (type) {
    case PlyType::int8:
        return load<std::int8_t>();
    case PlyType::uint8:
        return load<std::uint8_t>();
    case PlyType::int16:
        return load<std::int16_t>();
    case PlyType::uint16:
        return load<std::uint16_t>();
    case PlyType::int32:
        return load<std::int32_t>();
    case PlyType::uint32:
        return load<std::uint32_t>();
    case PlyType::float32:
        return load<float>();
    case PlyType::float64:
        break;
    }
    return load<double>();
}

/// What a property of a vertex means to us.
enum Slot : std::size_t { x, y, z, nx, ny, nz, u, v, slot_count };

/// Per property: its slot, or slot_count if it is passed over.
std::vector<std::size_t> vertex_slots(const PlyElement &element) {
    static const std::map<std::string_view, std::size_t> names = {
        {"x", x}, {"y", y}, {"z", z}, {"nx", nx}, {"ny", ny},       {"nz", nz},
        {"u", u}, {"v", v}, {"s", u}, {"t", v},   {"texture_u", u}, {"texture_v", v}};
    std::vector<std::size_t> slots;
    for (const PlyProperty &property : element.properties) {
        const auto found = names.find(property.name);
        slots.push_back(found == names.end() || property.is_list ? slot_count : found->second);
    }
    return slots;
}

void skip(const PlyProperty &property, PlyValues &values) {
    const std::uint64_t count = property.is_list ? values.list_length(property) : 1;
    for (std::uint64_t i = 0; i < count; ++i)
        (void)values.number(property.type);
}

void read_vertices(const PlyElement &element, const std::string &path, PlyValues &values,
                   Mesh &mesh) {
    const std::vector<std::size_t> slots = vertex_slots(element);
    const auto has = [&](std::initializer_list<std::size_t> wanted) {
        return std::all_of(wanted.begin(), wanted.end(), [&](std::size_t slot) {
            return std::find(slots.begin(), slots.end(), slot) != slots.end();
        });
    };
    if (!has({x, y, z}))
        throw InputError({path, element.line}, "vertices without properties x, y and z");
    const bool has_normals = has({nx, ny, nz});
    const bool has_uvs = has({u, v});

    // Memory for all of them: the header's count has been checked against the file's length.
    mesh.positions.reserve(element.count);
    mesh.normals.reserve(has_normals ? element.count : 0);
    mesh.uvs.reserve(has_uvs ? element.count : 0);
    for (std::uint64_t i = 0; i < element.count; ++i) {
        std::array<double, slot_count + 1> at{};
        for (std::size_t p = 0; p < slots.size(); ++p) {
            if (slots[p] == slot_count) {
                skip(element.properties[p], values);
                continue;
            }
            const double value = values.number(element.properties[p].type);
            if (!(std::abs(value) <= std::numeric_limits<float>::max()))
                values.fail(fmt::format("{} of vertex {} is {}, expected a finite number",
                                        element.properties[p].name, i, value));
            at[slots[p]] = value;
        }
        mesh.positions.emplace_back(at[x], at[y], at[z]);
        if (has_normals) {
            const glm::dvec3 normal(at[nx], at[ny], at[nz]);
            const double length = glm::length(normal);
            mesh.normals.push_back(length > 0 ? glm::vec3(normal / length) : glm::vec3(0.0F));
        }
        if (has_uvs)
            mesh.uvs.emplace_back(at[u], at[v]);
    }
}

std::uint32_t read_index(const PlyProperty &property, std::uint64_t vertex_count,
                         PlyValues &values) {
    const double index = values.number(property.type);
    if (!(index >= 0 && index < static_cast<double>(vertex_count)) || index != std::floor(index))
        values.fail(fmt::format("vertex index {}, expected an integer from 0 to {}", index,
                                static_cast<std::int64_t>(vertex_count) - 1));
    return static_cast<std::uint32_t>(index);
}

void read_faces(const PlyElement &element, const std::string &path, std::uint64_t vertex_count,
                PlyValues &values, Mesh &mesh) {
    const auto is_indices = [](const PlyProperty &p) {
        return p.is_list && (p.name == "vertex_index" || p.name == "vertex_indices");
    };
    if (std::count_if(element.properties.begin(), element.properties.end(), is_indices) != 1)
        throw InputError({path, element.line},
                         "faces without a list of vertex_indices (or with two)");
    mesh.triangles.reserve(element.count);
    for (std::uint64_t i = 0; i < element.count; ++i) {
        for (const PlyProperty &property : element.properties) {
            if (!is_indices(property)) {
                skip(property, values);
                continue;
            }

            // A polygon is cut into a fan around its first vertex.
            const std::uint64_t corners = values.list_length(property);
            if (corners < 3)
                values.fail(
                    fmt::format("face {} with {} vertices, expected at least 3", i, corners));
            const std::uint32_t first = read_index(property, vertex_count, values);
            std::uint32_t previous = read_index(property, vertex_count, values);
            for (std::uint64_t corner = 2; corner < corners; ++corner) {
                const std::uint32_t next = read_index(property, vertex_count, values);
                mesh.triangles.push_back({first, previous, next});
                previous = next;
            }
        }
    }
}

const PlyElement *find_element(const PlyHeader &header, std::string_view name,
                               const std::string &path) {
    const PlyElement *found = nullptr;
    for (const PlyElement &element : header.elements) {
        if (element.name != name)
            continue;
        if (found != nullptr)
            throw InputError({path, element.line}, "a second element " + element.name);
        found = &element;
    }
    if (found == nullptr || found->count == 0)
        throw InputError({path, found ? found->line : 0},
                         fmt::format("no elements {}, expected a mesh of triangles", quoted(name)));
    return found;
}

} // namespace

Mesh read_ply_mesh(const std::string &path, const MeshReadOptions &options,
                   const SourceLocation &referrer) {
    const std::string bytes = read_input_file(path, referrer);
    const PlyHeader header = parse_ply_header(bytes, path);
    const PlyElement *vertices = find_element(header, "vertex", path);
    const PlyElement *faces = find_element(header, "face", path);

    // At least a triangle for each face.
    if (const std::string reason = claim_memory(
            vertices->count * (sizeof(glm::dvec3) + sizeof(glm::vec3) + sizeof(glm::vec2)) +
            faces->count * sizeof(Mesh::triangles[0]));
        !reason.empty())
        throw InputError({path, vertices->line}, reason);

    // The elements follow in the order of the header.
    Mesh mesh;
    PlyValues values(bytes, header, path);
    for (const PlyElement &element : header.elements) {
        if (&element == vertices)
            read_vertices(element, path, values, mesh);
        else if (&element == faces)
            read_faces(element, path, vertices->count, values, mesh);
        else
            for (std::uint64_t i = 0; i < element.count; ++i)
                for (const PlyProperty &property : element.properties)
                    skip(property, values);
    }

    if (options.flip_tex_coords)
        for (glm::vec2 &uv : mesh.uvs)
            uv.y = 1 - uv.y;
    if (options.face_normals)
        mesh.normals.clear();
    else
        complete_normals(mesh);
    return mesh;
}

} // namespace clrender
