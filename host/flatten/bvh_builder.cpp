#include "flatten/bvh_builder.h"

#include "flatten/bvh_collapse.h"
#include "flatten/large_array.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

namespace clrender::inline CLR_PRECISION {

namespace bvh {

namespace {

constexpr std::uint32_t kUnusable = 0xffffffffu;
constexpr int kBins = 32;
/// Small nodes do with fewer bins, this many and one for each eight primitives.
constexpr std::uint32_t kFewestBins = 8;
/// Below this many primitives a node is built by one thread.
constexpr std::uint32_t kParallelNode = 4096;
/// From this many on even the binning of one node is shared.
constexpr std::uint32_t kParallelBinning = 1 << 17;
/// Deeper than this the binary tree is halved by count, which bounds every recursion over it.
constexpr int kBalancedFrom = 64;

/// Twice the middle of a box; the factor does not matter to the order.
clr_real doubled_centroid(const Primitive &p, int axis) {
    return p.lower[axis] + p.upper[axis];
}

/// Blocks that so many primitives fill.
clr_real blocks_of(std::uint32_t count) {
    const std::uint32_t blocks = (count + BVH_WIDTH - 1) / BVH_WIDTH;
    return clr_real(blocks);
}

struct Bin {
    Box box;
    std::uint32_t count = 0; ///< by the weights of its primitives
};

/// The two boxes a node needs: of its primitives, and of their doubled centroids.
struct Bounds {
    Box box;
    Box centroids;

    void add(const Primitive &p) {
        const Box other = p.box();
        box.grow(other);
        centroids.grow(other.lower + other.upper);
    }
    void add(const Bounds &other) {
        box.grow(other.box);
        centroids.grow(other.centroids);
    }
};

/// Along each axis, the range of the centroids and the primitives sorted into equal slices of it.
class Binning {
public:
    Binning(const Box &centroids, std::uint32_t count)
        : bin_count_(int(std::min<std::uint32_t>(kBins, kFewestBins + count / BVH_WIDTH))),
          origin_(centroids.lower) {
        for (int axis = 0; axis < 3; ++axis) {
            const clr_real extent = centroids.upper[axis] - centroids.lower[axis];
            scale_[axis] = clr_real(bin_count_) * 0.9999f / extent;
            // A range so small that its reciprocal overflows counts as flat.
            flat_[axis] = !(extent > 0.0f) || !std::isfinite(scale_[axis]);
            if (flat_[axis]) {
                scale_[axis] = 0.0f;
            }
        }
        scale_[3] = 0.0f;
    }

    [[nodiscard]] int bin_of(const Primitive &p, int axis) const {
        const clr_real position = (doubled_centroid(p, axis) - origin_[axis]) * scale_[axis];
        return std::min(int(position), bin_count_ - 1);
    }

    void add(const Primitive &p) {
        const Box box = p.box();
        const Point position = ((box.lower + box.upper) - origin_) * scale_;
        for (int axis = 0; axis < 3; ++axis) {
            Bin &bin = bins_[axis][std::min(int(position[axis]), bin_count_ - 1)];
            bin.box.grow(box);
            bin.count += p.weight;
        }
    }

    /// Minima, maxima and counts: the result does not depend on who added what.
    void add(const Binning &other) {
        for (int axis = 0; axis < 3; ++axis) {
            for (int i = 0; i < bin_count_; ++i) {
                bins_[axis][i].box.grow(other.bins_[axis][i].box);
                bins_[axis][i].count += other.bins_[axis][i].count;
            }
        }
    }

    struct Split {
        int axis = -1; ///< -1: all centroids coincide
        int bin = 0;   ///< first bin of the right side
        clr_real cost = std::numeric_limits<clr_real>::infinity();
    };

    /// `scale` is the reciprocal of the tree's size.
    [[nodiscard]] Split cheapest_split(clr_real scale) const {
        Split best;
        for (int axis = 0; axis < 3; ++axis) {
            if (!flat_[axis]) {
                search_axis(axis, scale, best);
            }
        }
        return best;
    }

private:
    /// Surface area heuristic: area times blocks on either side, for each border between two bins.
    void search_axis(int axis, clr_real scale, Split &best) const {
        std::array<clr_real, kBins> right_cost;
        std::array<std::uint32_t, kBins> right_count;
        Bin right;
        for (int i = bin_count_ - 1; i > 0; --i) {
            right.box.grow(bins_[axis][i].box);
            right.count += bins_[axis][i].count;
            right_cost[i] = right.box.half_area(scale) * blocks_of(right.count);
            right_count[i] = right.count;
        }
        Bin left;
        for (int i = 1; i < bin_count_; ++i) {
            left.box.grow(bins_[axis][i - 1].box);
            left.count += bins_[axis][i - 1].count;
            const clr_real cost = left.box.half_area(scale) * blocks_of(left.count) + right_cost[i];
            if (left.count > 0 && right_count[i] > 0 && cost < best.cost) {
                best = {axis, i, cost};
            }
        }
    }

    std::array<std::array<Bin, kBins>, 3> bins_;
    int bin_count_;
    Point origin_;
    Point scale_;
    std::array<bool, 3> flat_{};
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
    BinaryBuilder(const Input &input, std::span<Primitive> primitives, bool parallel)
        : input_(input), primitives_(primitives), parallel_(parallel),
          // Only what is written to takes memory, a third of it as a rule.
          nodes_(2 * primitives.size()) {
        const Bounds bounds = reduce(std::span<const Primitive>(primitives), Bounds{}, parallel);
        const Point size = bounds.box.upper - bounds.box.lower;
        const clr_real largest = std::max({size[0], size[1], size[2]});
        scale_ = largest > 0.0f ? std::min(1.0f / largest, kLargestScale) : 1.0f;
        build(0, {0, std::uint32_t(primitives.size()), bounds}, 0);
    }

    [[nodiscard]] std::span<const BinaryNode> nodes() const {
        return {nodes_.data(), next_node_.load()};
    }

private:
    /// Or the scale of a tree without extent would be infinite.
    static constexpr clr_real kLargestScale = 1e30f;

    struct Part {
        std::uint32_t begin, count;
        Bounds bounds;
    };

    void build(std::uint32_t index, const Part &part, int depth) {
        BinaryNode &node = nodes_[index];
        node = {part.bounds.box, 0, part.begin, part.count};
        if (input_.is_block(primitives_.subspan(part.begin, part.count))) {
            return;
        }

        const std::pair<Part, Part> parts = split(part, depth);
        // Where the pair of children lies depends on the threads; what the tree is does not.
        const std::uint32_t child = next_node_.fetch_add(2, std::memory_order_relaxed);
        node.first_child = child;
        run_both(
            parallel_ && part.count > kParallelNode, [&] { build(child, parts.first, depth + 1); },
            [&] { build(child + 1, parts.second, depth + 1); });
    }

    /// Reorders the primitives of `part` into a left and a right part, neither empty.
    [[nodiscard]] std::pair<Part, Part> split(const Part &part, int depth) const {
        const std::span<Primitive> range = primitives_.subspan(part.begin, part.count);
        if (depth < kBalancedFrom && part.count > 2) {
            const Binning binning = reduce(std::span<const Primitive>(range),
                                           Binning(part.bounds.centroids, part.count), parallel_);
            const Binning::Split best = binning.cheapest_split(scale_);
            if (best.axis >= 0) {
                return partition(part, [&](const Primitive &p) {
                    return binning.bin_of(p, best.axis) < best.bin;
                });
            }
        }
        return split_in_half(part);
    }

    /// Those of which `is_left` is true to the left, and the bounds of both on the way.
    template <class IsLeft>
    [[nodiscard]] std::pair<Part, Part> partition(const Part &part, const IsLeft &is_left) const {
        Primitive *low = primitives_.data() + part.begin;
        Primitive *high = low + part.count;
        Bounds left, right;
        while (low < high) {
            if (is_left(*low)) {
                left.add(*low++);
            } else {
                right.add(*low);
                std::swap(*low, *--high);
            }
        }
        const auto middle = std::uint32_t(low - primitives_.data());
        return {{part.begin, middle - part.begin, left},
                {middle, part.begin + part.count - middle, right}};
    }

    /// The fallback: equal counts along the longest axis, ties settled by the index.
    [[nodiscard]] std::pair<Part, Part> split_in_half(const Part &part) const {
        const std::span<Primitive> range = primitives_.subspan(part.begin, part.count);
        const Point extent = part.bounds.centroids.upper - part.bounds.centroids.lower;
        int axis = extent[1] > extent[0] ? 1 : 0;
        axis = extent[2] > extent[axis] ? 2 : axis;
        const std::uint32_t half = part.count / 2;
        std::nth_element(range.begin(), range.begin() + half, range.end(),
                         [axis](const Primitive &a, const Primitive &b) {
                             const clr_real ca = doubled_centroid(a, axis);
                             const clr_real cb = doubled_centroid(b, axis);
                             return ca < cb || (ca == cb && a.index < b.index);
                         });
        const auto bounds_of = [&](std::span<const Primitive> primitives) {
            return reduce(primitives, Bounds{}, parallel_);
        };
        return {{part.begin, half, bounds_of(range.first(half))},
                {part.begin + half, part.count - half, bounds_of(range.subspan(half))}};
    }

    const Input &input_;
    std::span<Primitive> primitives_;
    bool parallel_;
    LargeArray<BinaryNode> nodes_;
    clr_real scale_ = 1.0f;
    std::atomic<std::uint32_t> next_node_{1};
};

/// NaN rule: a comparison with NaN is false, so a coordinate that is no number is out of range.
bool in_range(const Vec3 &p) {
    return std::abs(p.x) <= BVH_COORDINATE_LIMIT && std::abs(p.y) <= BVH_COORDINATE_LIMIT &&
           std::abs(p.z) <= BVH_COORDINATE_LIMIT;
}

/// A triangle whose corners lie on one line is met by no ray. The product is taken where it
/// is exact enough for the corners.
bool has_area(const std::array<Vec3, 3> &t) {
    using Vector = glm::vec<3, WideReal, glm::defaultp>;
    const Vector a = Vector(t[1]) - Vector(t[0]);
    const Vector b = Vector(t[2]) - Vector(t[0]);
    return a.y * b.z != a.z * b.y || a.z * b.x != a.x * b.z || a.x * b.y != a.y * b.x;
}

/// The primitive of a triangle, or false.
bool make_primitive(const Input &input, std::size_t index, Primitive &primitive) {
    Box box;
    if (index < input.triangles.size()) {
        const auto &t = input.triangles[index];
        box.grow(Point(t[0]));
        box.grow(Point(t[1]));
        box.grow(Point(t[2]));
        primitive.set(box, std::uint32_t(index));
        return in_range(t[0]) && in_range(t[1]) && in_range(t[2]) && has_area(t);
    }
    if (index >= input.first_instance()) {
        const BvhInstance &in = input.instances[index - input.first_instance()];
        box.lower = Point(in.lower);
        box.upper = Point(in.upper);
        primitive.set(box, std::uint32_t(index), BVH_WIDTH);
        return in_range(in.lower) && in_range(in.upper) && in.lower.x <= in.upper.x;
    }
    if (index >= input.first_quadric()) {
        const BvhQuadric &q = input.quadrics[index - input.first_quadric()];
        box.lower = Point(q.lower);
        box.upper = Point(q.upper);
        primitive.set(box, std::uint32_t(index));
        return q.radius > 0.0f && in_range(q.lower) && in_range(q.upper);
    }
    const BvhSphere &s = input.spheres[index - input.triangles.size()];
    // The sums round to nearest; one step outwards makes the box contain the sphere.
    const clr_real radius = std::nextafter(s.radius, BVH_COORDINATE_LIMIT);
    const Vec3 lower = s.center - radius;
    const Vec3 upper = s.center + radius;
    for (int axis = 0; axis < 3; ++axis) {
        box.lower[axis] = std::nextafter(lower[axis], -BVH_COORDINATE_LIMIT);
        box.upper[axis] = std::nextafter(upper[axis], BVH_COORDINATE_LIMIT);
    }
    primitive.set(box, std::uint32_t(index));
    return s.radius > 0.0f && in_range(lower) && in_range(upper);
}

/// All that a ray can hit, in the order of the input; returns how many.
std::size_t usable_primitives(const Input &input, bool parallel, std::span<Primitive> primitives) {
    std::atomic<bool> all_usable{true};
    const auto make_range = [&](const tbb::blocked_range<std::size_t> &range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            if (!make_primitive(input, i, primitives[i])) {
                primitives[i].index = kUnusable;
                all_usable.store(false, std::memory_order_relaxed);
            }
        }
    };
    const tbb::blocked_range<std::size_t> all(0, primitives.size(), kParallelNode);
    if (parallel) {
        tbb::parallel_for(all, make_range);
    } else {
        make_range(all);
    }
    if (all_usable) {
        return primitives.size();
    }
    const auto end = std::remove_if(primitives.begin(), primitives.end(),
                                    [](const Primitive &p) { return p.index == kUnusable; });
    return std::size_t(end - primitives.begin());
}

} // namespace
} // namespace bvh

Bvh build_bvh(std::span<const std::array<Vec3, 3>> triangles, std::span<const BvhSphere> spheres,
              const BvhOptions &options, std::span<const BvhInstance> instances,
              std::span<const BvhQuadric> quadrics) {
    const bvh::Input input{triangles, spheres, quadrics, instances};
    const std::size_t count = input.first_instance() + instances.size();
    bvh::LargeArray<bvh::Primitive> storage(count);
    const std::span<bvh::Primitive> all(storage.data(), count);
    const std::span<bvh::Primitive> primitives =
        all.first(bvh::usable_primitives(input, options.parallel, all));

    Bvh result;
    result.primitives = primitives.size();
    result.degenerate = all.size() - primitives.size();
    if (primitives.empty()) {
        bvh::collapse(input, {}, {}, options, result);
    } else {
        const bvh::BinaryBuilder builder(input, primitives, options.parallel);
        bvh::collapse(input, primitives, builder.nodes(), options, result);
    }
    return result;
}

} // namespace clrender::inline CLR_PRECISION
