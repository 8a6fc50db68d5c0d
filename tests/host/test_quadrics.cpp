/// Cylinders and stretched spheres as they are read, and what the host makes of them.

#include "flatten/flat_scene.h"
#include "mitsuba_text_scene.h"
#include "scene/shape_bounds.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

using namespace clrender;

namespace {

Shape shape_of(const std::string &xml) {
    return test::load_text(xml).shapes.at(0);
}

std::string placed(const std::string &type, const std::string &transform,
                   const std::string &more = "") {
    return fmt::format(R"(<shape type="{}">{}<transform name="to_world">{}</transform></shape>)",
                       type, more, transform);
}

glm::dvec3 point_of(const Shape &shape, double x, double y, double z) {
    return {shape.to_world * glm::dvec4(x, y, z, 1)};
}

/// A point of the surface: of the unit sphere, or of the cylinder's wall.
glm::dvec3 surface_point(const Shape &shape, double a, double phi) {
    const double r = shape.kind == ShapeKind::cylinder ? 1 : 2 * std::sqrt(a * (1 - a));
    const double z = shape.kind == ShapeKind::cylinder ? a : 2 * a - 1;
    return point_of(shape, r * std::cos(phi), r * std::sin(phi), z);
}

const char *const uneven = R"(<scale x=".5" y="2" z="-1.3"/>
    <matrix value="1 .3 .2 0  0 1 -.4 0  0 0 1 0  0 0 0 1"/><rotate x=".6" z=".8" y="0" angle="50"/>
    <translate x="3" y="-2" z="1"/>)";

} // namespace

TEST_CASE("a cylinder runs from p0 to p1, its angle as Mitsuba's", "[quadrics]") {
    const Shape plain = shape_of(R"(<shape type="cylinder"/>)");
    CHECK(plain.kind == ShapeKind::cylinder);
    CHECK(plain.to_world == glm::dmat4(1.0));

    const Shape turned = shape_of(R"(<shape type="cylinder"><point name="p0" x="1" y="2" z="3"/>
        <point name="p1" x="1" y="6" z="3"/><float name="radius" value=".5"/></shape>)");
    CHECK(glm::length(point_of(turned, 0, 0, 0) - glm::dvec3(1, 2, 3)) < 1e-12);
    CHECK(glm::length(point_of(turned, 0, 0, 1) - glm::dvec3(1, 6, 3)) < 1e-12);
    // The frame around y that Mitsuba's coordinate_system() gives: +x, then -z.
    CHECK(glm::length(point_of(turned, 1, 0, 0) - glm::dvec3(1.5, 2, 3)) < 1e-12);
    CHECK(glm::length(point_of(turned, 0, 1, 0) - glm::dvec3(1, 2, 2.5)) < 1e-12);
}

TEST_CASE("a sphere that is stretched is an ellipsoid, one that is turned is not", "[quadrics]") {
    CHECK(shape_of(placed("sphere", R"(<scale value="3"/><rotate z="1" angle="30"/>)")).kind ==
          ShapeKind::sphere);
    CHECK(shape_of(placed("sphere", R"(<scale x="-2" y="2" z="2"/>)")).kind == ShapeKind::sphere);
    CHECK(shape_of(placed("sphere", R"(<scale x="3" y="3" z="3.01"/>)")).kind ==
          ShapeKind::ellipsoid);
    CHECK(shape_of(placed("sphere", uneven)).kind == ShapeKind::ellipsoid);
}

TEST_CASE("boxes and ranges of ellipsoids and cylinders are tight", "[quadrics]") {
    const glm::dvec3 axis = glm::normalize(glm::dvec3(1, -2, 0.5)), origin(0.3, 0.2, 0.1);
    for (const char *type : {"sphere", "cylinder"}) {
        const Shape shape = shape_of(placed(type, uneven, R"(<float name="radius" value=".7"/>)"));
        Box box;
        Range range;
        constexpr int steps = 500;
        for (int i = 0; i <= steps; ++i)
            for (int j = 0; j < steps; ++j) {
                const glm::dvec3 p =
                    surface_point(shape, double(i) / steps, 2 * std::numbers::pi * j / steps);
                box.add(p);
                range.add(glm::dot(p - origin, axis));
            }
        const Box found = shape_box(shape);
        const Range reach = shape_range(shape, found, origin, axis);
        CHECK(glm::length(found.low - box.low) < 1e-3);
        CHECK(glm::length(found.high - box.high) < 1e-3);
        CHECK(std::abs(reach.low - range.low) < 1e-3);
        CHECK(std::abs(reach.high - range.high) < 1e-3);
        CHECK(glm::all(glm::lessThanEqual(found.low, box.low + 1e-12)));
        CHECK(glm::all(glm::greaterThanEqual(found.high, box.high - 1e-12)));

        // The tree's box, in the renderer's coordinates.
        const Scene scene =
            test::load_text(placed(type, uneven, R"(<float name="radius" value=".7"/>)"));
        const FlatScene flat = flatten(scene);
        const BvhQuadric &leaf = flat.bvh_quadrics.at(0);
        CHECK(glm::all(glm::lessThan(glm::dvec3(leaf.lower), flat.placement.exact(found.low))));
        CHECK(glm::all(glm::greaterThan(glm::dvec3(leaf.upper), flat.placement.exact(found.high))));
        CHECK(glm::length(glm::dvec3(leaf.upper - leaf.lower)) <
              1.0001 * glm::length(found.high - found.low) * flat.placement.scale);
    }
}

TEST_CASE("instances of spheres and cylinders are those of their transforms", "[quadrics]") {
    for (const char *type : {"sphere", "cylinder", "disk"}) {
        const Scene scene =
            test::load_text(fmt::format(R"(<shape type="shapegroup" id="g"><shape type="{}">
            <transform name="to_world"><translate x=".5" y="0" z="0"/></transform></shape></shape>
            <shape type="instance"><ref id="g"/><transform name="to_world">{}</transform></shape>)",
                                        type, uneven));
        const Shape plain =
            shape_of(placed(type, std::string(R"(<translate x=".5" y="0" z="0"/>)") + uneven));
        REQUIRE(scene.shapes.size() == 1);
        const Shape &copy = scene.shapes[0];
        CHECK(copy.kind == plain.kind);
        for (int i = 0; i < 4; ++i)
            CHECK(glm::length(copy.to_world[i] - plain.to_world[i]) < 1e-12);
        // The transform mirrors: a sphere of its own turns inside out by it, an instance does not.
        CHECK(copy.flip_normals == (plain.kind == ShapeKind::ellipsoid));
        CHECK_FALSE(plain.flip_normals);
    }
}

TEST_CASE("cylinders and spheres that cannot be are refused with their line", "[quadrics]") {
    const auto error = [](const std::string &type, const std::string &content) {
        return test::error_of_text("<shape type='" + type + "'>\n" + content + "</shape>");
    };
    for (const char *value : {"0", "-1", "nan"})
        CHECK(error("cylinder", fmt::format("<float name='radius' value='{}'/>", value))
                  .starts_with("3: "));
    CHECK(error("cylinder", "<point name='p0' x='0' y='0' z='1'/>") ==
          "2: shape \"cylinder\" has no length, expected p0 and p1 that differ");
    for (const char *type : {"sphere", "cylinder"}) {
        CHECK(error(type, "<transform name='to_world'><scale x='0' y='1' z='1'/></transform>")
                  .find("singular") != std::string::npos);
        CHECK(error(type, "<transform name='to_world'><scale x='1e-9' y='1' z='1'/></transform>")
                  .find("2: shape \"" + std::string(type) +
                        "\" is stretched more than 1e8 times") == 0);
        CHECK(error(type, "<transform name='to_world'><scale x='1e-7' y='1' z='1'/></transform>") ==
              "");
    }
    CHECK(error("cylinder", "<float name='hight' value='1'/>").starts_with("3: "));
}

TEST_CASE("many disks become leaves of the tree", "[quadrics]") {
    std::string xml;
    for (int i = 0; i < 16; ++i)
        xml += placed("disk", fmt::format(R"(<translate x="{}" y="0" z="0"/>)", i));
    const FlatScene few = flatten(test::load_text(xml));
    CHECK(few.planars.size() == 16);
    CHECK(few.quadrics.empty());
    xml += placed("disk", R"(<translate x="16" y="0" z="0"/>)");
    const FlatScene flat = flatten(test::load_text(xml));
    CHECK(flat.planars.empty());
    CHECK(flat.quadrics.size() == 17);
}
