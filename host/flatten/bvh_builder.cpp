#include "flatten/bvh_builder.h"

#include "flatten/bvh_collapse.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

namespace clrender {

namespace bvh {

void Box::grow(const glm::vec3 &point) {
    for (int axis = 0; axis < 3; ++axis) {
        lower[axis] = std::min(lower[axis], point[axis]);
        upper[axis] = std::max(upper[axis], point[axis]);
    }
}

void Box::grow(const Box &box) {
    for (int axis = 0; axis < 3; ++axis) {
        lower[axis] = std::min(lower[axis], box.lower[axis]);
        upper[axis] = std::max(upper[axis], box.upper[axis]);
    }
}

double Box::half_area() const {
    if (lower.x > upper.x) {
        return 0.0;
    }
    const double x = double(upper.x) - lower.x;
    const double y = double(upper.y) - lower.y;
    const double z = double(upper.z) - lower.z;
    return x * y + y * z + z * x;
}

namespace {

constexpr int kBins = 16;
/// Below this many primitives a node is built by one thread.
constexpr std::uint32_t kParallelNode = 4096;
/// From this many on even the binning of one node is shared.
constexpr std::uint32_t kParallelBinning = 1 << 17;
/// Deeper than this the binary tree is halved by count, which bounds every recursion over it.
constexpr int kBalancedFrom = 64;

/// Twice the middle of a box; the factor does not matter to the order.
float doubled_centroid(const Primitive &p, int axis) {
    return p.box.lower[axis] + p.box.upper[axis];
}

struct Bin {
    Box box;
    std::uint32_t count = 0;
};

/// Along each axis, the range of the centroids and the primitives sorted into equal slices of it.
class Binning {
public:
    explicit Binning(const Box &centroids) {
        for (int axis = 0; axis < 3; ++axis) {
            const float extent = centroids.upper[axis] - centroids.lower[axis];
            origin_[axis] = centroids.lower[axis];
            // A range so small that its reciprocal overflows counts as flat.
            scale_[axis] = float(kBins) * 0.9999f / extent;
            flat_[axis] = !(extent > 0.0f) || !std::isfinite(scale_[axis]);
        }
    }

    [[nodiscard]] int bin_of(const Primitive &p, int axis) const {
        const float position = (doubled_centroid(p, axis) - origin_[axis]) * scale_[axis];
        return std::min(int(position), kBins - 1);
    }

    void add(const Primitive &p) {
        for (int axis = 0; axis < 3; ++axis) {
            if (!flat_[axis]) {
                Bin &bin = bins_[axis][bin_of(p, axis)];
                bin.box.grow(p.box);
                ++bin.count;
            }
        }
    }

    /// Minima, maxima and counts: the result does not depend on who added what.
    void add(const Binning &other) {
        for (int axis = 0; axis < 3; ++axis) {
            for (int i = 0; i < kBins; ++i) {
                bins_[axis][i].box.grow(other.bins_[axis][i].box);
                bins_[axis][i].count += other.bins_[axis][i].count;
            }
        }
    }

    struct Split {
        int axis = -1; ///< -1: all centroids coincide
        int bin = 0;   ///< first bin of the right side
        double cost = std::numeric_limits<double>::infinity();
    };

    [[nodiscard]] Split cheapest_split() const {
        Split best;
        for (int axis = 0; axis < 3; ++axis) {
            if (!flat_[axis]) {
                search_axis(axis, best);
            }
        }
        return best;
    }

private:
    /// Surface area heuristic: area times count on either side, for each border between two bins.
    void search_axis(int axis, Split &best) const {
        std::array<double, kBins> right_cost{};
        std::array<bool, kBins> right_filled{};
        Bin right;
        for (int i = kBins - 1; i > 0; --i) {
            right.box.grow(bins_[axis][i].box);
            right.count += bins_[axis][i].count;
            right_cost[i] = right.box.half_area() * right.count;
            right_filled[i] = right.count > 0;
        }
        Bin left;
        for (int i = 1; i < kBins; ++i) {
            left.box.grow(bins_[axis][i - 1].box);
            left.count += bins_[axis][i - 1].count;
            const double cost = left.box.half_area() * left.count + right_cost[i];
            if (left.count > 0 && right_filled[i] && cost < best.cost) {
                best = {axis, i, cost};
            }
        }
    }

    std::array<std::array<Bin, kBins>, 3> bins_;
    glm::vec3 origin_{0.0f};
    glm::vec3 scale_{0.0f};
    std::array<bool, 3> flat_{};
};

/// The two boxes a node needs: of its primitives, and of their doubled centroids.
struct Bounds {
    Box box;
    Box centroids;

    void add(const Primitive &p) {
        box.grow(p.box);
        centroids.grow(p.box.lower + p.box.upper);
    }
    void add(const Bounds &other) {
        box.grow(other.box);
        centroids.grow(other.centroids);
    }
};

/// Adds the primitives to `result`, shared among threads when there are many.
template <class Result>
Result reduce(std::span<const Primitive> primitives, const Result &empty, bool parallel) {
    const auto add_range = [&](const tbb::blocked_range<std::size_t> &range, Result partial) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            partial.add(primitives[i]);
        }
        return partial;
    };
    const tbb::blocked_range<std::size_t> all(0, primitives.size(), kParallelBinning / 8);
    if (!parallel || primitives.size() < kParallelBinning) {
        return add_range(all, empty);
    }
    return tbb::parallel_reduce(all, empty, add_range, [](Result a, const Result &b) {
        a.add(b);
        return a;
    });
}

/// Builds the binary tree; the primitives are put into the order of its leaves.
class BinaryBuilder {
public:
    BinaryBuilder(std::vector<Primitive> &primitives, bool parallel)
        : primitives_(primitives), parallel_(parallel), nodes_(2 * primitives.size() - 1) {
        build(0, 0, std::uint32_t(primitives.size()), 0);
    }

    [[nodiscard]] std::vector<BinaryNode> take() { return std::move(nodes_); }

private:
    void build(std::uint32_t index, std::uint32_t begin, std::uint32_t count, int depth) {
        const std::span<Primitive> range(primitives_.data() + begin, count);
        const Bounds bounds = reduce(std::span<const Primitive>(range), Bounds{}, parallel_);
        BinaryNode &node = nodes_[index];
        node = {bounds.box, 0, begin, count};
        if (count == 1) {
            return;
        }

        const std::uint32_t left = split(range, bounds.centroids, depth);
        // Where the pair of children lies depends on the threads; what the tree is does not.
        const std::uint32_t child = next_node_.fetch_add(2, std::memory_order_relaxed);
        node.first_child = child;
        run_both(
            parallel_ && count > kParallelNode, [&] { build(child, begin, left, depth + 1); },
            [&] { build(child + 1, begin + left, count - left, depth + 1); });
    }

    /// Reorders `range` into a left and a right part, neither empty; returns the left one's length.
    std::uint32_t split(std::span<Primitive> range, const Box &centroids, int depth) const {
        if (depth < kBalancedFrom && range.size() > 2) {
            const Binning binning =
                reduce(std::span<const Primitive>(range), Binning(centroids), parallel_);
            const Binning::Split best = binning.cheapest_split();
            if (best.axis >= 0) {
                const auto middle =
                    std::partition(range.begin(), range.end(), [&](const Primitive &p) {
                        return binning.bin_of(p, best.axis) < best.bin;
                    });
                return std::uint32_t(middle - range.begin());
            }
        }
        return split_in_half(range, centroids);
    }

    /// The fallback: equal counts along the longest axis, ties settled by the index.
    static std::uint32_t split_in_half(std::span<Primitive> range, const Box &centroids) {
        const glm::vec3 extent = centroids.upper - centroids.lower;
        int axis = extent.y > extent.x ? 1 : 0;
        axis = extent.z > extent[axis] ? 2 : axis;
        const auto middle = range.begin() + std::ptrdiff_t(range.size() / 2);
        std::nth_element(range.begin(), middle, range.end(),
                         [axis](const Primitive &a, const Primitive &b) {
                             const float ca = doubled_centroid(a, axis);
                             const float cb = doubled_centroid(b, axis);
                             return ca < cb || (ca == cb && a.index < b.index);
                         });
        return std::uint32_t(middle - range.begin());
    }

    std::vector<Primitive> &primitives_;
    bool parallel_;
    std::vector<BinaryNode> nodes_;
    std::atomic<std::uint32_t> next_node_{1};
};

/// NaN rule: a comparison with NaN is false, so a coordinate that is no number is out of range.
bool in_range(const glm::vec3 &p) {
    return std::abs(p.x) <= BVH_COORDINATE_LIMIT && std::abs(p.y) <= BVH_COORDINATE_LIMIT &&
           std::abs(p.z) <= BVH_COORDINATE_LIMIT;
}

/// A triangle whose corners lie on one line is met by no ray. The product is taken in double, where
/// it is exact enough for float32 corners.
bool has_area(const std::array<glm::vec3, 3> &t) {
    using Vector = glm::vec<3, double, glm::defaultp>;
    const Vector a = Vector(t[1]) - Vector(t[0]);
    const Vector b = Vector(t[2]) - Vector(t[0]);
    return a.y * b.z != a.z * b.y || a.z * b.x != a.x * b.z || a.x * b.y != a.y * b.x;
}

std::vector<Primitive> usable_primitives(const Input &input) {
    std::vector<Primitive> primitives;
    primitives.reserve(input.triangles.size() + input.spheres.size());
    for (std::size_t i = 0; i < input.triangles.size(); ++i) {
        const auto &t = input.triangles[i];
        if (in_range(t[0]) && in_range(t[1]) && in_range(t[2]) && has_area(t)) {
            Primitive &p = primitives.emplace_back();
            p.index = std::uint32_t(i);
            p.box.grow(t[0]);
            p.box.grow(t[1]);
            p.box.grow(t[2]);
        }
    }
    for (std::size_t i = 0; i < input.spheres.size(); ++i) {
        const BvhSphere &s = input.spheres[i];
        // The sums round to nearest; one step outwards makes the box contain the sphere.
        const float radius = std::nextafter(s.radius, BVH_COORDINATE_LIMIT);
        const glm::vec3 lower = s.center - radius;
        const glm::vec3 upper = s.center + radius;
        if (s.radius > 0.0f && in_range(lower) && in_range(upper)) {
            Primitive &p = primitives.emplace_back();
            p.index = std::uint32_t(input.triangles.size() + i);
            for (int axis = 0; axis < 3; ++axis) {
                p.box.lower[axis] = std::nextafter(lower[axis], -BVH_COORDINATE_LIMIT);
                p.box.upper[axis] = std::nextafter(upper[axis], BVH_COORDINATE_LIMIT);
            }
        }
    }
    return primitives;
}

} // namespace
} // namespace bvh

Bvh build_bvh(std::span<const std::array<glm::vec3, 3>> triangles,
              std::span<const BvhSphere> spheres, const BvhOptions &options) {
    const bvh::Input input{triangles, spheres};
    std::vector<bvh::Primitive> primitives = bvh::usable_primitives(input);

    Bvh result;
    result.primitives = primitives.size();
    result.degenerate = triangles.size() + spheres.size() - primitives.size();
    std::vector<bvh::BinaryNode> binary;
    if (!primitives.empty()) {
        binary = bvh::BinaryBuilder(primitives, options.parallel).take();
    }
    bvh::collapse(input, primitives, binary, options, result);
    return result;
}

} // namespace clrender
