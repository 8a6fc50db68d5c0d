#include "mesh_writer.h"
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <future>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <vector>

namespace {

/// The grid of cells over the unit square, and how exactly its vertices are written.
struct Grid {
    int columns = 0, rows = 0;
    int position_digits = 4, other_digits = 4;
    double outward = 1;
};

struct Vertex {
    Vec3 position, normal;
};

Grid plan_grid(const Surface &surface, double triangles) {
    Grid grid;
    if (surface.topology == Topology::octahedral) {
        grid.columns = grid.rows = 2 * std::max(2, int(std::lround(std::sqrt(triangles / 8))));
    } else {
        const double rows = std::sqrt(triangles / 2 / surface.aspect);
        grid.rows = std::max(4, int(std::lround(rows)));
        // The two ends of a revolved surface have one triangle a cell.
        const int full_rows = grid.rows - (surface.topology == Topology::revolved);
        grid.columns = std::max(4, int(std::lround(triangles / 2 / full_rows)));
    }
    // A hundredth of an edge; at the ends of a revolved surface edges are shorter by the circle.
    double edge = std::sqrt(24 / triangles) / 10;
    if (surface.topology == Topology::revolved)
        edge = std::min(edge, std::sqrt(24 / triangles) * 2 / grid.columns);
    grid.position_digits = std::clamp(int(std::ceil(-std::log10(edge))) + 1, 4, 8);
    grid.other_digits = triangles < 1e6 ? 4 : 6;
    grid.outward = outward_sign(surface);
    return grid;
}

/// One representative for all grid points that are glued together, so that they come out equal.
void canonicalize(Topology topology, const Grid &grid, int &i, int &j) {
    const int n = grid.columns, m = grid.rows;
    if (topology == Topology::octahedral) {
        if (i == 0 || i == n)
            j = std::min(j, m - j);
        if (j == 0 || j == m)
            i = std::min(i, n - i);
        if (i == 0 || i == n)
            j = std::min(j, m - j);
        if ((i == 0 || i == n) && j == 0)
            i = 0;
        return;
    }
    i %= n;
    if (topology == Topology::torus)
        j %= m;
    else if (j == 0 || j == m)
        i = 0;
}

Vertex make_vertex(const Surface &surface, const Grid &grid, int i, int j) {
    canonicalize(surface.topology, grid, i, j);
    const double u = i / double(grid.columns), v = j / double(grid.rows);
    const double step = 0.25 / std::max(grid.columns, grid.rows);
    return {surface_point(surface, u, v), surface_normal(surface, u, v, step, grid.outward)};
}

/// Text in a string that grows by numbers without the cost of printf.
class Text {
public:
    void word(std::string_view s) { out_.append(s); }
    void integer(int64_t value) {
        char digits[24];
        out_.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
    }
    void fixed(double value, int digits) {
        static constexpr int64_t powers[] = {1,      10,      100,      1000,     10000,
                                             100000, 1000000, 10000000, 100000000};
        const int64_t scale = powers[digits];
        int64_t whole = std::llround(value * static_cast<double>(scale));
        if (whole < 0)
            out_.push_back('-');
        whole = std::abs(whole);
        integer(whole / scale);
        out_.push_back('.');
        for (int64_t place = scale / 10, rest = whole % scale; place > 0; place /= 10) {
            out_.push_back(static_cast<char>('0' + rest / place));
            rest %= place;
        }
    }
    void vector(std::string_view keyword, Vec3 p, int digits) {
        word(keyword);
        for (const double x : {p.x, p.y, p.z}) {
            out_.push_back(' ');
            fixed(x, digits);
        }
        out_.push_back('\n');
    }
    const std::string &string() const { return out_; }

private:
    std::string out_;
};

std::string vertex_row(const Surface &surface, const Grid &grid, int j) {
    Text text;
    for (int i = 0; i <= grid.columns; ++i) {
        const Vertex vertex = make_vertex(surface, grid, i, j);
        text.vector("v", vertex.position, grid.position_digits);
        text.word("vt ");
        text.fixed(i / double(grid.columns), grid.other_digits);
        text.word(" ");
        text.fixed(j / double(grid.rows), grid.other_digits);
        text.word("\n");
        text.vector("vn", vertex.normal, grid.other_digits);
    }
    return text.string();
}

void triangle(Text &text, int64_t a, int64_t b, int64_t c, double outward) {
    if (outward < 0)
        std::swap(b, c);
    text.word("f");
    for (const int64_t index : {a, b, c}) {
        text.word(" ");
        text.integer(index);
        text.word("/");
        text.integer(index);
        text.word("/");
        text.integer(index);
    }
    text.word("\n");
}

/// The diagonals of an octahedral square run along the octahedron's edges; elsewhere all alike.
bool falling_diagonal(Topology topology, const Grid &grid, int i, int j) {
    if (topology != Topology::octahedral)
        return false;
    return (2 * i < grid.columns) == (2 * j < grid.rows);
}

std::string face_row(const Surface &surface, const Grid &grid, int j) {
    const bool revolved = surface.topology == Topology::revolved;
    const bool skip_lower = revolved && j == 0, skip_upper = revolved && j == grid.rows - 1;
    Text text;
    for (int i = 0; i < grid.columns; ++i) {
        const int64_t width = grid.columns + 1;
        const int64_t a = 1 + j * width + i, b = a + 1, c = b + width, d = a + width;
        if (falling_diagonal(surface.topology, grid, i, j)) {
            triangle(text, a, b, d, grid.outward);
            triangle(text, b, c, d, grid.outward);
            continue;
        }
        if (!skip_lower)
            triangle(text, a, b, c, grid.outward);
        if (!skip_upper)
            triangle(text, a, c, d, grid.outward);
    }
    return text.string();
}

/// Writes the texts of rows 0 to count - 1 in order, made by all cores at once.
template <class MakeRow> void write_rows(std::FILE *file, int count, MakeRow make_row) {
    const int batch = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    for (int first = 0; first < count; first += batch) {
        std::vector<std::future<std::string>> rows;
        for (int row = first; row < std::min(first + batch, count); ++row)
            rows.push_back(std::async(std::launch::async, make_row, row));
        for (auto &row : rows) {
            const std::string text = row.get();
            if (std::fwrite(text.data(), 1, text.size(), file) != text.size())
                throw std::runtime_error("the disk is full, or the file cannot be written");
        }
    }
}

} // namespace

MeshCounts write_obj(const Surface &surface, double triangles, const std::string &path) {
    const Grid grid = plan_grid(surface, triangles);
    const std::unique_ptr<std::FILE, int (*)(std::FILE *)> file(std::fopen(path.c_str(), "wb"),
                                                                std::fclose);
    if (!file)
        throw std::runtime_error("cannot write " + path);
    write_rows(file.get(), grid.rows + 1, [&](int j) { return vertex_row(surface, grid, j); });
    write_rows(file.get(), grid.rows, [&](int j) { return face_row(surface, grid, j); });

    const auto columns = static_cast<uint64_t>(grid.columns),
               rows = static_cast<uint64_t>(grid.rows);
    const uint64_t missing = surface.topology == Topology::revolved ? 2 * columns : 0;
    return {(columns + 1) * (rows + 1), 2 * columns * rows - missing};
}
