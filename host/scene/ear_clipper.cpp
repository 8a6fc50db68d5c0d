#include "ear_clipper.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace clrender {

namespace {

using Index = std::uint32_t;

/// Steps that may be taken: all pairs of a few thousand corners, and a fair number for more.
std::int64_t budget_of(std::size_t corners) {
    constexpr std::int64_t base = 30'000'000;
    constexpr std::int64_t per_corner = 500;
    return base + per_corner * static_cast<std::int64_t>(corners);
}

double cross(const glm::dvec2 &a, const glm::dvec2 &b) {
    return a.x * b.y - a.y * b.x;
}

/// On which side of lines points lie, with a tolerance.
class Sides {
public:
    explicit Sides(double tolerance) : tolerance_(tolerance) {}

    /// 1: `p` is to the left of the line from `a` to `b`, -1: to the right, 0: on it.
    [[nodiscard]] int of(const glm::dvec2 &a, const glm::dvec2 &b, const glm::dvec2 &p) const {
        const glm::dvec2 along = b - a;
        const double area = cross(along, p - a);
        const double limit = tolerance_ * glm::length(along);
        return area > limit ? 1 : area < -limit ? -1 : 0;
    }

    [[nodiscard]] bool are_crossing(const glm::dvec2 &a, const glm::dvec2 &b, const glm::dvec2 &c,
                                    const glm::dvec2 &d) const {
        return of(a, b, c) * of(a, b, d) < 0 && of(c, d, a) * of(c, d, b) < 0;
    }

private:
    double tolerance_;
};

/// True if two edges cross each other in their insides, or if the budget does not suffice to tell.
/// Edges are met in the order of their left ends, and compared with those that reach so far.
bool has_crossing(const std::vector<glm::dvec2> &corners, const Sides &sides,
                  std::int64_t &budget) {
    const std::size_t count = corners.size();
    const auto begin = [&](std::size_t i) -> const glm::dvec2 & { return corners[i]; };
    const auto end = [&](std::size_t i) -> const glm::dvec2 & { return corners[(i + 1) % count]; };
    const auto left = [&](std::size_t i) { return std::min(begin(i).x, end(i).x); };

    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return left(a) < left(b); });
    std::vector<std::size_t> open;
    for (const std::size_t edge : order) {
        const double x = left(edge);
        std::erase_if(
            open, [&](std::size_t other) { return std::max(begin(other).x, end(other).x) < x; });
        budget -= static_cast<std::int64_t>(open.size()) + 1;
        if (budget < 0)
            return true;
        const auto [low, high] = std::minmax(begin(edge).y, end(edge).y);
        for (const std::size_t other : open) {
            const bool overlaps = std::max(begin(other).y, end(other).y) >= low &&
                                  std::min(begin(other).y, end(other).y) <= high;
            if (overlaps && sides.are_crossing(begin(edge), end(edge), begin(other), end(other)))
                return true;
        }
        open.push_back(edge);
    }
    return false;
}

class EarClipper {
public:
    EarClipper(const std::vector<glm::dvec2> &corners, const Sides &sides, std::int64_t budget);

    bool run(std::vector<std::array<Index, 3>> &triangles);

private:
    enum class Turn { left, straight, back, right };

    [[nodiscard]] Turn turn_at(Index v) const;
    [[nodiscard]] bool is_ear(Index v);
    [[nodiscard]] bool is_blocking(Index q, Index v) const;
    void remove(Index v);
    void fill_grid();
    [[nodiscard]] std::size_t column_of(double x) const;
    [[nodiscard]] std::size_t row_of(double y) const;

    const std::vector<glm::dvec2> &corners_;
    Sides sides_;
    std::int64_t budget_;
    std::vector<Index> next_, previous_;
    std::vector<char> removed_;
    std::size_t left_over_;

    // The corners that may lie in an ear, by the cell of a grid that they lie in.
    std::vector<std::vector<Index>> cells_;
    std::size_t grid_ = 1;
    glm::dvec2 low_{0}, cell_{1};
};

EarClipper::EarClipper(const std::vector<glm::dvec2> &corners, const Sides &sides,
                       std::int64_t budget)
    : corners_(corners), sides_(sides), budget_(budget), next_(corners.size()),
      previous_(corners.size()), removed_(corners.size(), 0), left_over_(corners.size()) {
    const auto count = static_cast<Index>(corners.size());
    for (Index i = 0; i < count; ++i) {
        next_[i] = (i + 1) % count;
        previous_[i] = (i + count - 1) % count;
    }
    fill_grid();
}

/// Which way the outline turns at a corner; `back`: it returns the way that it has come.
EarClipper::Turn EarClipper::turn_at(Index v) const {
    const glm::dvec2 &before = corners_[previous_[v]];
    const glm::dvec2 &here = corners_[v];
    const glm::dvec2 &after = corners_[next_[v]];
    const int side = sides_.of(before, after, here);
    if (before != after && side != 0)
        return side < 0 ? Turn::left : Turn::right;
    return glm::dot(before - here, after - here) < 0 ? Turn::straight : Turn::back;
}

void EarClipper::fill_grid() {
    // Of what lies in a triangle, what is nearest to the ear's tip does not turn left.
    std::vector<Index> candidates;
    for (Index i = 0; i < corners_.size(); ++i)
        if (turn_at(i) != Turn::left)
            candidates.push_back(i);
    constexpr double largest_grid = 512;
    grid_ = static_cast<std::size_t>(
        std::clamp(std::sqrt(static_cast<double>(candidates.size())), 1.0, largest_grid));
    cells_.resize(grid_ * grid_);
    if (candidates.empty())
        return;
    glm::dvec2 high = low_ = corners_[candidates[0]];
    for (const Index i : candidates) {
        low_ = glm::min(low_, corners_[i]);
        high = glm::max(high, corners_[i]);
    }
    cell_ = glm::max((high - low_) / static_cast<double>(grid_), glm::dvec2(1e-300));
    for (const Index i : candidates)
        cells_[row_of(corners_[i].y) * grid_ + column_of(corners_[i].x)].push_back(i);
}

std::size_t EarClipper::column_of(double x) const {
    return static_cast<std::size_t>(
        std::clamp((x - low_.x) / cell_.x, 0.0, static_cast<double>(grid_ - 1)));
}

std::size_t EarClipper::row_of(double y) const {
    return static_cast<std::size_t>(
        std::clamp((y - low_.y) / cell_.y, 0.0, static_cast<double>(grid_ - 1)));
}

/// True if the outline at the corner `q` enters the triangle of `v` and its neighbours.
bool EarClipper::is_blocking(Index q, Index v) const {
    const std::array<Index, 3> ear{previous_[v], v, next_[v]};
    if (removed_[q] != 0 || std::find(ear.begin(), ear.end(), q) != ear.end())
        return false;
    bool before_enters = true;
    bool after_enters = true;
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec2 &a = corners_[ear[i]];
        const glm::dvec2 &b = corners_[ear[(i + 1) % 3]];
        const int side = sides_.of(a, b, corners_[q]);
        if (side < 0)
            return false;
        if (side == 0) {
            before_enters = before_enters && sides_.of(a, b, corners_[previous_[q]]) > 0;
            after_enters = after_enters && sides_.of(a, b, corners_[next_[q]]) > 0;
        }
    }
    return (before_enters || after_enters) && turn_at(q) != Turn::left;
}

bool EarClipper::is_ear(Index v) {
    const glm::dvec2 &a = corners_[previous_[v]];
    const glm::dvec2 &b = corners_[v];
    const glm::dvec2 &c = corners_[next_[v]];
    const glm::dvec2 low = glm::min(a, glm::min(b, c));
    const glm::dvec2 high = glm::max(a, glm::max(b, c));
    const std::size_t last_row = row_of(high.y);
    const std::size_t last_column = column_of(high.x);
    for (std::size_t row = row_of(low.y); row <= last_row; ++row)
        for (std::size_t column = column_of(low.x); column <= last_column; ++column) {
            const std::vector<Index> &cell = cells_[row * grid_ + column];
            budget_ -= static_cast<std::int64_t>(cell.size()) + 1;
            if (std::any_of(cell.begin(), cell.end(), [&](Index q) { return is_blocking(q, v); }))
                return false;
        }
    return true;
}

void EarClipper::remove(Index v) {
    removed_[v] = 1;
    next_[previous_[v]] = next_[v];
    previous_[next_[v]] = previous_[v];
    --left_over_;
}

bool EarClipper::run(std::vector<std::array<Index, 3>> &triangles) {
    triangles.clear();
    Index v = 0;
    std::size_t idle = 0; // corners passed since one was removed
    while (left_over_ >= 3) {
        if (--budget_ < 0 || idle > 2 * left_over_)
            return false;
        const Index after = next_[v];
        const Turn turn = turn_at(v);

        // Corners on a straight line are taken out only where nothing else is left to clip.
        const bool is_empty = turn == Turn::back || (turn == Turn::straight && idle > left_over_);
        const bool is_clipped = turn == Turn::left && is_ear(v);
        if (is_clipped)
            triangles.push_back({previous_[v], v, after});
        if (is_clipped || is_empty) {
            remove(v);
            idle = 0;
            v = is_clipped ? next_[after] : previous_[after];
            continue;
        }
        ++idle;
        v = after;
    }
    return !triangles.empty();
}

} // namespace

bool clip_ears(const std::vector<glm::dvec2> &corners, double tolerance,
               std::vector<std::array<std::uint32_t, 3>> &triangles) {
    const Sides sides(tolerance);
    std::int64_t budget = budget_of(corners.size());
    if (has_crossing(corners, sides, budget))
        return false;
    return EarClipper(corners, sides, budget).run(triangles);
}

} // namespace clrender
