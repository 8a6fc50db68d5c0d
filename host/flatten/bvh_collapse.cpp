#include "flatten/bvh_collapse.h"

#include <algorithm>
#include <cmath>

namespace clrender::bvh {

namespace {

constexpr int kWidth = BVH_WIDTH;
constexpr std::uint32_t kParallelNode = 4096;

/// What one child of a wide node stands for: primitives [begin, begin + count), and the binary node
/// that holds exactly them, where there is one.
struct Part {
    static constexpr std::uint32_t kNoNode = 0xffffffffu;
    std::uint32_t binary = kNoNode;
    std::uint32_t begin = 0;
    std::uint32_t count = 0;
};

/// At most eight parts; `count` of them are set.
struct Parts {
    std::array<Part, kWidth> part;
    int count = 0;
};

/// The cheapest way to stand a binary subtree in for 1 to 7 children of a wide node.
/// Ylitie et al. 2017, section 3.1: C(n, 1) = min(leaf, inner), C(n, i) = min over k of
/// C(left, k) + C(right, i - k), or C(n, i - 1) when more children do not pay.
struct Choice {
    std::array<float, kWidth - 1> cost;          ///< [i - 1]: with i children
    std::array<std::uint8_t, kWidth> left_share; ///< [i - 1]: k; 0: as with i - 1 children
    bool is_leaf;                                ///< with one child: a block, else an inner node
    bool one_kind;                               ///< all triangles or all spheres
    std::uint8_t levels;                         ///< as an inner node: levels below and with it
};

class Collapser {
public:
    Collapser(const Input &input, std::span<const Primitive> primitives,
              std::span<const BinaryNode> binary, const BvhOptions &options, Bvh &bvh)
        : input_(input), primitives_(primitives), binary_(binary), options_(options), bvh_(bvh),
          choices_(binary.size()) {
        const double area = binary.empty() ? 0.0 : binary[0].box.half_area();
        area_scale_ = area > 0.0 ? 1.0 / area : 1.0;
    }

    void run() {
        Part root;
        if (!binary_.empty()) {
            choose(0);
            root = {0, 0, binary_[0].count};
            bvh_.cost = inner_cost(0);
        }
        bvh_.nodes.reserve(primitives_.size() / 16 + 1);
        emit_node(root, 0, 1);
        const float extent = largest_coordinate();
        for (BvhNode &node : bvh_.nodes) {
            node.extent = extent;
        }
    }

private:
    // ---- costs, bottom up ----

    void choose(std::uint32_t index) {
        const BinaryNode &node = binary_[index];
        Choice &choice = choices_[index];
        if (node.is_leaf()) {
            choice.cost.fill(leaf_cost(index));
            choice.left_share.fill(0);
            choice.is_leaf = true;
            choice.one_kind = true;
            choice.levels = 1;
            return;
        }

        const std::uint32_t left = node.first_child;
        run_both(
            options_.parallel && node.count > kParallelNode, [&] { choose(left); },
            [&] { choose(left + 1); });
        choice.one_kind = choices_[left].one_kind && choices_[left + 1].one_kind &&
                          input_.is_sphere(primitives_[node.begin]) ==
                              input_.is_sphere(primitives_[binary_[left + 1].begin]);

        // As an inner node all eight children are at the disposal of the two halves.
        std::array<float, kWidth> shared_cost;
        for (int children = 2; children <= kWidth; ++children) {
            shared_cost[children - 1] = cheapest_share(index, children);
        }
        choice.cost[0] = float(area(index) * options_.node_cost) + shared_cost[kWidth - 1];
        choice.is_leaf = may_be_leaf(index) && leaf_cost(index) <= choice.cost[0];
        if (choice.is_leaf) {
            choice.cost[0] = leaf_cost(index);
        }
        for (int i = 1; i < kWidth - 1; ++i) {
            choice.cost[i] = std::min(shared_cost[i], choice.cost[i - 1]);
            if (choice.cost[i - 1] <= shared_cost[i]) {
                choice.left_share[i] = 0;
            }
        }
        choice.levels = levels_of(index);
    }

    /// min over k of C(left, k) + C(right, children - k); k is noted in left_share.
    float cheapest_share(std::uint32_t index, int children) {
        const std::uint32_t left = binary_[index].first_child;
        const auto &a = choices_[left].cost;
        const auto &b = choices_[left + 1].cost;
        float best = std::numeric_limits<float>::infinity();
        std::uint8_t &share = choices_[index].left_share[children - 1];
        share = 1;
        for (int k = 1; k < children; ++k) {
            const float cost = a[k - 1] + b[children - k - 1];
            if (cost < best) {
                best = cost;
                share = std::uint8_t(k);
            }
        }
        return best;
    }

    [[nodiscard]] bool may_be_leaf(std::uint32_t index) const {
        return binary_[index].count <= kWidth && choices_[index].one_kind;
    }

    /// Relative to the root's area: the chance that a ray through the root meets this box too.
    [[nodiscard]] double area(std::uint32_t index) const {
        return binary_[index].box.half_area() * area_scale_;
    }

    [[nodiscard]] float leaf_cost(std::uint32_t index) const {
        return float(area(index) * options_.block_cost);
    }

    [[nodiscard]] double inner_cost(std::uint32_t index) const {
        return binary_[index].is_leaf() ? area(index) * (options_.node_cost + options_.block_cost)
                                        : double(choices_[index].cost[0]);
    }

    // ---- levels ----

    /// The cheapest children of `index` as a wide node, from left to right.
    [[nodiscard]] Parts cheapest_parts(std::uint32_t index) const {
        Parts parts;
        if (choices_[index].is_leaf) { // only the root of a handful of primitives
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

    [[nodiscard]] std::uint8_t levels_of(std::uint32_t index) const {
        int below = 0;
        const Parts parts = cheapest_parts(index);
        for (int i = 0; i < parts.count; ++i) {
            const Choice &choice = choices_[parts.part[i].binary];
            below = std::max(below, choice.is_leaf ? 0 : int(choice.levels));
        }
        return std::uint8_t(std::min(below + 1, 255));
    }

    /// Levels of inner nodes that equal_parts needs at most: its last one has eight primitives or
    /// less, which are of two kinds.
    [[nodiscard]] static int balanced_levels(std::uint32_t count) {
        int levels = 1;
        for (std::uint32_t n = count; n > kWidth; n = (n + kWidth - 1) / kWidth) {
            ++levels;
        }
        return levels;
    }

    [[nodiscard]] bool is_leaf(const Part &part) const {
        if (part.binary != Part::kNoNode) {
            return choices_[part.binary].is_leaf;
        }
        return part.count <= kWidth && same_kind(part);
    }

    [[nodiscard]] bool same_kind(const Part &part) const {
        for (std::uint32_t i = 1; i < part.count; ++i) {
            if (input_.is_sphere(primitives_[part.begin + i]) !=
                input_.is_sphere(primitives_[part.begin])) {
                return false;
            }
        }
        return true;
    }

    /// Whether `levels` levels of inner nodes suffice for what is below this child.
    [[nodiscard]] bool fits(const Part &part, int levels) const {
        if (is_leaf(part)) {
            return true;
        }
        const bool cheapest_fits =
            part.binary != Part::kNoNode && choices_[part.binary].levels <= levels;
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
            // Two kinds in one small group: a block for each primitive.
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
            set_box(node, slot, {glm::vec3(BVH_EMPTY_BOUND), glm::vec3(-BVH_EMPTY_BOUND)});
            node.child[slot] = bvh_child(BVH_CHILD_EMPTY, 0);
        }
        node.parent = parent;
        return node;
    }

    static void set_box(BvhNode &node, int slot, const Box &box) {
        for (int axis = 0; axis < 3; ++axis) {
            node.planes[BVH_PLANE_LOWER + axis][slot] = box.lower[axis];
            node.planes[BVH_PLANE_UPPER + axis][slot] = box.upper[axis];
        }
    }

    [[nodiscard]] Box box_of(const Part &part) const {
        if (part.binary != Part::kNoNode) {
            return binary_[part.binary].box;
        }
        Box box;
        for (const Primitive &p : primitives_.subspan(part.begin, part.count)) {
            box.grow(p.box);
        }
        return box;
    }

    [[nodiscard]] std::uint32_t emit_block(const Part &part) {
        const auto members = primitives_.subspan(part.begin, part.count);
        if (input_.is_sphere(members[0])) {
            bvh_.sphere_blocks.push_back(sphere_block(members));
            return bvh_child(BVH_CHILD_SPHERES, std::uint32_t(bvh_.sphere_blocks.size() - 1));
        }
        bvh_.triangle_blocks.push_back(triangle_block(members));
        return bvh_child(BVH_CHILD_TRIANGLES, std::uint32_t(bvh_.triangle_blocks.size() - 1));
    }

    [[nodiscard]] TriangleBlock triangle_block(std::span<const Primitive> members) const {
        TriangleBlock block{};
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
        return block;
    }

    [[nodiscard]] SphereBlock sphere_block(std::span<const Primitive> members) const {
        SphereBlock block{};
        for (std::size_t lane = 0; lane < kWidth; ++lane) {
            const Primitive &p = members[lane < members.size() ? lane : 0];
            const BvhSphere &sphere = input_.spheres[p.index - input_.triangles.size()];
            for (int axis = 0; axis < 3; ++axis) {
                block.center[axis][lane] = sphere.center[axis];
            }
            block.radius[lane] = sphere.radius;
            block.prim[lane] = sphere.prim;
        }
        return block;
    }

    [[nodiscard]] float largest_coordinate() const {
        if (binary_.empty()) {
            return 0.0f;
        }
        float largest = 0.0f;
        for (int axis = 0; axis < 3; ++axis) {
            largest = std::max({largest, std::abs(binary_[0].box.lower[axis]),
                                std::abs(binary_[0].box.upper[axis])});
        }
        return largest;
    }

    const Input &input_;
    std::span<const Primitive> primitives_;
    std::span<const BinaryNode> binary_;
    const BvhOptions &options_;
    Bvh &bvh_;
    std::vector<Choice> choices_;
    double area_scale_ = 1.0;
};

} // namespace

void collapse(const Input &input, std::span<const Primitive> primitives,
              std::span<const BinaryNode> binary, const BvhOptions &options, Bvh &bvh) {
    Collapser(input, primitives, binary, options, bvh).run();
}

} // namespace clrender::bvh
