#pragma once
/// Materials of OBJ files.

#include "mesh_io.h"

namespace clrender {

/// Reads an MTL file; colours are as in the file, `diffuse` stays at its default where the file
/// states neither Kd nor another colour. Textures that are not there and statements that are not
/// rendered are warned of. Throws InputError with file and line.
std::vector<ObjMaterial> read_mtl(const std::string &path, const SourceLocation &referrer);

/// The files that an mtllib line names, with `names` the text behind that word: several names, or
/// one with blanks in it. Warns of those that are not there.
std::vector<std::string> find_libraries(const std::string &folder, const std::string &names,
                                        const SourceLocation &where);

} // namespace clrender
