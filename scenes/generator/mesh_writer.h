#pragma once
#include "surface.h"
#include <cstdint>
#include <string>

struct MeshCounts {
    uint64_t vertices = 0, triangles = 0;
};

/// Writes the surface as an OBJ file of about `triangles` triangles with normals and texture
/// coordinates. Vertices on a seam of the texture are written once for each side, with equal
/// positions and normals to the last digit. Needs memory for a few rows only. Throws
/// std::runtime_error where the file cannot be written.
MeshCounts write_obj(const Surface &surface, double triangles, const std::string &path);
