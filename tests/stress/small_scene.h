#pragma once
/// A lit floor of 16 x 12 pixels, quick on any device.

namespace clrender::test {

inline constexpr const char *lit_floor = R"(<scene version="3.0.0">
    <integrator type="path"><integer name="max_depth" value="4"/></integrator>
    <sensor type="perspective">
        <float name="fov" value="60"/>
        <transform name="to_world"><lookat origin="0,3,-3" target="0,0,0" up="0,1,0"/></transform>
        <film type="hdrfilm">
            <integer name="width" value="16"/><integer name="height" value="12"/>
        </film>
        <sampler type="independent"><integer name="sample_count" value="4"/></sampler>
    </sensor>
    <shape type="rectangle">
        <transform name="to_world"><rotate x="1" angle="-90"/><scale value="5"/></transform>
    </shape>
    <emitter type="point">
        <point name="position" x="0" y="2" z="0"/><rgb name="intensity" value="10"/>
    </emitter>
</scene>
)";

} // namespace clrender::test
