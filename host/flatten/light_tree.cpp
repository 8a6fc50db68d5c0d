#include "light_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

namespace clrender::inline CLR_PRECISION {

namespace {

constexpr double pi = std::numbers::pi;
constexpr std::size_t bins = 12;
/// Keeps the device's products finite.
constexpr double largest_intensity = 1e30;

/// A cone of directions; empty, or with a half angle up to pi.
struct Cone {
    glm::dvec3 axis{0.0, 0.0, 1.0};
    double angle = -1; ///< half, radians; negative: empty

    void add(const Cone &other) {
        if (other.angle < 0)
            return;
        if (angle < 0) {
            *this = other;
            return;
        }
        const Cone &wide = angle >= other.angle ? *this : other;
        const Cone &narrow = angle >= other.angle ? other : *this;
        const double between = std::acos(std::clamp(glm::dot(wide.axis, narrow.axis), -1.0, 1.0));
        if (between + narrow.angle <= wide.angle) {
            *this = wide;
            return;
        }
        const double half = (wide.angle + between + narrow.angle) / 2;
        if (half >= pi) {
            *this = {wide.axis, pi};
            return;
        }
        // The wide cone's axis, turned towards the narrow one's.
        const glm::dvec3 across = narrow.axis - wide.axis * glm::dot(wide.axis, narrow.axis);
        const double turn = half - wide.angle;
        const glm::dvec3 axis_sum =
            glm::dot(across, across) > 1e-20
                ? wide.axis * std::cos(turn) + glm::normalize(across) * std::sin(turn)
                : wide.axis;
        *this = glm::dot(across, across) > 1e-20 ? Cone{axis_sum, half} : Cone{wide.axis, pi};
    }
};

/// The bounds of some lights together.
struct Bounds {
    glm::dvec3 lower{INFINITY}, upper{-INFINITY};
    Cone cone;
    double intensity = 0;
    bool is_beam = true; ///< all are

    void add(const Bounds &other) {
        lower = glm::min(lower, other.lower);
        upper = glm::max(upper, other.upper);
        cone.add(other.cone);
        intensity += other.intensity;
        is_beam &= other.is_beam;
    }
};

Bounds bounds_of(const LightExtent &light) {
    const double angle = std::acos(std::clamp(light.cosine, -1.0, 1.0));
    return {light.lower, light.upper, {light.axis, angle}, light.intensity, light.is_beam};
}

/// The orientation measure of a cone whose lights emit into a half space around each normal, or
/// nowhere beyond the cone.
double cone_measure(double angle, bool is_beam) {
    if (is_beam)
        return 2 * pi * (1 - std::cos(angle));
    const double reach = std::min(angle + pi / 2, pi);
    return 2 * pi * (1 - std::cos(angle)) +
           pi / 2 *
               (2 * reach * std::sin(angle) - std::cos(angle - 2 * reach) -
                2 * angle * std::sin(angle) + std::cos(angle));
}

double cost_of(const Bounds &b) {
    if (!(b.intensity > 0))
        return 0;
    const glm::dvec3 d = b.upper - b.lower;
    // Flat and thin boxes keep a grain of area, so that their power still counts.
    const double longest = std::max({d.x, d.y, d.z});
    const double area = d.x * d.y + d.y * d.z + d.z * d.x + 1e-3 * longest * longest + 1e-12;
    return b.intensity * cone_measure(b.cone.angle, b.is_beam) * area;
}

class Builder {
public:
    Builder(std::span<const LightExtent> lights, LightTree &tree)
        : lights_(lights), tree_(tree), order_(lights.size()) {
        std::iota(order_.begin(), order_.end(), 0u);
        tree_.nodes.reserve(lights.size() - 1);
        tree_.trail.resize(lights.size());
    }

    void build() { build(0, order_.size(), 0, 0); }

private:
    uint build(std::size_t first, std::size_t end, int level, uint trail);
    /// Lights whose middle lies in a bin below `bin` go to the first child.
    struct Split {
        int axis;
        std::size_t bin;
        double lower, bins_a_length;

        [[nodiscard]] std::size_t bin_of(const glm::dvec3 &place) const {
            const double at = (place[axis] - lower) * bins_a_length;
            if (!(at > 0)) // NaN, too: of lights so far away that float32 has no number for it
                return 0;
            return at < bins ? static_cast<std::size_t>(at) : bins - 1;
        }
    };

    [[nodiscard]] std::optional<Split> cheapest_split(std::size_t first, std::size_t end) const;
    [[nodiscard]] std::size_t split(std::size_t first, std::size_t end, int level);
    [[nodiscard]] Bounds bounds(std::size_t first, std::size_t end) const;
    [[nodiscard]] glm::dvec3 middle(uint light) const {
        return (lights_[light].lower + lights_[light].upper) * 0.5;
    }

    std::span<const LightExtent> lights_;
    LightTree &tree_;
    std::vector<uint> order_;
};

Bounds Builder::bounds(std::size_t first, std::size_t end) const {
    Bounds all;
    for (std::size_t i = first; i < end; ++i)
        all.add(bounds_of(lights_[order_[i]]));
    return all;
}

/// The costs of splitting one axis between two bins, each entry before the bin of its number.
std::array<double, bins> split_costs(const std::array<Bounds, bins> &of_bin) {
    std::array<double, bins> cost{};
    Bounds below;
    for (std::size_t bin = 0; bin + 1 < bins; ++bin) {
        below.add(of_bin[bin]);
        cost[bin + 1] = cost_of(below);
    }
    Bounds above;
    for (std::size_t bin = bins - 1; bin > 0; --bin) {
        above.add(of_bin[bin]);
        cost[bin] += cost_of(above);
    }
    return cost;
}

/// Of [first, end) the cheapest place to split; none where all lights have one place.
std::optional<Builder::Split> Builder::cheapest_split(std::size_t first, std::size_t end) const {
    glm::dvec3 lower{INFINITY};
    glm::dvec3 upper{-INFINITY};
    for (std::size_t i = first; i < end; ++i) {
        lower = glm::min(lower, middle(order_[i]));
        upper = glm::max(upper, middle(order_[i]));
    }
    const glm::dvec3 extent = upper - lower;
    const double longest = std::max({extent.x, extent.y, extent.z});
    std::optional<Split> best;
    double best_cost = INFINITY;
    for (int axis = 0; axis < 3; ++axis) {
        if (!(extent[axis] > 0))
            continue;
        Split split{axis, 0, lower[axis], bins / extent[axis]};
        std::array<Bounds, bins> of_bin;
        for (std::size_t i = first; i < end; ++i)
            of_bin[split.bin_of(middle(order_[i]))].add(bounds_of(lights_[order_[i]]));

        // Thin slices are to be avoided: short axes count as dearer.
        const std::array<double, bins> costs = split_costs(of_bin);
        for (split.bin = 1; split.bin < bins; ++split.bin)
            if (costs[split.bin] * longest / extent[axis] < best_cost) {
                best_cost = costs[split.bin] * longest / extent[axis];
                best = split;
            }
    }
    return best;
}

/// Orders [first, end) so that the first child's lights come first; returns where the second
/// child's begin.
std::size_t Builder::split(std::size_t first, std::size_t end, int level) {
    const auto begin = order_.begin() + static_cast<std::ptrdiff_t>(first);
    const auto stop = order_.begin() + static_cast<std::ptrdiff_t>(end);

    // What is infinitely far away has a tree of its own below the root.
    const auto distant =
        std::partition(begin, stop, [&](uint light) { return !lights_[light].is_distant; });
    if (distant != begin && distant != stop)
        return static_cast<std::size_t>(distant - order_.begin());

    const auto best = cheapest_split(first, end);

    // Halves, once no more levels are left than halving needs.
    const auto needed = static_cast<int>(std::bit_width(end - first));
    if (best && level + needed < CLR_LIGHT_TREE_LEVELS - 1) {
        const auto second = std::partition(
            begin, stop, [&](uint light) { return best->bin_of(middle(light)) < best->bin; });
        if (second != begin && second != stop)
            return static_cast<std::size_t>(second - order_.begin());
    }
    const std::size_t half = first + (end - first) / 2;
    const int axis = best ? best->axis : 0;
    std::nth_element(begin, order_.begin() + static_cast<std::ptrdiff_t>(half), stop,
                     [&](uint a, uint b) { return middle(a)[axis] < middle(b)[axis]; });
    return half;
}

LightBounds flat_bounds(const Bounds &b, uint child, clr_real (&axis)[4]) {
    LightBounds flat{};
    const glm::dvec3 center = (b.lower + b.upper) * 0.5;
    const double radius = glm::length(b.upper - b.lower) / 2;
    for (int c = 0; c < 3; ++c) {
        flat.center[c] = static_cast<clr_real>(center[c]);
        axis[c] = static_cast<clr_real>(b.cone.axis[c]);
    }
    axis[3] = b.is_beam ? 0.0f : 1.0f;
    // A little wider, for the rounding of the centre.
    const double grown = radius * (1 + 1e-5) + 1e-6 * glm::length(center);
    flat.radius2 = static_cast<clr_real>(grown * grown);
    flat.intensity = static_cast<clr_real>(std::min(b.intensity, largest_intensity));
    flat.child = child;
    const double angle = std::min(b.cone.angle + 1e-3, pi);
    flat.cosine = angle >= pi ? -1.0f : static_cast<clr_real>(std::cos(angle));
    flat.sine = angle >= pi ? 0.0f : static_cast<clr_real>(std::sin(angle));
    return flat;
}

uint Builder::build(std::size_t first, std::size_t end, int level, uint trail) {
    if (end - first == 1) {
        tree_.trail[order_[first]] = trail;
        return CLR_LIGHT_LEAF | order_[first];
    }
    const std::size_t second = split(first, end, level);
    const auto index = static_cast<uint>(tree_.nodes.size());
    tree_.nodes.emplace_back();
    const std::size_t start[3] = {first, second, end};
    for (uint side = 0; side < 2; ++side) {
        const uint child = build(start[side], start[side + 1], level + 1, trail | side << level);
        LightNode &node = tree_.nodes[index];
        node.bounds[side] =
            flat_bounds(bounds(start[side], start[side + 1]), child, node.axis[side]);
        if (lights_[order_[start[side]]].is_distant)
            node.bounds[side].child |= CLR_LIGHT_DISTANT;
    }
    return index;
}

} // namespace

LightTree build_light_tree(std::span<const LightExtent> lights) {
    LightTree tree;
    Builder(lights, tree).build();
    return tree;
}

} // namespace clrender::inline CLR_PRECISION
