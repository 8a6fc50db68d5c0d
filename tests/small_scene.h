#pragma once
/// Scenes that are quick on any device.

#include <fmt/core.h>

#include <string>

namespace clrender::test {

/// A floor under a point light.
struct LitFloor {
    int width = 16, height = 12, samples = 4;
    std::string power = "10";
    std::string defaults; ///< in lines of their own before all else
};

inline std::string scene_of(const LitFloor &floor) {
    return fmt::format(R"(<scene version="3.0.0">
{}    <integrator type="path"><integer name="max_depth" value="4"/></integrator>
    <sensor type="perspective">
        <float name="fov" value="60"/>
        <transform name="to_world"><lookat origin="0,3,-3" target="0,0,0" up="0,1,0"/></transform>
        <film type="hdrfilm">
            <integer name="width" value="{}"/><integer name="height" value="{}"/>
        </film>
        <sampler type="independent"><integer name="sample_count" value="{}"/></sampler>
    </sensor>
    <shape type="rectangle">
        <transform name="to_world"><rotate x="1" angle="-90"/><scale value="5"/></transform>
    </shape>
    <emitter type="point">
        <point name="position" x="0" y="2" z="0"/><rgb name="intensity" value="{}"/>
    </emitter>
</scene>
)",
                       floor.defaults, floor.width, floor.height, floor.samples, floor.power);
}

inline const std::string lit_floor = scene_of({});

} // namespace clrender::test
