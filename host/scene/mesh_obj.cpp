/// OBJ files, through tinyobjloader: it parses the numbers of lines that have been checked, we
/// resolve and check the indices, join equal corners and cut polygons into triangles.

#include "../log.h"
#include "mesh_io.h"
#include "mesh_mtl.h"
#include "mesh_normals.h"
#include "mesh_polygons.h"
#include "obj_lines.h"

#define TINYOBJLOADER_USE_DOUBLE
#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>

#include <fmt/format.h>

#include <algorithm>
#include <climits>
#include <filesystem>
#include <istream>
#include <iterator>
#include <set>
#include <unordered_map>
#include <utility>

namespace clrender {

namespace {

const std::string vertex_colors = "vertex_color";
/// Of vertices without a colour, where others have one.
constexpr glm::vec3 no_color(1);

/// One vertex of the mesh: indices from 0 into the file's v, vt and vn lists; none = absent.
struct Corner {
    int position = none, uv = none, normal = none;
    bool operator==(const Corner &) const = default;
};

struct CornerHash {
    std::size_t operator()(const Corner &corner) const {
        // The finaliser of SplitMix64 over the three indices.
        auto mix = [](std::uint64_t x) {
            x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
            x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
            return x ^ (x >> 31);
        };
        const auto word = [](int i) { return static_cast<std::uint32_t>(i); };
        const std::uint64_t high = mix(word(corner.position) + 0x9e3779b97f4a7c15ULL);
        return mix(high ^ (std::uint64_t{word(corner.uv)} << 32 | word(corner.normal)));
    }
};

/// Collects what the parser finds; vertices get numbered in the order of their first use.
class ObjBuilder {
public:
    ObjBuilder(const std::string &path, const SourceLocation &referrer,
               const MeshReadOptions &options)
        : lines_(path, referrer, [this](std::string &line) { return filter(line); }),
          folder_(std::filesystem::path(path).parent_path()), flip_(options.flip_tex_coords),
          lists_attributes_(!options.attributes.empty()),
          wants_colors_(options.attributes.count(vertex_colors) != 0) {}

    /// Reads the file to its end. Throws InputError.
    void read();

    [[nodiscard]] std::string folder() const { return folder_.string(); }

    Mesh mesh;                          ///< normals may be zero vectors: none stated
    std::vector<int> triangle_material; ///< per triangle: index into materials, or none
    std::vector<std::pair<std::string, SourceLocation>> materials; ///< names and where first used
    std::vector<std::pair<std::string, SourceLocation>> libraries; ///< mtllib: names, and where

private:
    std::string filter(std::string &line);
    void note_color(const std::string &line);
    void add_colors();
    void add_face(const tinyobj::index_t *corners, int count);
    std::uint32_t vertex(const tinyobj::index_t &index);
    int resolve(int index, std::size_t count, const char *what) const;

    ObjLines lines_;
    std::filesystem::path folder_;
    bool flip_, lists_attributes_, wants_colors_;
    std::vector<glm::dvec3> positions_;
    std::vector<glm::vec3> colors_;          ///< of the first so many positions
    std::vector<std::uint32_t> position_of_; ///< by vertex; only where colours are wanted
    std::vector<glm::vec3> normals_;
    std::vector<glm::vec2> uvs_;
    std::unordered_map<Corner, std::uint32_t, CornerHash> vertices_;
    std::unordered_map<std::string, int> material_indices_;
    int material_ = none;
    bool has_surfaces_ = false;
    std::vector<std::uint32_t> face_; ///< the vertices of the face at hand
    MeshPolygons polygons_{mesh};
};

void ObjBuilder::read() {
    // The parser calls back for each line that it meets, with the numbers in it.
    tinyobj::callback_t callbacks;
    callbacks.vertex_cb = [](void *user, double x, double y, double z, double) {
        static_cast<ObjBuilder *>(user)->positions_.emplace_back(x, y, z);
    };
    callbacks.normal_cb = [](void *user, double x, double y, double z) {
        const glm::dvec3 normal(x, y, z);
        const double length = glm::length(normal);
        static_cast<ObjBuilder *>(user)->normals_.emplace_back(
            length > 0 ? glm::vec3(normal / length) : glm::vec3(0.0F));
    };
    callbacks.texcoord_cb = [](void *user, double u, double v, double) {
        auto *builder = static_cast<ObjBuilder *>(user);
        builder->uvs_.emplace_back(glm::dvec2(u, builder->flip_ ? 1 - v : v));
    };
    callbacks.index_cb = [](void *user, tinyobj::index_t *corners, int count) {
        static_cast<ObjBuilder *>(user)->add_face(corners, count);
    };

    std::istream stream(&lines_);
    stream.exceptions(std::ios::badbit);
    std::string warning;
    std::string error;
    tinyobj::LoadObjWithCallback(stream, callbacks, this, nullptr, &warning, &error);
    if (mesh.triangles.empty())
        throw InputError({lines_.where().file, 0}, "no faces, expected at least one f line");
    polygons_.finish();

    // Mitsuba gives coordinates to every vertex as soon as the file has any.
    if (uvs_.empty())
        mesh.uvs.clear();
    if (normals_.empty())
        mesh.normals.clear();
    add_colors();
}

std::string ObjBuilder::filter(std::string &line) {
    // Materials are followed here, because their names may contain blanks.
    const std::string_view text = line;
    const std::size_t begin = text.find_first_not_of(" \t");
    const std::string_view keyword = text.substr(begin, text.find_first_of(" \t", begin) - begin);
    const bool is_use = keyword == "usemtl";
    const bool keyword_is_vertex = keyword == "v";
    if (keyword == "surf" && !std::exchange(has_surfaces_, true))
        log::warn(lines_.where(), "curved surfaces (surf) are left out, expected polygons");
    if (!is_use && keyword != "mtllib") {
        std::string reason = check_obj_line(line);
        if (reason.empty() && lists_attributes_ && keyword_is_vertex)
            note_color(line);
        return reason;
    }

    const std::string name = joined_words(text.substr(begin + keyword.size()));
    if (!is_use) {
        libraries.emplace_back(name, lines_.where());
    } else {
        const auto [entry, is_new] =
            material_indices_.try_emplace(name, static_cast<int>(materials.size()));
        if (is_new)
            materials.emplace_back(name, lines_.where());
        material_ = entry->second;
    }
    line.clear();
    return {};
}

/// The colour of a vertex stands behind its place: v x y z r g b.
void ObjBuilder::note_color(const std::string &line) {
    const std::vector<std::string_view> words = split_words(line);
    if (words.size() < 7)
        return;
    glm::vec3 color;
    for (std::size_t c = 0; c < 3; ++c)
        color[static_cast<int>(c)] = std::strtof(std::string(words[4 + c]).c_str(), nullptr);
    colors_.resize(positions_.size(), no_color);
    colors_.push_back(color);
}

void ObjBuilder::add_colors() {
    if (colors_.empty())
        return;
    colors_.resize(positions_.size(), no_color);
    MeshAttribute attribute;
    attribute.name = vertex_colors;
    for (const std::uint32_t position : position_of_)
        for (int c = 0; c < 3; ++c)
            attribute.values.push_back(colors_[position][c]);
    mesh.attributes.push_back(std::move(attribute));
}

void ObjBuilder::add_face(const tinyobj::index_t *corners, int count) {
    face_.clear();
    for (int i = 0; i < count; ++i)
        face_.push_back(vertex(corners[i]));
    polygons_.add(face_, lines_.where());
    triangle_material.resize(mesh.triangles.size(), material_);
}

std::uint32_t ObjBuilder::vertex(const tinyobj::index_t &index) {
    const Corner corner{resolve(index.vertex_index, positions_.size(), "vertex"),
                        resolve(index.texcoord_index, uvs_.size(), "texture coordinate"),
                        resolve(index.normal_index, normals_.size(), "normal")};
    const auto id = static_cast<std::uint32_t>(mesh.positions.size());
    const auto [entry, is_new] = vertices_.try_emplace(corner, id);
    if (is_new) {
        const auto at = [](const auto &list, int i) { return list[static_cast<std::size_t>(i)]; };
        mesh.positions.push_back(at(positions_, corner.position));
        if (wants_colors_)
            position_of_.push_back(static_cast<std::uint32_t>(corner.position));
        mesh.uvs.push_back(corner.uv == none ? glm::vec2(0.0F) : at(uvs_, corner.uv));
        mesh.normals.push_back(corner.normal == none ? glm::vec3(0.0F)
                                                     : at(normals_, corner.normal));
    }
    return entry->second;
}

/// Counts positive indices from 1 and negative ones from the end of what has been read so far.
int ObjBuilder::resolve(int index, std::size_t count, const char *what) const {
    if (index == 0)
        return none;
    const auto size = static_cast<std::int64_t>(count);
    const std::int64_t resolved = index > 0 ? index - std::int64_t{1} : size + index;
    if (resolved < 0 || resolved >= std::min<std::int64_t>(size, INT_MAX))
        throw InputError(lines_.where(),
                         fmt::format("{} {} does not exist, expected an index from 1 to {} (the "
                                     "number read so far), or its negative",
                                     what, index, size));
    return static_cast<int>(resolved);
}

/// Says which materials no library has.
void warn_of_unknown(const std::vector<std::pair<std::string, SourceLocation>> &used,
                     const std::vector<ObjMaterial> &known) {
    std::set<std::string> names{""}; // "usemtl" alone: none
    for (const ObjMaterial &material : known)
        names.insert(material.name);
    std::vector<std::pair<std::string, SourceLocation>> unknown;
    std::copy_if(used.begin(), used.end(), std::back_inserter(unknown),
                 [&](const auto &material) { return names.count(material.first) == 0; });
    if (unknown.empty())
        return;
    const std::string more =
        unknown.size() > 1 ? fmt::format(" (and {} more)", unknown.size() - 1) : "";
    log::warn(unknown[0].second, "the material " + clrender::quoted(unknown[0].first) + more +
                                     " is in no mtllib: plain grey is used");
}

/// The triangles `selected` of `mesh` with the vertices that they use. `new_index` is scratch
/// memory for all parts: entries of other parts are recognised by `stamp`.
Mesh extract(const Mesh &mesh, const std::vector<std::uint32_t> &selected,
             std::vector<std::pair<int, std::uint32_t>> &new_index, int stamp) {
    Mesh part;
    for (const MeshAttribute &attribute : mesh.attributes) {
        part.attributes.push_back(attribute);
        part.attributes.back().values.clear();
    }
    part.triangles.reserve(selected.size());
    for (const std::uint32_t t : selected) {
        std::array<std::uint32_t, 3> triangle = mesh.triangles[t];
        for (std::uint32_t &v : triangle) {
            auto &[seen_by, id] = new_index[v];
            if (seen_by != stamp) {
                seen_by = stamp;
                id = static_cast<std::uint32_t>(part.positions.size());
                part.positions.push_back(mesh.positions[v]);
                if (!mesh.normals.empty())
                    part.normals.push_back(mesh.normals[v]);
                if (!mesh.uvs.empty())
                    part.uvs.push_back(mesh.uvs[v]);
                for (std::size_t a = 0; a < mesh.attributes.size(); ++a)
                    for (std::size_t c = 0; c < 3; ++c)
                        part.attributes[a].values.push_back(
                            mesh.attributes[a].values[std::size_t{3} * v + c]);
            }
            v = id;
        }
        part.triangles.push_back(triangle);
    }
    return part;
}

} // namespace

Mesh read_obj_mesh(const std::string &path, const MeshReadOptions &options,
                   const SourceLocation &referrer) {
    ObjBuilder builder(path, referrer, options);
    builder.read();
    set_normals(builder.mesh, options.face_normals);
    return std::move(builder.mesh);
}

ObjFile read_obj_file(const std::string &path) {
    ObjBuilder builder(path, {}, {.flip_tex_coords = true, .attributes = {vertex_colors}});
    builder.read();
    complete_normals(builder.mesh);

    // A missing material file costs the colours, not the picture.
    ObjFile file;
    bool all_found = true;
    for (const auto &[names, where] : builder.libraries) {
        const auto paths = find_libraries(builder.folder(), names, where);
        all_found = all_found && !paths.empty();
        for (const std::string &library : paths)
            for (ObjMaterial &material : read_mtl(library, where))
                file.materials.push_back(std::move(material));
    }
    if (all_found)
        warn_of_unknown(builder.materials, file.materials);

    // One part for each material, in the order of their first `usemtl`, after the unnamed triangles
    // (material none = -1, which the unsigned sum below takes to 0).
    std::vector<std::vector<std::uint32_t>> triangles_of(builder.materials.size() + 1);
    for (std::size_t t = 0; t < builder.triangle_material.size(); ++t)
        triangles_of[static_cast<std::size_t>(builder.triangle_material[t]) + 1].push_back(
            static_cast<std::uint32_t>(t));
    std::vector<std::pair<int, std::uint32_t>> new_index(builder.mesh.positions.size(), {none, 0});
    for (std::size_t m = 0; m < triangles_of.size(); ++m)
        if (!triangles_of[m].empty())
            file.parts.push_back(
                {m == 0 ? "" : builder.materials[m - 1].first,
                 extract(builder.mesh, triangles_of[m], new_index, static_cast<int>(m))});
    return file;
}

} // namespace clrender
