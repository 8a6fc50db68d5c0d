/// Polygons of any shape cover their area exactly: the areas are those of the shoelace formula or
/// of the figure.

#include "files.h"
#include "stderr_of.h"

#include "scene/mesh_io.h"
#include "scene/polygon.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>

using namespace clrender;

namespace {

using Corners = std::vector<glm::dvec3>;

Corners flat(const std::vector<glm::dvec2> &corners) {
    Corners all;
    for (const glm::dvec2 &c : corners)
        all.emplace_back(c, 0);
    return all;
}

struct Cover {
    bool is_right = false;
    glm::dvec3 area{0};  ///< sum of the vector areas
    double absolute = 0; ///< sum of their lengths: more than that of `area` where triangles overlap
    std::size_t count = 0;
    double smallest = 0;
};

Cover cover(const Corners &corners) {
    PolygonCutter cutter;
    Cover result;
    result.is_right = cutter.cut(corners);
    result.smallest = std::numeric_limits<double>::infinity();
    for (const auto &t : cutter.triangles()) {
        const glm::dvec3 area =
            .5 * glm::cross(corners[t[1]] - corners[t[0]], corners[t[2]] - corners[t[0]]);
        result.area += area;
        result.absolute += glm::length(area);
        result.smallest = std::min(result.smallest, glm::length(area));
        ++result.count;
    }
    return result;
}

/// The polygon as it is, from every corner on, reversed, and turned in space: always that area.
void check_area(const std::vector<glm::dvec2> &corners, double area) {
    const glm::dvec3 axis = glm::normalize(glm::dvec3(.3, -.5, .8));
    const glm::dvec3 u = glm::normalize(glm::cross(axis, glm::dvec3(1, 0, 0)));
    const glm::dvec3 v = glm::cross(axis, u);
    for (std::size_t first = 0; first < corners.size(); ++first)
        for (const bool is_reversed : {false, true})
            for (const bool is_turned : {false, true}) {
                Corners placed;
                for (std::size_t i = 0; i < corners.size(); ++i) {
                    const std::size_t at =
                        (first + (is_reversed ? corners.size() - i : i)) % corners.size();
                    const glm::dvec2 &c = corners[at];
                    placed.push_back(is_turned
                                         ? glm::dvec3(glm::vec3(3. * axis + c.x * u + c.y * v))
                                         : glm::dvec3(c, 0));
                }
                CAPTURE(first, is_reversed, is_turned);
                const Cover result = cover(placed);
                CHECK(result.is_right);
                CHECK(result.absolute == Approx(area).epsilon(is_turned ? 1e-5 : 1e-12));
                CHECK(glm::length(result.area) == Approx(area).epsilon(is_turned ? 1e-5 : 1e-12));
                const double sign = is_reversed ? -1 : 1;
                CHECK(glm::dot(result.area, is_turned ? axis : glm::dvec3(0, 0, 1)) * sign > 0);
            }
}

const std::vector<glm::dvec2> u_shape{{0, 0}, {4, 0}, {4, 4}, {3, 4},
                                      {3, 1}, {1, 1}, {1, 4}, {0, 4}};

} // namespace

TEST_CASE("concave polygons cover their area", "[polygon]") {
    check_area(u_shape, 10);
    check_area({{0, 0}, {2, 1}, {0, 2}, {.5, 1}}, 1.5);              // an arrow head
    check_area({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}}, 5); // an L
    check_area({{0, 0}, {5, 0}, {5, 1}, {3, 1}, {3, 4}, {2, 4}, {2, 1}, {0, 1}}, 8); // a T
    // A spiral of width 1 in a square of 5.
    check_area({{0, 0},
                {5, 0},
                {5, 5},
                {0, 5},
                {0, 2},
                {3, 2},
                {3, 3},
                {1, 3},
                {1, 4},
                {4, 4},
                {4, 1},
                {0, 1}},
               5 + 3 + 4 + 2 + 2 + 1);
}

TEST_CASE("corners on edges and repeated corners add nothing, and no triangle without area",
          "[polygon]") {
    const std::vector<std::vector<glm::dvec2>> squares{
        {{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}},
        {{0, 0}, {.5, 0}, {1, 0}, {1.5, 0}, {2, 0}, {2, 2}, {0, 2}},
        {{0, 0}, {2, 0}, {2, 0}, {2, 2}, {0, 2}, {0, 2}},
        {{0, 0}, {2, 0}, {2, 3}, {2, 2}, {0, 2}}, // a spike
        {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {0, 0}}};
    for (const auto &square : squares) {
        check_area(square, 4);
        CHECK(cover(flat(square)).smallest > .1);
    }
    // A triangle written as a quad.
    check_area({{0, 0}, {2, 0}, {0, 2}, {0, 2}}, 2);
    CHECK(cover(flat({{0, 0}, {2, 0}, {0, 2}, {0, 2}})).count == 1);
    // A U with corners within its edges.
    check_area(
        {{0, 0}, {2, 0}, {4, 0}, {4, 4}, {3, 4}, {3, 2}, {3, 1}, {2, 1}, {1, 1}, {1, 4}, {0, 4}},
        10);
}

TEST_CASE("polygons that touch themselves cover their area", "[polygon]") {
    // A square with a square hole, and the bridge there and back.
    check_area({{0, 0}, {6, 0}, {6, 6}, {0, 6}, {0, 0}, {2, 2}, {2, 4}, {4, 4}, {4, 2}, {2, 2}},
               32);
    // Two holes, the bridges from the same corner.
    check_area({{0, 0},
                {9, 0},
                {9, 4},
                {0, 4},
                {0, 0},
                {1, 1},
                {1, 3},
                {3, 3},
                {3, 1},
                {1, 1},
                {0, 0},
                {5, 1},
                {5, 3},
                {7, 3},
                {7, 1},
                {5, 1}},
               28);
    // Two triangles that share a corner, and a comb whose teeth touch the other side.
    check_area({{0, 0}, {1, 1}, {2, 0}, {2, 2}, {1, 1}, {0, 2}}, 2);
    check_area({{0, 0}, {4, 0}, {4, 3}, {3, 0}, {2, 3}, {1, 0}, {0, 3}}, 1.5 + 3 + 1.5);
    // A slit into a square.
    check_area({{0, 0}, {4, 0}, {4, 4}, {2, 4}, {2, 1}, {2, 4}, {0, 4}}, 16);
}

TEST_CASE("convex polygons stay fans", "[polygon]") {
    Corners circle;
    for (int i = 0; i < 100; ++i)
        circle.emplace_back(std::cos(2 * M_PI * i / 100), std::sin(2 * M_PI * i / 100), 5);
    PolygonCutter cutter;
    CHECK(cutter.cut(circle));
    REQUIRE(cutter.triangles().size() == 98);
    for (std::uint32_t i = 0; i < 98; ++i)
        CHECK(cutter.triangles()[i] == PolygonCutter::Triangle{0, i + 1, i + 2});
    CHECK(cover(circle).absolute == Approx(50 * std::sin(2 * M_PI / 100)));
}

TEST_CASE("stars of many random corners cover their area", "[polygon]") {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> radius(.05, 1);
    for (const int count : {5, 9, 50, 3000}) {
        // Star-shaped about a point that is no corner: the sum of its sectors.
        Corners star;
        for (int i = 0; i < count; ++i) {
            const double r = radius(random);
            star.emplace_back(glm::vec3(static_cast<float>(r * std::cos(2 * M_PI * i / count)),
                                        static_cast<float>(r * std::sin(2 * M_PI * i / count)), 1));
        }
        double area = 0;
        for (std::size_t i = 0; i < star.size(); ++i) {
            const glm::dvec3 &a = star[i];
            const glm::dvec3 &b = star[(i + 1) % star.size()];
            area += .5 * (a.x * b.y - a.y * b.x);
        }
        CAPTURE(count);
        const Cover result = cover(star);
        CHECK(result.is_right);
        CHECK(result.absolute == Approx(area).epsilon(1e-9));
    }
}

TEST_CASE("random polygons cover what the shoelace formula says", "[polygon]") {
    // Random points, joined so that no edges cross: crossings are undone one by one (2-opt). On the
    // small grid, most of them touch themselves.
    const auto cross = [](const glm::dvec2 &a, const glm::dvec2 &b) {
        return a.x * b.y - a.y * b.x;
    };
    const auto side = [&](const glm::dvec2 &a, const glm::dvec2 &b, const glm::dvec2 &c) {
        const double area = cross(b - a, c - a);
        return area > 0 ? 1 : area < 0 ? -1 : 0;
    };
    std::mt19937 random(5);
    std::size_t touching = 0;
    for (int i = 0; i < 2000; ++i) {
        const std::size_t count = 4 + random() % 12;
        const unsigned grid = i % 2 == 0 ? 5 : 1000;
        std::vector<glm::dvec2> p(count);
        for (glm::dvec2 &corner : p)
            corner = {random() % grid, random() % grid};
        const auto at = [&](std::size_t k) { return p[k % count]; };
        const auto uncross = [&] {
            for (std::size_t a = 0; a < count; ++a)
                for (std::size_t b = a + 2; b < count; ++b)
                    if (side(at(a), at(a + 1), at(b)) * side(at(a), at(a + 1), at(b + 1)) < 0 &&
                        side(at(b), at(b + 1), at(a)) * side(at(b), at(b + 1), at(a + 1)) < 0) {
                        std::reverse(p.begin() + static_cast<std::ptrdiff_t>(a) + 1,
                                     p.begin() + static_cast<std::ptrdiff_t>(b) + 1);
                        return true;
                    }
            return false;
        };
        while (uncross()) {
        }

        bool touches = false;
        double area = 0;
        for (std::size_t a = 0; a < count; ++a) {
            area += .5 * cross(at(a), at(a + 1));
            for (std::size_t b = a + 2; b < a + count; ++b)
                touches |= side(at(a), at(a + 1), at(b)) == 0 &&
                           glm::dot(at(b) - at(a), at(b) - at(a + 1)) <= 0;
        }
        const Cover result = cover(flat(p));
        touching += touches && result.is_right ? 1 : 0;
        // What touches itself may also cross itself there.
        if (result.is_right || !touches)
            CHECK(result.absolute == Approx(std::abs(area)).margin(1e-9));
        if (!touches && area != 0)
            CHECK(result.is_right);
    }
    CHECK(touching > 300);
}

TEST_CASE("polygons that are not plane are cut along their normal", "[polygon]") {
    // The U, bent upwards by up to 5%: its projection keeps the area of 10.
    Corners bent;
    for (const glm::dvec2 &c : u_shape)
        bent.emplace_back(c, .05 * std::sin(5 * c.x + 3 * c.y));
    const Cover result = cover(bent);
    CHECK(result.is_right);
    CHECK(result.area.z == Approx(10));
    CHECK(result.absolute == Approx(10).epsilon(.01));
}

TEST_CASE("a polygon whose edges cross is a fan, and said to be one", "[polygon]") {
    Corners pentagram;
    for (int i = 0; i < 5; ++i)
        pentagram.emplace_back(std::cos(.8 * M_PI * i), std::sin(.8 * M_PI * i), 0);
    CHECK_FALSE(cover(pentagram).is_right);
    CHECK(cover(pentagram).count == 3);
    CHECK_FALSE(cover(flat({{0, 0}, {2, 2}, {2, 0}, {0, 2}})).is_right); // no area in all
    CHECK_FALSE(cover(flat({{0, 0}, {3, 3}, {3, 0}, {0, 2}})).is_right);
    CHECK(cover(flat({{0, 0}, {1, 0}, {3, 0}, {2, 0}})).is_right); // a line

    const test::ScratchFolder folder;
    const std::string path =
        folder.file("bow.obj", "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 0 2 0\nf 1 2 3 4\nf 1 3 2 4\n");
    CHECK(test::stderr_of([&] {
              read_obj_mesh(path, {});
          }).starts_with(path + ":6: warning: polygon 2 of the file has edges that cross"));
}

TEST_CASE("hostile polygons end soon", "[polygon]") {
    // A comb of 20,000 teeth, and points without any order.
    Corners comb{{-1, -1, 0}, {40'001, -1, 0}};
    for (int i = 40'000; i >= 0; --i)
        comb.emplace_back(i, i % 2 == 0 ? 0 : 1e4, 0);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(-1, 1);
    Corners noise;
    for (int i = 0; i < 60'000; ++i)
        noise.emplace_back(place(random), place(random), place(random));
    const auto start = std::chrono::steady_clock::now();
    CHECK(cover(comb).absolute > 0);
    CHECK_FALSE(cover(noise).is_right);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    CHECK(seconds.count() < 30); // about 1 s on an idle core, without sanitizers
}

TEST_CASE("OBJ and PLY polygons with coordinates and normals keep their corners", "[polygon]") {
    const test::ScratchFolder folder;
    std::string obj;
    std::string ply =
        "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\n"
        "element vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
        "property float u\nproperty float v\nend_header\n8 0 1 2 3 4 5 6 7\n";
    std::string face = "f";
    for (std::size_t i = 0; i < u_shape.size(); ++i) {
        const glm::dvec2 &c = u_shape[i];
        obj += fmt::format("v {} {} 2\nvt {} {}\nvn 0 0 1\n", c.x, c.y, c.x / 4, c.y / 4);
        ply += fmt::format("{} {} 2 {} {}\n", c.x, c.y, c.x / 4, c.y / 4);
        face += fmt::format(" {0}/{0}/{0}", i + 1);
    }
    for (const Mesh &mesh : {read_obj_mesh(folder.file("u.obj", obj + face + "\n"), {}),
                             read_ply_mesh(folder.file("u.ply", ply), {})}) {
        double area = 0;
        double uv_area = 0;
        for (const auto &t : mesh.triangles) {
            const auto at = [&](int i) { return mesh.positions[t[static_cast<std::size_t>(i)]]; };
            const auto uv = [&](int i) {
                return glm::dvec2(mesh.uvs[t[static_cast<std::size_t>(i)]]);
            };
            area += .5 * glm::cross(at(1) - at(0), at(2) - at(0)).z;
            const glm::dvec2 a = uv(1) - uv(0);
            const glm::dvec2 b = uv(2) - uv(0);
            uv_area += .5 * std::abs(a.x * b.y - a.y * b.x);
        }
        CHECK(area == Approx(10));
        CHECK(uv_area == Approx(10. / 16));
        CHECK(mesh.normals.at(0) == glm::vec3(0, 0, 1));
        CHECK(mesh.positions.size() == 8);
    }
}
