#pragma once
/// The polygons of a mesh file on their way to the triangles of a Mesh.

#include "../error.h"
#include "polygon.h"
#include "scene.h"

#include <cstdint>
#include <span>
#include <vector>

namespace clrender {

class MeshPolygons {
public:
    explicit MeshPolygons(Mesh &mesh) : mesh_(mesh) {}

    /// Appends the triangles of a polygon with three corners or more, given as vertices of the
    /// mesh.
    void add(std::span<const std::uint32_t> vertices, const SourceLocation &where);

    /// Warns once of all polygons that could not be cut rightly.
    void finish() const;

private:
    Mesh &mesh_;
    PolygonCutter cutter_;
    std::vector<glm::dvec3> corners_;
    std::size_t polygons_ = 0, crossed_ = 0, first_crossed_ = 0;
    SourceLocation where_first_;
};

} // namespace clrender
