/// Instances show what copies of their shapes would, from every side and at every width.

#include "render_adapter.h"

#include "flatten/flat_scene.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <fmt/format.h>

using namespace clrender;
using namespace clrender::test;

namespace {

/// Without vertex normals, whose lengths count between the corners once a copy has stretched them.
constexpr const char *group_shapes = R"(
    <shape type="obj"><string name="filename" value="data/blob.obj"/>
        <boolean name="face_normals" value="true"/>{0}
        <bsdf type="diffuse"><texture type="checkerboard" name="reflectance">
            <transform name="to_uv"><scale x="5" y="3"/></transform></texture></bsdf></shape>
    <shape type="cube"><transform name="to_world"><scale value=".3"/>
        <translate x=".4" y="1.2" z="0"/>{1}</transform>
        <bsdf type="twosided"><bsdf type="roughconductor"><float name="alpha" value=".2"/>
        </bsdf></bsdf></shape>)";

/// Transforms with positive determinants: flat faces turn over where a copy is mirrored, and do not
/// where an instance is.
constexpr const char *places[] = {
    R"(<translate x="-1.6" y=".2" z=".4"/>)",
    R"(<scale x=".5" y=".8" z=".4"/><rotate x=".6" y=".8" angle="70"/><translate x="1.5"/>)",
    R"(<matrix value=".5 .3 0 0  0 .6 .1 -.6  -.2 0 .5 1.5  0 0 0 1"/>)"};

std::string frame(const std::string &shapes) {
    return R"(<integrator type="path"><integer name="max_depth" value="2"/></integrator>
        <sensor type="perspective"><transform name="to_world">
            <lookat origin="0 1.5 7" target="0 0 0" up="0 1 0"/></transform>
            <film type="hdrfilm"><rfilter type="box"/><integer name="width" value="64"/>
            <integer name="height" value="48"/></film></sensor>
        <emitter type="point"><point name="position" x="2" y="4" z="5"/>
            <rgb name="intensity" value="30"/></emitter>
        <emitter type="point"><point name="position" x="-4" y="3" z="1"/>
            <rgb name="intensity" value="10"/></emitter>
        <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/>
            <scale value="5"/><translate y="-1"/></transform></shape>)" +
           shapes;
}

std::string instances() {
    std::string xml = fmt::format(R"(<shape type="shapegroup" id="group">{}</shape>)",
                                  fmt::format(fmt::runtime(group_shapes), "", ""));
    for (const char *place : places)
        xml += fmt::format(R"(<shape type="instance"><ref id="group"/>
            <transform name="to_world">{}</transform></shape>)",
                           place);
    return frame(xml);
}

std::string copies() {
    std::string xml;
    for (const char *place : places)
        xml +=
            fmt::format(fmt::runtime(group_shapes),
                        fmt::format(R"(<transform name="to_world">{}</transform>)", place), place);
    return frame(xml);
}

/// Pixels whose values differ by more than rounding, of one sample at their centres, which edges of
/// shapes and shadows may miss.
int different_pixels(const Image &a, const Image &b) {
    int different = 0;
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x) {
            double difference = 0, size = 0;
            for (int c = 0; c < 3; ++c) {
                difference += std::abs(value_at(a, x, y, c) - value_at(b, x, y, c));
                size += value_at(b, x, y, c);
            }
            different += difference <= 1e-3 * size ? 0 : 1;
        }
    return different;
}

} // namespace

TEST_CASE("instances show what copies do, at every width and in double precision") {
    const Scene scene = scene_from_xml(instances());
    CHECK(scene.instances.size() == 3);
    CHECK(scene.shapes.size() == 1);
    TestRender how{.spp = 1, .lanes = 8, .pixel_centers = true};
    const Image expected = render_measured(scene_from_xml(copies()), how).mean;
    REQUIRE(channel_mean(expected, 1) > 0.01);
    const auto check = [&](const TestRender &with) {
        INFO("lanes " << with.lanes << (with.double_precision ? ", double" : ""));
        CHECK(different_pixels(render_measured(scene, with).mean, expected) <= 3);
    };
    for (const int lanes : {1, 4, 16}) {
        how.lanes = lanes;
        check(how);
    }
    how.lanes = 1;
    how.double_precision = true;
    check(how);
}

TEST_CASE("instances share the triangles of their group") {
    const FlatScene flat = flatten(scene_from_xml(instances()));
    const FlatScene copied = flatten(scene_from_xml(copies()));
    CHECK(flat.instances.size() == 3);
    CHECK(flat.triangle_count * 3 == copied.triangle_count);
}
