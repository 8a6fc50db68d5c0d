/// Kernels that can do more than their scene needs give the same picture.

#include "render_adapter.h"

#include "device/cl_context.h"
#include "device/kernel_program.h"
#include "device/kernel_sources.h"
#include "film/metrics.h"
#include "flatten/config_of.h"
#include "flatten/flat_scene.h"

#include <catch2/catch.hpp>

using namespace clrender;
using namespace clrender::test;

namespace {

/// The front end of the device's compiler takes a kernel with these features. Throws its log.
void expect_compiles(const Scene &scene, const ForcedFeatures &features) {
    static const DeviceEntry device = choose_device("auto");
    static const cl::Context context(device.device);
    static const std::string text = join_sources(embedded_kernel_sources(), "path_trace.cl");
    const SamplingOptions sampling{.forced_features = features};
    const KernelConfig config = config_of(flatten(scene, sampling), sampling);
    CHECK_NOTHROW(compile_program(context, device.device, text, config.build_options()));
}

/// The same samples: what differs is rounding, and the few paths that it sends elsewhere.
void check_same(const std::string &name, const Scene &scene, const TestRender &own,
                const TestRender &general) {
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
    // The scene's own kernel is the one that its reference test compiles.
    check_same("everything " + name, scene, {.spp = 16},
               {.spp = 16, .lanes = 4, .forced_features = all_features()});
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
    // Each compiles alone; what they compute is looked at in groups, for most of the time goes into
    // making machine code.
    constexpr std::size_t groups = 10;
    std::vector<ForcedFeatures> grouped(groups);
    std::size_t next = 0;
    for (const std::string &name : all_features()) {
        INFO(name);
        expect_compiles(scene, {name});
        grouped[next++ % groups].insert(name);
    }
    for (const ForcedFeatures &features : grouped) {
        std::string names;
        for (const std::string &name : features)
            names += name + ' ';
        INFO(names);
        check_same("more features", scene, {.spp = 16, .lanes = 1},
                   {.spp = 16, .lanes = 1, .forced_features = features});
    }
}

TEST_CASE("walls that are left out of shadow tests change no bit") {
    // Lights of several kinds in rooms and above floors, with and without a hierarchy; and a point
    // light in the plane of its wall.
    const auto reference = [](const std::string &name) {
        return load_scene(std::string(CLRENDER_TEST_DIR) + "/references/" + name + ".xml");
    };
    const Scene scenes[] = {reference("lights_many"),
                            reference("dielectrics"),
                            reference("meshes_obj"),
                            reference("hide_area"),
                            reference("roulette"),
                            scene_from_xml(R"(
        <sensor type="perspective"><transform name="to_world">
            <lookat origin="0 0 4" target="0 0 0" up="0 1 0"/></transform>
            <film type="hdrfilm"><integer name="width" value="32"/>
                <integer name="height" value="32"/></film></sensor>
        <shape type="sphere"><float name="radius" value=".5"/></shape>
        <shape type="rectangle"><transform name="to_world"><scale value="3"/>
            <rotate y="1" angle="50"/><translate x="-1.1" z="-.7"/></transform></shape>
        <emitter type="point"><point name="position" x="-1.1" y="1.2" z="-.7"/></emitter>)")};
    const Scene &scene = scenes[GENERATE(range(0, 6))];
    CHECK(config_of(flatten(scene), {}).SHADOWLESS_PLANAR_COUNT > 0);
    const TestRender without{.spp = 16}; // with the kernels of the reference tests
    TestRender with = without;
    with.forced_features = {"SHADOWLESS_PLANAR_COUNT"};
    const Image a = render_measured(scene, without).mean;
    const Image b = render_measured(scene, with).mean;
    CHECK(a.f32 == b.f32);
}

TEST_CASE("rectangles across an axis are met where others are, with the same coordinates") {
    // Every way round: quarter turns in the plane, mirrored, stretched, and one a little aslant.
    std::string shapes;
    for (const char *place : {
             R"(<scale x="1.5" y=".5"/><translate x="-.3" y=".2" z="-2"/>)",
             R"(<rotate z="1" angle="90"/><scale x="3" y="2" z="-1"/><translate z="-2.5"/>)",
             R"(<rotate x="1" angle="-90"/><scale x="3" z="2"/><translate y="-1.25" z=".5"/>)",
             R"(<matrix value="0 1 0 0  4.37114e-8 0 -1 1.5  -1 0 -4.37114e-8 0  0 0 0 1"/>)",
             R"(<rotate y="1" angle="90"/><scale z="2"/><translate x="-2"/>)",
             R"(<rotate z="1" angle="180"/><rotate y="1" angle="-90"/><translate x="1.75"/>)",
             R"(<scale x="-.2" y=".4"/><rotate y="1" angle=".001"/><translate x="1" z="-1"/>)",
         })
        shapes += std::string(R"(<shape type="rectangle"><transform name="to_world">)") + place +
                  R"(</transform><bsdf type="twosided"><bsdf type="diffuse">
                     <texture type="checkerboard" name="reflectance">
                     <rgb name="color0" value=".9 .2 .1"/><rgb name="color1" value=".1 .3 .8"/>
                     <transform name="to_uv"><scale x="2.3" y="1.1"/><translate x=".15"/>
                     </transform></texture></bsdf></bsdf></shape>)";
    const Scene scene = scene_from_xml(R"(
        <sensor type="perspective">
            <transform name="to_world"><lookat origin=".1 .2 2.5" target="0 0 0" up="0 1 0"/>
            </transform><float name="fov" value="70"/>
            <film type="hdrfilm"><integer name="width" value="48"/>
                <integer name="height" value="48"/></film>
        </sensor>
        <emitter type="constant"/>
        <emitter type="point"><point name="position" x="0" y=".3" z="1"/></emitter>)" +
                                       shapes);
    int across = 0;
    const int axes = config_of(flatten(scene), {}).PLANAR_AXES;
    for (int i = 0; i < 7; ++i)
        across += (axes >> 2 * i & 3) != 0 ? 1 : 0;
    CHECK(across == 6);
    for (const int lanes : {1, 8})
        check_same("rectangles across axes", scene, {.spp = 16, .lanes = lanes},
                   {.spp = 16, .lanes = lanes, .forced_features = {"PLANAR_AXES"}});
}
