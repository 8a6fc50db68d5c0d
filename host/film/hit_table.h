#pragma once
/// What the numbers that the device records of hits stand for.

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace clrender {

/// The primitives of one shape: those from `first` up to the next range.
struct HitRange {
    std::uint32_t first = 0;
    int object = -1;                    ///< index into Scene::object_names; -1: the instance's
    int bsdf = -1;                      ///< index into Scene::bsdfs
    bool is_rectangle = false;          ///< two triangles in Mitsuba, whatever it is here
    std::vector<std::uint32_t> faces{}; ///< of the mesh, by primitive; empty: one after the other
};

struct HitTable {
    std::vector<HitRange> ranges;      ///< in the order of their primitives
    std::vector<int> instance_objects; ///< by instance of the device: index as HitRange::object
    glm::dvec3 center{0.0};            ///< the renderer's coordinates are (p - center) * scale
    double scale = 1;
    glm::dvec3 eye{0.0}, axis{0.0, 0.0, 1.0}; ///< of the camera, in scene coordinates

    /// The range of a primitive. There is one.
    [[nodiscard]] const HitRange &range_of(std::uint32_t prim) const;
    /// Index of the object that a primitive, of an instance or of none (-1), belongs to.
    [[nodiscard]] int object_of(std::uint32_t prim, int instance) const;
};

} // namespace clrender
