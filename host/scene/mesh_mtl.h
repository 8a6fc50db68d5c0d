#pragma once
/// Materials of OBJ files.

#include "mesh_io.h"

namespace clrender {

/// Reads an MTL file; colours are as in the file, `diffuse` stays at its default where the file
/// states neither Kd nor map_Kd nor another colour. Throws InputError with file and line.
std::vector<ObjMaterial> read_mtl(const std::string &path, const SourceLocation &referrer);

} // namespace clrender
