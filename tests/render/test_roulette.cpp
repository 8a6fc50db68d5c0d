/// Roulette: which kind a scene gets, and that a weight window leaves the mean of a picture alone.

#include "flatten/config_of.h"
#include "flatten/flat_scene.h"
#include "render_adapter.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>

using namespace clrender;
using namespace clrender::test;

namespace {

std::string integrator(const std::string &type, const std::string &parameters) {
    return fmt::format(R"(<integrator type="{}">{}</integrator>)", type, parameters);
}

std::string depth(const char *name, int value) {
    return fmt::format(R"(<integer name="{}" value="{}"/>)", name, value);
}

/// A camera in a closed room of albedo a that emits 1 all over: every pixel has 1/(1-a).
std::string furnace(const std::string &room, double a) {
    return fmt::format(
        R"(<sensor type="perspective"><transform name="to_world">
            <lookat origin=".1 .2 -.3" target="0 0 1" up="0 1 0"/></transform>
            <film type="hdrfilm"><integer name="width" value="16"/>
            <integer name="height" value="16"/><rfilter type="box"/></film></sensor>
        <shape type="{}"><boolean name="flip_normals" value="true"/>
            <bsdf type="diffuse"><rgb name="reflectance" value="{}"/></bsdf>
            <emitter type="area"><rgb name="radiance" value="1"/></emitter></shape>)",
        room, a);
}

/// Aslant, so that it is triangles in a tree.
const std::string cube = R"(<shape type="cube"><transform name="to_world">
    <matrix value="1 .1 0 0  0 1 0 0  0 0 1 0  0 0 0 1"/></transform></shape>)";

int roulette(const std::string &integrator, const std::string &shape = cube) {
    return config_of(flatten(scene_from_xml(integrator + shape)), {}).ROULETTE;
}

} // namespace

TEST_CASE("roulette is a weight window where no depth is stated, and paths are long enough") {
    const std::string sphere = R"(<shape type="sphere"/>)";
    CHECK(roulette("") == CLR_ROULETTE_WINDOW);
    CHECK(roulette("", sphere) == CLR_ROULETTE_WINDOW);
    const auto limited = [](int most) { return integrator("path", depth("max_depth", most)); };
    CHECK(roulette(limited(3)) == CLR_ROULETTE_WINDOW);
    CHECK(roulette(limited(2)) == CLR_ROULETTE_NONE);
    CHECK(roulette(limited(11), sphere) == CLR_ROULETTE_WINDOW);
    CHECK(roulette(limited(10), sphere) == CLR_ROULETTE_NONE);
    CHECK(roulette(integrator("path", depth("rr_depth", 5))) == CLR_ROULETTE_DEPTH);
    const std::string never = depth("max_depth", 8) + depth("rr_depth", 8);
    CHECK(roulette(integrator("path", never)) == CLR_ROULETTE_NONE);
    CHECK(roulette(integrator("direct", "")) == CLR_ROULETTE_NONE);
    CHECK(roulette(integrator("depth", "")) == CLR_ROULETTE_NONE);
}

TEST_CASE("furnace: a weight window leaves 1/(1-a) in a closed room of albedo a") {
    // Rays in a cube walk a tree: dark ones are rouletted at the second vertex. In a bright sphere
    // most paths pass the depth from which all may end.
    const auto [room, a] = GENERATE(table<std::string, double>(
        {{"cube", 0.1}, {"cube", 0.5}, {"sphere", 0.5}, {"sphere", 0.95}}));
    const auto picture = render_measured(scene_from_xml(furnace(room, a)), {.spp = 1024});
    INFO(room << ", albedo " << a);
    for (int c = 0; c < 3; ++c) {
        const double error = channel_mean(picture.mean, c) - 1 / (1 - a);
        CHECK(std::abs(error) <= 4 * picture.mean_se[static_cast<std::size_t>(c)]);
        CHECK(picture.mean_se[static_cast<std::size_t>(c)] * (1 - a) <= 1e-3);
    }
}
