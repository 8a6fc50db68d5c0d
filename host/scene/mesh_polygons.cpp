#include "mesh_polygons.h"

#include "../log.h"

#include <fmt/format.h>

namespace clrender {

void MeshPolygons::add(std::span<const std::uint32_t> vertices, const SourceLocation &where) {
    ++polygons_;
    if (vertices.size() == 3) {
        mesh_.triangles.push_back({vertices[0], vertices[1], vertices[2]});
        return;
    }
    corners_.clear();
    for (const std::uint32_t vertex : vertices)
        corners_.push_back(mesh_.positions[vertex]);
    if (!cutter_.cut(corners_) && crossed_++ == 0) {
        first_crossed_ = polygons_;
        where_first_ = where;
    }
    for (const auto &[a, b, c] : cutter_.triangles())
        mesh_.triangles.push_back({vertices[a], vertices[b], vertices[c]});
}

void MeshPolygons::finish() const {
    if (crossed_ == 0)
        return;
    const std::string first = fmt::format("polygon {} of the file", first_crossed_);
    const std::string subject =
        crossed_ == 1 ? first + " has"
                      : fmt::format("{} polygons, {} the first, have", crossed_, first);
    log::warn(where_first_, subject + " edges that cross: triangles fan out from the first corner, "
                                      "and may cover more or less than was meant");
}

} // namespace clrender
