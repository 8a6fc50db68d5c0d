#pragma once
/// Triangle meshes from files.

#include "scene.h"

#include <string>
#include <vector>

namespace clrender {

struct MeshReadOptions {
    bool face_normals = false;    ///< drop vertex normals: flat shading
    bool flip_tex_coords = false; ///< v -> 1 - v (the readers' callers know Mitsuba's defaults)
};

/// One group of an OBJ file: its triangles and the MTL material they name ("" if none).
struct ObjPart {
    std::string material;
    Mesh mesh;
};

/// What an MTL file says of a material, as far as we render it.
struct ObjMaterial {
    std::string name; ///< words with one blank in between
    Rgb diffuse{0.5};
    std::string diffuse_map;   ///< path of a file that is there; "" if none
    SourceLocation where_map;  ///< the line that names it
    glm::dmat3 map_to_uv{1.0}; ///< as Texture::to_uv
    bool is_map_clamped = false;
    Rgb specular{0.0}, emission{0.0};
    double ior = 1.5, dissolve = 1;
    int illum = 2;
};

/// The one kind of surface that a material is rendered as.
enum class ObjSurface { diffuse, mirror, glass };
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

} // namespace clrender
