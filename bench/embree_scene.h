#pragma once
/// Embree's traversal and builder, on the same rays and triangles.

#include "traversal_rays.h"

#include <embree3/rtcore.h>

namespace clrender::bench {

class EmbreeScene {
public:
    EmbreeScene(const Triangles &triangles, RTCBuildQuality quality);
    ~EmbreeScene();
    EmbreeScene(const EmbreeScene &) = delete;
    EmbreeScene &operator=(const EmbreeScene &) = delete;

    /// rtcIntersect1, or rtcOccluded1 where any hit will do, over all threads.
    void trace_single(const RaySet &set) const;
    /// The same by rtcIntersect8 and rtcOccluded8, neighbours together.
    void trace_packets(const RaySet &set) const;

    /// Of the build alone, without the copy of the triangles.
    [[nodiscard]] double build_wall_seconds() const { return wall_seconds_; }
    [[nodiscard]] double build_cpu_seconds() const { return cpu_seconds_; }

private:
    RTCDevice device_ = rtcNewDevice(nullptr);
    RTCScene scene_ = rtcNewScene(device_);
    double wall_seconds_ = 0.0;
    double cpu_seconds_ = 0.0;
};

} // namespace clrender::bench
