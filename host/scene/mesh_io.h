#pragma once
/// Triangle meshes from files.

#include "scene.h"

#include <optional>
#include <set>
#include <string>
#include <vector>

namespace clrender {

struct MeshReadOptions {
    bool face_normals = false;    ///< drop vertex normals: flat shading
    bool flip_tex_coords = false; ///< v -> 1 - v (the readers' callers know Mitsuba's defaults)
    int shape_index = 0;          ///< of a .serialized file: which of its meshes
    /// Names of attributes to read; if there are none, the mesh does not list what it has.
    std::set<std::string> attributes{};
};

/// One group of an OBJ file: its triangles and the MTL material they name ("" if none).
struct ObjPart {
    std::string material;
    Mesh mesh;
};

/// A texture of an MTL file.
struct ObjMap {
    std::string file;      ///< path of a file that is there; "" if none
    SourceLocation where;  ///< the line that names it
    glm::dmat3 to_uv{1.0}; ///< as Texture::to_uv
    bool is_clamped = false;
    double scale = 1; ///< -bm, of bump maps

    [[nodiscard]] bool is_there() const { return !file.empty(); }
};

/// What an MTL file says of a material, as far as we render it, with the extension for physically
/// based rendering (Pr, Pm, Ps, Pc, Pcr, aniso, norm).
struct ObjMaterial {
    std::string name; ///< words with one blank in between
    Rgb diffuse{0.5};
    Rgb specular{0.0}, emission{0.0};
    std::optional<double> exponent, ior; ///< Ns, Ni
    double dissolve = 1;
    int illum = 2;
    std::optional<double> roughness, metallic, sheen, clearcoat, clearcoat_roughness, anisotropy;
    ObjMap diffuse_map, opacity_map, normal_map, bump_map;
    ObjMap roughness_map, metallic_map, sheen_map;
};

/// The kind of surface that a material is rendered as.
enum class ObjSurface { diffuse, mirror, rough_metal, glass, glossy, principled };
ObjSurface surface_of(const ObjMaterial &material);

struct ObjFile {
    std::vector<ObjPart> parts;
    std::vector<ObjMaterial> materials;
};

/// All triangles of an OBJ file as one mesh, as Mitsuba's `obj` reads it (materials ignored,
/// polygons cut into triangles, normals as Mitsuba gives them). Errors name `path` and the line, or
/// `referrer` if the file cannot be opened. Throws InputError.
Mesh read_obj_mesh(const std::string &path, const MeshReadOptions &options,
                   const SourceLocation &referrer = {});

/// The same file split by material, for rendering a bare model.
ObjFile read_obj_file(const std::string &path);

/// ASCII and binary (both byte orders) PLY. Throws InputError.
Mesh read_ply_mesh(const std::string &path, const MeshReadOptions &options,
                   const SourceLocation &referrer = {});

/// One of the meshes of a .serialized file, as Mitsuba's `serialized` reads it. Throws InputError.
Mesh read_serialized_mesh(const std::string &path, const MeshReadOptions &options,
                          const SourceLocation &referrer = {});

} // namespace clrender
