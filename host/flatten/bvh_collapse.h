#pragma once
/// The second half of the build: from the binary tree to the 8-wide one. Internal to
/// bvh_builder.cpp.

#include "flatten/bvh_builder.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

namespace clrender::inline CLR_PRECISION::bvh {

/// Three coordinates, stored as four: then one vector instruction treats them all.
struct alignas(16) Point {
    clr_real c[4];

    Point() = default;
    explicit Point(clr_real all) : c{all, all, all, all} {}
    explicit Point(const Vec3 &p) : c{p.x, p.y, p.z, p.z} {}
    clr_real &operator[](int axis) { return c[axis]; }
    clr_real operator[](int axis) const { return c[axis]; }
};

template <class Operation>
Point each_of(const Point &a, const Point &b, const Operation &operation) {
    Point result;
    for (int i = 0; i < 4; ++i) {
        result.c[i] = operation(a.c[i], b.c[i]);
    }
    return result;
}

inline Point min(const Point &a, const Point &b) {
    return each_of(a, b, [](clr_real x, clr_real y) { return y < x ? y : x; });
}
inline Point max(const Point &a, const Point &b) {
    return each_of(a, b, [](clr_real x, clr_real y) { return x < y ? y : x; });
}
inline Point operator+(const Point &a, const Point &b) {
    return each_of(a, b, [](clr_real x, clr_real y) { return x + y; });
}
inline Point operator-(const Point &a, const Point &b) {
    return each_of(a, b, [](clr_real x, clr_real y) { return x - y; });
}
inline Point operator*(const Point &a, const Point &b) {
    return each_of(a, b, [](clr_real x, clr_real y) { return x * y; });
}

struct Box {
    Point lower{std::numeric_limits<clr_real>::max()};
    Point upper{-std::numeric_limits<clr_real>::max()};

    void grow(const Point &point) {
        lower = min(lower, point);
        upper = max(upper, point);
    }
    void grow(const Box &box) {
        lower = min(lower, box.lower);
        upper = max(upper, box.upper);
    }
    /// Half the surface in units of 1 / scale^2; 0 when nothing was added. The scale keeps the
    /// product of large coordinates finite.
    [[nodiscard]] clr_real half_area(clr_real scale) const {
        const Point size = (upper - lower) * Point(scale);
        return lower[0] > upper[0] ? 0.0f
                                   : size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
    }
};

/// One triangle, sphere, quadric or instance, numbered through in this order. `weight` is its share
/// of a block, in BVH_WIDTH-ths.
struct Primitive {
    clr_real lower[3];
    std::uint32_t index;
    clr_real upper[3];
    std::uint32_t weight;

    void set(const Box &box, std::uint32_t number, std::uint32_t share = 1) {
        *this = {{box.lower[0], box.lower[1], box.lower[2]},
                 number,
                 {box.upper[0], box.upper[1], box.upper[2]},
                 share};
    }
    [[nodiscard]] Box box() const {
        Box box;
        box.lower = Point({lower[0], lower[1], lower[2]});
        box.upper = Point({upper[0], upper[1], upper[2]});
        return box;
    }
};
static_assert(sizeof(Primitive) == 8 * sizeof(clr_real));

/// A node of the binary tree over `Primitive`s [begin, begin + count). The two children lie side by
/// side; a leaf has none and holds what fits into one block: up to eight primitives of one kind, or
/// one instance.
struct BinaryNode {
    Box box;
    std::uint32_t first_child = 0;
    std::uint32_t begin = 0;
    std::uint32_t count = 0;

    [[nodiscard]] bool is_leaf() const { return first_child == 0; }
};

/// The scene as both halves of the build see it.
struct Input {
    std::span<const std::array<Vec3, 3>> triangles;
    std::span<const BvhSphere> spheres;
    std::span<const BvhQuadric> quadrics;
    std::span<const BvhInstance> instances;

    [[nodiscard]] std::size_t first_quadric() const { return triangles.size() + spheres.size(); }
    [[nodiscard]] std::size_t first_instance() const { return first_quadric() + quadrics.size(); }
    /// What a child that holds the primitive is.
    enum class Kind { triangle, sphere, quadric, instance };
    [[nodiscard]] Kind kind_of(const Primitive &p) const {
        return p.index < triangles.size()   ? Kind::triangle
               : p.index < first_quadric()  ? Kind::sphere
               : p.index < first_instance() ? Kind::quadric
                                            : Kind::instance;
    }

    /// Whether these fit into one block.
    [[nodiscard]] bool is_block(std::span<const Primitive> primitives) const {
        const bool one_kind = instances.empty() && (triangles.empty() || spheres.empty()) &&
                              (quadrics.empty() || first_quadric() == 0);
        return primitives.size() <= 1 ||
               (primitives.size() <= BVH_WIDTH &&
                (one_kind ||
                 std::all_of(primitives.begin(), primitives.end(), [&](const Primitive &p) {
                     return kind_of(p) != Kind::instance && kind_of(p) == kind_of(primitives[0]);
                 })));
    }
};

/// Fills nodes, blocks, levels and cost of `bvh` from the binary tree, whose root is `binary[0]`.
void collapse(const Input &input, std::span<const Primitive> primitives,
              std::span<const BinaryNode> binary, const BvhOptions &options, Bvh &bvh);

/// The two tasks, side by side when they are large and `options` allow it.
template <class Left, class Right>
void run_both(bool parallel, const Left &left, const Right &right);

} // namespace clrender::inline CLR_PRECISION::bvh

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
