#pragma once
/// Polygons cut into triangles.

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace clrender {

/// Cuts polygons into triangles that cover them exactly once, seen along their normal (Newell's).
/// Where a fan around the first corner does so, it is the fan; else ears are clipped (Meisters
/// 1975, "Polygons Have Ears"). Polygons may touch themselves, as those with a hole and a bridge to
/// it do, may have repeated corners and corners on a straight line, and need not be plane.
/// Triangles without area are left out, except where the polygon has none at all.
class PolygonCutter {
public:
    using Triangle = std::array<std::uint32_t, 3>; ///< places in the list of corners

    /// Replaces `triangles()` by those of a polygon with at least three corners; they have its
    /// orientation. Returns false where its edges cross (or where it is too intricate for the time
    /// that its length allows): then it is the fan. Tolerates what float32 does to coordinates.
    bool cut(std::span<const glm::dvec3> corners);

    [[nodiscard]] std::span<const Triangle> triangles() const { return triangles_; }

private:
    void cut_fan(std::size_t count);
    bool is_fan_exact(std::span<const glm::dvec3> corners, const glm::dvec3 &normal) const;

    std::vector<Triangle> triangles_;
};

} // namespace clrender
