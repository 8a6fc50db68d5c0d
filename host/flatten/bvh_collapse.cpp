#include "flatten/bvh_collapse.h"
#include "flatten/large_array.h"

#include <algorithm>
#include <cmath>
#include <tbb/parallel_for.h>

namespace clrender::inline CLR_PRECISION::bvh {

namespace {

constexpr int kWidth = BVH_WIDTH;
constexpr std::uint32_t kParallelNode = 4096;
/// The reciprocal of anything smaller is not finite, or nearly so.
constexpr clr_real kTiny = 1e-30f;

/// What one child of a wide node stands for: primitives [begin, begin + count), and the binary node
/// that holds exactly them, where there is one.
struct Part {
    static constexpr std::uint32_t kNoNode = 0xffffffffu;
    std::uint32_t binary = kNoNode;
    std::uint32_t begin = 0;
    std::uint32_t count = 0;
};

/// What a block holds: primitives [begin, begin + count).
struct Run {
    std::uint32_t begin, count;
};

/// At most eight parts; `count` of them are set.
struct Parts {
    std::array<Part, kWidth> part;
    int count = 0;
};

/// The cheapest way to stand a binary subtree in for 1 to 7 children of a wide node.
/// Ylitie et al. 2017, section 3.1: C(n, 1) = block or inner node, C(n, i) = min over k of
/// C(left, k) + C(right, i - k), or C(n, i - 1) when more children do not pay.
struct Choice {
    std::array<clr_real, kWidth - 1> cost;       ///< [i - 1]: with i children
    std::array<std::uint8_t, kWidth - 1> levels; ///< [i - 1]: of inner nodes, at and below them
    std::array<std::uint8_t, kWidth> left_share; ///< [i - 1]: k; 0: as with i - 1 children
};

class Collapser {
public:
    Collapser(const Input &input, std::span<const Primitive> primitives,
              std::span<const BinaryNode> binary, const BvhOptions &options, Bvh &bvh)
        : input_(input), primitives_(primitives), binary_(binary), options_(options), bvh_(bvh),
          choices_(binary.size()) {
        if (!binary.empty()) {
            const Point size = binary[0].box.upper - binary[0].box.lower;
            const clr_real largest = std::max({size[0], size[1], size[2]});
            scale_ = largest > kTiny ? 1.0f / largest : 1.0f;
            const clr_real area = binary[0].box.half_area(scale_);
            area_scale_ = area > kTiny ? 1.0f / area : 1.0f;
        }
    }

    void run() {
        Part root;
        if (!binary_.empty()) {
            choose(0);
            root = {0, 0, binary_[0].count};
            bvh_.cost = double(root_cost());
        }
        bvh_.nodes.reserve(primitives_.size() / 24 + 1);
        emit_node(root, 0, 1);
        bound_root();
        fill_blocks();
    }

private:
    /// The box of the whole tree: empty children are inside out, and widen nothing.
    void bound_root() {
        BvhNode &root = bvh_.nodes.front();
        for (int axis = 0; axis < 3; ++axis) {
            const auto &lower = root.planes[BVH_PLANE_LOWER + axis];
            const auto &upper = root.planes[BVH_PLANE_UPPER + axis];
            root.bounds[axis] = *std::min_element(std::begin(lower), std::end(lower));
            root.bounds[3 + axis] = *std::max_element(std::begin(upper), std::end(upper));
        }
    }

    // ---- costs, bottom up ----

    void choose(std::uint32_t index) {
        const BinaryNode &node = binary_[index];
        Choice &choice = choices_[index];
        if (node.is_leaf()) {
            choice.cost.fill(leaf_cost(index));
            choice.levels.fill(0);
            choice.left_share.fill(0);
            return;
        }

        const std::uint32_t left = node.first_child;
        run_both(
            options_.parallel && node.count > kParallelNode, [&] { choose(left); },
            [&] { choose(left + 1); });

        // As an inner node all eight children are at the disposal of the two halves.
        choice.cost[0] = area(index) * options_.node_cost + cheapest_share(index, kWidth);
        choice.levels[0] = std::uint8_t(std::min(254, levels_of_share(index, kWidth)) + 1);
        for (int children = 2; children < kWidth; ++children) {
            const clr_real shared = cheapest_share(index, children);
            if (choice.cost[children - 2] <= shared) {
                choice.left_share[children - 1] = 0;
                choice.cost[children - 1] = choice.cost[children - 2];
                choice.levels[children - 1] = choice.levels[children - 2];
            } else {
                choice.cost[children - 1] = shared;
                choice.levels[children - 1] = std::uint8_t(levels_of_share(index, children));
            }
        }
    }

    /// min over k of C(left, k) + C(right, children - k); k is noted in left_share.
    clr_real cheapest_share(std::uint32_t index, int children) {
        const std::uint32_t left = binary_[index].first_child;
        const auto &a = choices_[left].cost;
        const auto &b = choices_[left + 1].cost;
        clr_real best = std::numeric_limits<clr_real>::infinity();
        std::uint8_t &share = choices_[index].left_share[children - 1];
        share = 1;
        for (int k = 1; k < children; ++k) {
            const clr_real cost = a[k - 1] + b[children - k - 1];
            if (cost < best) {
                best = cost;
                share = std::uint8_t(k);
            }
        }
        return best;
    }

    /// Of the children as cheapest_share has just shared them out.
    [[nodiscard]] int levels_of_share(std::uint32_t index, int children) const {
        const std::uint32_t left = binary_[index].first_child;
        const int k = choices_[index].left_share[children - 1];
        return std::max(choices_[left].levels[k - 1], choices_[left + 1].levels[children - k - 1]);
    }

    /// Relative to the root's area: the chance that a ray through the root meets this box too.
    [[nodiscard]] clr_real area(std::uint32_t index) const {
        return binary_[index].box.half_area(scale_) * area_scale_;
    }

    [[nodiscard]] clr_real leaf_cost(std::uint32_t index) const {
        return area(index) * options_.block_cost;
    }

    [[nodiscard]] clr_real root_cost() const {
        return binary_[0].is_leaf() ? area(0) * (options_.node_cost + options_.block_cost)
                                    : choices_[0].cost[0];
    }

    // ---- levels ----

    /// The cheapest children of `index` as a wide node, from left to right.
    [[nodiscard]] Parts cheapest_parts(std::uint32_t index) const {
        Parts parts;
        if (binary_[index].is_leaf()) { // only the root of a handful of primitives
            add_part(index, parts);
        } else {
            share_children(index, kWidth, parts);
        }
        return parts;
    }

    void share_children(std::uint32_t index, int children, Parts &parts) const {
        const std::uint32_t left = binary_[index].first_child;
        const int k = choices_[index].left_share[children - 1];
        expand(left, k, parts);
        expand(left + 1, children - k, parts);
    }

    void expand(std::uint32_t index, int children, Parts &parts) const {
        // The last table entry is for eight children, which only the node itself can have.
        while (children > 1 && choices_[index].left_share[children - 1] == 0) {
            --children;
        }
        if (children == 1) {
            add_part(index, parts);
        } else {
            share_children(index, children, parts);
        }
    }

    void add_part(std::uint32_t index, Parts &parts) const {
        parts.part[parts.count++] = {index, binary_[index].begin, binary_[index].count};
    }

    /// Levels of inner nodes that equal_parts needs at most: its last one has eight primitives or
    /// less, which are of several kinds.
    [[nodiscard]] static int balanced_levels(std::uint32_t count) {
        int levels = 1;
        for (std::uint32_t n = count; n > kWidth; n = (n + kWidth - 1) / kWidth) {
            ++levels;
        }
        return levels;
    }

    [[nodiscard]] bool is_leaf(const Part &part) const {
        return part.binary != Part::kNoNode
                   ? binary_[part.binary].is_leaf()
                   : input_.is_block(primitives_.subspan(part.begin, part.count));
    }

    /// Whether `levels` levels of inner nodes suffice for what is below this child.
    [[nodiscard]] bool fits(const Part &part, int levels) const {
        if (is_leaf(part)) {
            return true;
        }
        const bool cheapest_fits =
            part.binary != Part::kNoNode && choices_[part.binary].levels[0] <= levels;
        return cheapest_fits || balanced_levels(part.count) <= levels;
    }

    /// The children of a wide node at `level` (the root's is 1): the cheapest as long as the levels
    /// below stay within bounds, else equal runs of the primitives in the order of the tree.
    [[nodiscard]] Parts parts_of(const Part &node, int level) const {
        if (node.binary != Part::kNoNode) {
            const Parts parts = cheapest_parts(node.binary);
            const int left = options_.max_levels - level;
            if (std::all_of(parts.part.begin(), parts.part.begin() + parts.count,
                            [&](const Part &part) { return fits(part, left); })) {
                return parts;
            }
        }
        return equal_parts(node);
    }

    [[nodiscard]] Parts equal_parts(const Part &node) const {
        Parts parts;
        if (node.count <= kWidth) {
            // Several kinds in one small group: a block for each primitive.
            for (std::uint32_t i = 0; i < node.count; ++i) {
                parts.part[parts.count++] = {Part::kNoNode, node.begin + i, 1};
            }
            return parts;
        }
        const std::uint32_t share = (node.count + kWidth - 1) / kWidth;
        for (std::uint32_t i = 0; i < node.count; i += share) {
            parts.part[parts.count++] = {Part::kNoNode, node.begin + i,
                                         std::min(share, node.count - i)};
        }
        return parts;
    }

    // ---- output, top down ----

    void emit_node(const Part &part, std::uint32_t parent, int level) {
        const std::uint32_t index = std::uint32_t(bvh_.nodes.size());
        bvh_.nodes.push_back(empty_node(parent));
        bvh_.levels = std::max(bvh_.levels, level);
        if (part.count == 0) {
            return;
        }

        // First all blocks of the node, side by side in memory, then the nodes below it.
        const Parts parts = parts_of(part, level);
        for (int slot = 0; slot < parts.count; ++slot) {
            set_box(bvh_.nodes[index], slot, box_of(parts.part[slot]));
            if (is_leaf(parts.part[slot])) {
                bvh_.nodes[index].child[slot] = emit_block(parts.part[slot]);
            }
        }
        for (int slot = 0; slot < parts.count; ++slot) {
            if (!is_leaf(parts.part[slot])) {
                bvh_.nodes[index].child[slot] =
                    bvh_child(BVH_CHILD_INNER, std::uint32_t(bvh_.nodes.size()));
                emit_node(parts.part[slot], index, level + 1);
            }
        }
    }

    [[nodiscard]] static BvhNode empty_node(std::uint32_t parent) {
        BvhNode node{};
        for (int slot = 0; slot < kWidth; ++slot) {
            set_box(node, slot, {Point(BVH_EMPTY_BOUND), Point(-BVH_EMPTY_BOUND)});
            node.child[slot] = BVH_NO_CHILD;
        }
        node.parent = parent;
        return node;
    }

    /// The box, widened by what the tests of rays lose to rounding.
    static void set_box(BvhNode &node, int slot, const Box &box) {
        clr_real largest = 0;
        for (int axis = 0; axis < 3; ++axis) {
            largest = std::max({largest, std::abs(box.lower[axis]), std::abs(box.upper[axis])});
        }
        for (int axis = 0; axis < 3; ++axis) {
            node.planes[BVH_PLANE_LOWER + axis][slot] = box.lower[axis] - BVH_WIDEN * largest;
            node.planes[BVH_PLANE_UPPER + axis][slot] = box.upper[axis] + BVH_WIDEN * largest;
        }
    }

    [[nodiscard]] Box box_of(const Part &part) const {
        if (part.binary != Part::kNoNode) {
            return binary_[part.binary].box;
        }
        Box box;
        for (const Primitive &p : primitives_.subspan(part.begin, part.count)) {
            box.grow(p.box());
        }
        return box;
    }

    /// The reference to a block that fill_blocks fills later, or to an instance.
    [[nodiscard]] std::uint32_t emit_block(const Part &part) {
        const Primitive &first = primitives_[part.begin];
        const Run run{part.begin, part.count};
        switch (input_.kind_of(first)) {
        case Input::Kind::instance:
            return bvh_child(BVH_CHILD_INSTANCE,
                             std::uint32_t(first.index - input_.first_instance()));
        case Input::Kind::quadric:
            quadric_runs_.push_back(run);
            return bvh_child(BVH_CHILD_SPHERES,
                             std::uint32_t(quadric_runs_.size() - 1) | BVH_QUADRICS_BIT);
        case Input::Kind::sphere:
            sphere_runs_.push_back(run);
            return bvh_child(BVH_CHILD_SPHERES, std::uint32_t(sphere_runs_.size() - 1));
        case Input::Kind::triangle:
            break;
        }
        triangle_runs_.push_back(run);
        return bvh_child(BVH_CHILD_TRIANGLES, std::uint32_t(triangle_runs_.size() - 1));
    }

    void fill_blocks() {
        const auto members = [&](const Run &run) {
            return primitives_.subspan(run.begin, run.count);
        };
        bvh_.triangle_blocks.resize(triangle_runs_.size());
        for_each_index(triangle_runs_.size(), [&](std::size_t i) {
            fill(bvh_.triangle_blocks[i], members(triangle_runs_[i]));
        });
        bvh_.sphere_blocks.resize(sphere_runs_.size());
        for_each_index(sphere_runs_.size(), [&](std::size_t i) {
            fill(bvh_.sphere_blocks[i], members(sphere_runs_[i]));
        });
        bvh_.quadric_blocks.resize(quadric_runs_.size());
        for_each_index(quadric_runs_.size(), [&](std::size_t i) {
            fill(bvh_.quadric_blocks[i], members(quadric_runs_[i]));
        });
    }

    template <class Work> void for_each_index(std::size_t count, const Work &work) const {
        if (options_.parallel) {
            tbb::parallel_for(std::size_t(0), count, work);
        } else {
            for (std::size_t i = 0; i < count; ++i) {
                work(i);
            }
        }
    }

    void fill(TriangleBlock &block, std::span<const Primitive> members) const {
        for (std::size_t lane = 0; lane < kWidth; ++lane) {
            const Primitive &p = members[lane < members.size() ? lane : 0];
            const auto &triangle = input_.triangles[p.index];
            for (int corner = 0; corner < 3; ++corner) {
                for (int axis = 0; axis < 3; ++axis) {
                    block.vertex[corner][axis][lane] = triangle[corner][axis];
                }
            }
            block.prim[lane] = p.index;
        }
    }

    void fill(SphereBlock &block, std::span<const Primitive> members) const {
        for (std::size_t lane = 0; lane < kWidth; ++lane) {
            const Primitive &p = members[lane < members.size() ? lane : 0];
            const BvhSphere &sphere = input_.spheres[p.index - input_.triangles.size()];
            for (int axis = 0; axis < 3; ++axis) {
                block.center[axis][lane] = sphere.center[axis];
            }
            block.radius[lane] = sphere.radius;
            block.prim[lane] = sphere.prim;
        }
    }

    void fill(QuadricBlock &block, std::span<const Primitive> members) const {
        for (std::size_t lane = 0; lane < kWidth; ++lane) {
            const Primitive &p = members[lane < members.size() ? lane : 0];
            const BvhQuadric &q = input_.quadrics[p.index - input_.first_quadric()];
            for (int axis = 0; axis < 3; ++axis) {
                block.center[axis][lane] = q.center[axis];
                for (std::size_t row = 0; row < 3; ++row) {
                    block.rows[row][axis][lane] = q.rows[row][axis];
                }
            }
            block.radius[lane] = q.radius;
            block.half_length[lane] = q.half_length;
            block.kind[lane] = q.kind;
            block.prim[lane] = q.prim;
        }
    }

    const Input &input_;
    std::span<const Primitive> primitives_;
    std::span<const BinaryNode> binary_;
    const BvhOptions &options_;
    Bvh &bvh_;
    LargeArray<Choice> choices_;
    std::vector<Run> triangle_runs_, sphere_runs_, quadric_runs_;
    clr_real scale_ = 1.0f; ///< of lengths, see Box::half_area
    clr_real area_scale_ = 1.0f;
};

} // namespace

void collapse(const Input &input, std::span<const Primitive> primitives,
              std::span<const BinaryNode> binary, const BvhOptions &options, Bvh &bvh) {
    Collapser(input, primitives, binary, options, bvh).run();
}

} // namespace clrender::inline CLR_PRECISION::bvh
