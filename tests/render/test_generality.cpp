/// Kernels that can do more than their scene needs give the same picture.

#include "render_adapter.h"

#include "film/metrics.h"
#include "flatten/generality.h"

#include <catch2/catch.hpp>

using namespace clrender;
using namespace clrender::test;

namespace {

/// The same samples: what differs is rounding, and the few paths that it sends elsewhere.
void check_same(const std::string &name, const Scene &scene, const TestRender &own,
                const Generality &generality) {
    TestRender general = own;
    general.generality = generality;
    const auto a = render_measured(scene, own);
    const auto b = render_measured(scene, general);
    const auto verdict = compare_or_save(name, a, b);
    INFO(verdict.summary);
    CHECK(verdict.passes);
    CHECK(compare_images(a.mean, b.mean, name).rel_mse_trimmed < 1e-4);
}

} // namespace

TEST_CASE("a kernel that can do everything gives the same picture") {
    // Together they touch all of kernel_config.def.
    const std::string name =
        GENERATE(as<std::string>(), "spheres", "furnace_open", "lights_point", "meshes_ply",
                 "conductors", "texture_shapes", "envmap_sun", "camera_thinlens", "distance");
    INFO(name);
    const Scene scene = load_scene(std::string(CLRENDER_TEST_DIR) + "/references/" + name + ".xml");
    check_same("everything " + name, scene, {.spp = 16, .lanes = 4}, full_generality());
}

TEST_CASE("a kernel that can do one thing more gives the same picture") {
    // A light of no kind that can be sampled, and neither a mesh nor a rectangle.
    const Scene scene = scene_from_xml(R"(
        <sensor type="perspective">
            <transform name="to_world"><lookat origin="0 0 4" target="0 0 0" up="0 1 0"/></transform>
            <film type="hdrfilm"><integer name="width" value="16"/>
                <integer name="height" value="16"/></film>
        </sensor>
        <shape type="sphere"/>
        <emitter type="constant"><rgb name="radiance" value=".2 .4 .6"/></emitter>)");
    for (const std::string &name : full_generality()) {
        INFO(name);
        check_same(name, scene, {.spp = 16, .lanes = 1}, {name});
    }
}

TEST_CASE("walls that are left out of shadow tests change no bit") {
    // Lights of several kinds in rooms and above floors, with and without a hierarchy.
    const std::string name = GENERATE(as<std::string>(), "lights_many", "dielectrics", "meshes_obj",
                                      "hide_area", "roulette");
    INFO(name);
    const Scene scene = load_scene(std::string(CLRENDER_TEST_DIR) + "/references/" + name + ".xml");
    const TestRender without{.spp = 16, .lanes = 8};
    TestRender with = without;
    with.generality = {"SHADOWLESS_PLANAR_COUNT"};
    const Image a = render_measured(scene, without).mean;
    const Image b = render_measured(scene, with).mean;
    CHECK(a.f32 == b.f32);
}
