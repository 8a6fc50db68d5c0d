#pragma once
/// The second half of the build: from the binary tree to the 8-wide one. Internal to
/// bvh_builder.cpp.

#include "flatten/bvh_builder.h"

#include <cstdint>
#include <limits>

namespace clrender::bvh {

struct Box {
    glm::vec3 lower{std::numeric_limits<float>::max()};
    glm::vec3 upper{-std::numeric_limits<float>::max()};

    void grow(const glm::vec3 &point);
    void grow(const Box &box);
    /// Half the surface, 0 when nothing was added. In double: float32 overflows at 1e19 across.
    [[nodiscard]] double half_area() const;
};

/// One triangle (`index` into the triangles) or sphere (the number of triangles + its index).
struct Primitive {
    Box box;
    std::uint32_t index = 0;
};

/// A node of the binary tree over `Primitive`s [begin, begin + count). The two children lie side by
/// side; a leaf has none and holds one primitive.
struct BinaryNode {
    Box box;
    std::uint32_t first_child = 0;
    std::uint32_t begin = 0;
    std::uint32_t count = 0;

    [[nodiscard]] bool is_leaf() const { return first_child == 0; }
};

/// The scene as both halves of the build see it.
struct Input {
    std::span<const std::array<glm::vec3, 3>> triangles;
    std::span<const BvhSphere> spheres;

    [[nodiscard]] bool is_sphere(const Primitive &p) const { return p.index >= triangles.size(); }
};

/// Fills nodes, blocks, levels and cost of `bvh` from the binary tree, whose root is `binary[0]`.
void collapse(const Input &input, std::span<const Primitive> primitives,
              std::span<const BinaryNode> binary, const BvhOptions &options, Bvh &bvh);

/// The two tasks, side by side when they are large and `options` allow it.
template <class Left, class Right>
void run_both(bool parallel, const Left &left, const Right &right);

} // namespace clrender::bvh

#include <tbb/parallel_invoke.h>

template <class Left, class Right>
void clrender::bvh::run_both(bool parallel, const Left &left, const Right &right) {
    if (parallel) {
        tbb::parallel_invoke(left, right);
    } else {
        left();
        right();
    }
}
