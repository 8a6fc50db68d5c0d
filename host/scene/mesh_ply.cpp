/// PLY files: ASCII and both binary byte orders, any scalar types; what is not a vertex's place,
/// normal or coordinates, a face's indices or an attribute that is asked for is passed over.

#include "../input_file.h"
#include "../log.h"
#include "../memory_limit.h"
#include "mesh_attributes.h"
#include "mesh_io.h"
#include "mesh_normals.h"
#include "mesh_polygons.h"
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
#include <optional>
#include <span>

namespace clrender {

namespace {

/// Reads one value after the other from the part behind the header.
class PlyValues {
public:
    PlyValues(std::string_view bytes, const PlyHeader &header, const std::string &path)
        : next_(bytes.data() + header.body_offset), end_(bytes.data() + bytes.size()),
          format_(header.format), line_end_(header.line_end), path_(path), line_(header.body_line) {
    }

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

    /// The place of the value that was read last.
    [[nodiscard]] SourceLocation where() const {
        return {path_, format_ == PlyFormat::ascii ? line_ : 0};
    }
    [[noreturn]] void fail(const std::string &reason) const { throw InputError(where(), reason); }

private:
    double text_number();
    double binary_number(PlyType type);
    template <class T> double load();

    const char *next_, *end_;
    PlyFormat format_;
    char line_end_;
    std::string path_;
    int line_;
};

double PlyValues::text_number() {
    const auto is_blank = [](char c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
    while (next_ != end_ && is_blank(*next_)) {
        if (*next_ == line_end_ && line_ < std::numeric_limits<int>::max())
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
        {"x", x},         {"y", y},         {"z", z},         {"nx", nx},      {"ny", ny},
        {"nz", nz},       {"u", u},         {"v", v},         {"s", u},        {"t", v},
        {"texture_u", u}, {"texture_v", v}, {"texture_s", u}, {"texture_t", v}};
    std::vector<std::size_t> slots;
    for (const PlyProperty &property : element.properties) {
        const auto found = names.find(property.name);
        slots.push_back(found == names.end() || property.is_list ? slot_count : found->second);
    }
    return slots;
}

/// Says which normals and coordinates a file has in a form that is not read.
void warn_of_unread(const PlyHeader &header, const std::string &path) {
    for (const PlyElement &element : header.elements) {
        const auto has = [&](std::string_view name) {
            return std::any_of(element.properties.begin(), element.properties.end(),
                               [&](const PlyProperty &p) { return p.name == name; });
        };
        const SourceLocation where{path, element.line};
        if (element.name == "face" && has("texcoord"))
            log::warn(where, "the coordinates of the faces' corners (\"texcoord\") are ignored, "
                             "expected u and v of the vertices");
        if (element.name != "vertex")
            continue;
        const auto count = [&](std::initializer_list<std::string_view> names) {
            return std::count_if(names.begin(), names.end(), has);
        };
        if (const auto found = count({"nx", "ny", "nz"}); found != 0 && found != 3)
            log::warn(where, "normals without all of nx, ny and nz are ignored");
        if (count({"u", "s", "texture_u", "texture_s"}) !=
            count({"v", "t", "texture_v", "texture_t"}))
            log::warn(where, "coordinates without both of u and v (or s and t) are ignored");
    }
}

void skip(const PlyProperty &property, PlyValues &values) {
    const std::uint64_t count = property.is_list ? values.list_length(property) : 1;
    for (std::uint64_t i = 0; i < count; ++i)
        (void)values.number(property.type);
}

/// Reads a property of an element that belongs to an attribute.
void read_attribute(const PlyElement &element, std::size_t property, std::uint64_t number,
                    PlyValues &values, PlyAttributes &attributes) {
    const double value = values.number(element.properties[property].type);
    if (!(std::abs(value) <= std::numeric_limits<float>::max()))
        values.fail(fmt::format("{} of {} {} is {}, expected a finite number",
                                element.properties[property].name, element.name, number, value));
    attributes.set(property, value);
}

void read_vertices(const PlyElement &element, const std::string &path, PlyValues &values,
                   PlyAttributes &attributes, Mesh &mesh) {
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
            if (attributes.wants(p)) {
                read_attribute(element, p, i, values, attributes);
                continue;
            }
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
        attributes.finish_element();
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

std::uint32_t check_index(double index, std::uint64_t vertex_count, const PlyValues &values) {
    if (!(index >= 0 && index < static_cast<double>(vertex_count)) || index != std::floor(index))
        values.fail(fmt::format("vertex index {}, expected an integer from 0 to {}", index,
                                static_cast<std::int64_t>(vertex_count) - 1));
    return static_cast<std::uint32_t>(index);
}

std::uint32_t read_index(const PlyProperty &property, std::uint64_t vertex_count,
                         PlyValues &values) {
    return check_index(values.number(property.type), vertex_count, values);
}

/// The next index of a strip, or nothing where the strip ends: -1, which types without sign hold
/// as their largest value.
std::optional<std::uint32_t> read_strip_index(const PlyProperty &property,
                                              std::uint64_t vertex_count, PlyValues &values) {
    const double index = values.number(property.type);
    const bool is_end = index == -1 || (property.type == PlyType::uint8 && index == 0xff) ||
                        (property.type == PlyType::uint16 && index == 0xffff) ||
                        (property.type == PlyType::uint32 && index == 0xffffffff);
    if (is_end)
        return std::nullopt;
    return check_index(index, vertex_count, values);
}

/// Takes the polygons and strips of a file to the triangles of its mesh.
class PlyFaces {
public:
    PlyFaces(Mesh &mesh, std::uint64_t vertex_count, PlyAttributes &attributes)
        : mesh_(mesh), vertex_count_(vertex_count), attributes_(attributes), polygons_(mesh) {}

    void read_polygons(const PlyElement &element, const std::string &path, PlyValues &values);
    void read_strips(const PlyElement &element, const std::string &path, PlyValues &values);

    /// To be called when all elements have been read.
    void finish();

private:
    void add_polygon(const SourceLocation &where);
    void cut_polygon(std::span<const std::uint32_t> vertices, const SourceLocation &where);
    void add_strip();

    Mesh &mesh_;
    std::uint64_t vertex_count_;
    PlyAttributes &attributes_;
    std::vector<std::uint32_t> face_of_; ///< by triangle; only with attributes of faces
    std::uint32_t cut_faces_ = 0;
    MeshPolygons polygons_;
    std::vector<std::uint32_t> face_; ///< the vertices of the polygon or strip at hand

    /// Polygons that stand before the vertices, with which they can only be cut later.
    std::vector<std::uint32_t> early_vertices_, early_sizes_;
    SourceLocation early_where_;
};

/// The one list of indices that an element has.
const PlyProperty &indices_of(const PlyElement &element, const std::string &path) {
    const PlyProperty *found = nullptr;
    for (const PlyProperty &property : element.properties) {
        if (!property.is_list ||
            (property.name != "vertex_index" && property.name != "vertex_indices"))
            continue;
        if (found != nullptr)
            throw InputError({path, element.line},
                             fmt::format("element {} with two lists of vertex_indices, "
                                         "expected one",
                                         quoted(element.name)));
        found = &property;
    }
    if (found == nullptr)
        throw InputError({path, element.line},
                         fmt::format("element {} without a list of vertex_indices, expected one",
                                     quoted(element.name)));
    return *found;
}

void PlyFaces::read_polygons(const PlyElement &element, const std::string &path,
                             PlyValues &values) {
    const PlyProperty &indices = indices_of(element, path);
    mesh_.triangles.reserve(mesh_.triangles.size() + element.count);
    for (std::uint64_t i = 0; i < element.count; ++i) {
        for (std::size_t p = 0; p < element.properties.size(); ++p) {
            const PlyProperty &property = element.properties[p];
            if (attributes_.wants(p)) {
                read_attribute(element, p, i, values, attributes_);
                continue;
            }
            if (&property != &indices) {
                skip(property, values);
                continue;
            }
            const std::uint64_t corners = values.list_length(property);
            if (corners < 3)
                values.fail(
                    fmt::format("face {} with {} vertices, expected at least 3", i, corners));
            face_.clear();
            for (std::uint64_t corner = 0; corner < corners; ++corner)
                face_.push_back(read_index(property, vertex_count_, values));
            add_polygon(values.where());
        }
        attributes_.finish_element();
    }
}

void PlyFaces::add_polygon(const SourceLocation &where) {
    if (mesh_.positions.size() == vertex_count_) {
        cut_polygon(face_, where);
        return;
    }
    early_vertices_.insert(early_vertices_.end(), face_.begin(), face_.end());
    early_sizes_.push_back(static_cast<std::uint32_t>(face_.size()));
    early_where_ = {where.file, 0};
}

void PlyFaces::cut_polygon(std::span<const std::uint32_t> vertices, const SourceLocation &where) {
    polygons_.add(vertices, where);
    if (!attributes_.is_empty())
        face_of_.resize(mesh_.triangles.size(), cut_faces_);
    ++cut_faces_;
}

void PlyFaces::read_strips(const PlyElement &element, const std::string &path, PlyValues &values) {
    const PlyProperty &indices = indices_of(element, path);
    for (std::uint64_t i = 0; i < element.count; ++i)
        for (const PlyProperty &property : element.properties) {
            if (&property != &indices) {
                skip(property, values);
                continue;
            }

            // An index of -1 ends a strip and begins the next one.
            face_.clear();
            const std::uint64_t length = values.list_length(property);
            if (const std::string reason = claim_memory(length * sizeof(Mesh::triangles[0]));
                !reason.empty())
                values.fail(reason);
            for (std::uint64_t left = length; left > 0; --left) {
                if (const auto vertex = read_strip_index(property, vertex_count_, values))
                    face_.push_back(*vertex);
                else
                    add_strip();
            }
            add_strip();
        }
}

/// Every second triangle of a strip is turned over; those with a repeated vertex only lead on.
void PlyFaces::add_strip() {
    for (std::size_t i = 2; i < face_.size(); ++i) {
        std::array<std::uint32_t, 3> t{face_[i - 2], face_[i - 1], face_[i]};
        if (i % 2 == 1)
            std::swap(t[0], t[1]);
        if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0])
            mesh_.triangles.push_back(t);
    }
    face_.clear();
}

void PlyFaces::finish() {
    const std::span<const std::uint32_t> all = early_vertices_;
    std::size_t begin = 0;
    for (const std::uint32_t size : early_sizes_) {
        cut_polygon(all.subspan(begin, size), early_where_);
        begin += size;
    }
    polygons_.finish();
    attributes_.move_to(mesh_, &face_of_);
}

/// The element of that name, or nullptr.
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
    return found;
}

} // namespace

Mesh read_ply_mesh(const std::string &path, const MeshReadOptions &options,
                   const SourceLocation &referrer) {
    const std::string bytes = read_input_file(path, referrer);
    const PlyHeader header = parse_ply_header(bytes, path);
    const PlyElement *vertices = find_element(header, "vertex", path);
    const PlyElement *faces = find_element(header, "face", path);
    const PlyElement *strips = find_element(header, "tristrips", path);
    if (vertices == nullptr || vertices->count == 0)
        throw InputError({path, vertices ? vertices->line : 0},
                         "no elements 'vertex', expected a mesh of triangles");
    const bool has_faces = faces != nullptr && faces->count > 0;
    const bool has_strips = strips != nullptr && strips->count > 0;
    if (!has_faces && !has_strips)
        throw InputError({path, faces ? faces->line : 0},
                         "no elements 'face', expected a mesh of triangles");

    warn_of_unread(header, path);

    // At least a triangle for each face; strips claim theirs as they come.
    // Triangles of strips belong to no face.
    static const std::set<std::string> no_attributes;
    PlyAttributes of_vertices(*vertices, "vertex_", options.attributes, path);
    PlyAttributes of_faces(has_faces ? *faces : *strips, "face_",
                           has_strips ? no_attributes : options.attributes, path);
    if (const std::string reason = claim_memory(
            vertices->count * (sizeof(glm::dvec3) + sizeof(glm::vec3) + sizeof(glm::vec2)) +
            of_vertices.bytes(vertices->count) +
            (has_faces ? faces->count * sizeof(Mesh::triangles[0]) : 0) +
            (has_faces ? of_faces.bytes(3 * faces->count) : 0));
        !reason.empty())
        throw InputError({path, vertices->line}, reason);

    // The elements follow in the order of the header.
    Mesh mesh;
    PlyFaces all_faces(mesh, vertices->count, of_faces);
    PlyValues values(bytes, header, path);
    for (const PlyElement &element : header.elements) {
        if (&element == vertices)
            read_vertices(element, path, values, of_vertices, mesh);
        else if (&element == faces && has_faces)
            all_faces.read_polygons(element, path, values);
        else if (&element == strips && has_strips)
            all_faces.read_strips(element, path, values);
        else
            for (std::uint64_t i = 0; i < element.count; ++i)
                for (const PlyProperty &property : element.properties)
                    skip(property, values);
    }
    all_faces.finish();
    of_vertices.move_to(mesh);
    if (mesh.triangles.empty())
        throw InputError({path, 0}, "no strip with three vertices, expected a mesh of triangles");

    if (options.flip_tex_coords)
        for (glm::vec2 &uv : mesh.uvs)
            uv.y = 1 - uv.y;
    set_normals(mesh, options.face_normals);
    return mesh;
}

} // namespace clrender
