#include "embree_scene.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <tbb/parallel_for.h>

namespace clrender::bench {

namespace {

/// Rays of one task.
constexpr std::size_t kGrain = 4096;
/// Farther than the self-hit at the start of a ray; clrender leaves out the primitive instead.
constexpr float kNear = 1e-4f;

RTCRay embree_ray(const BvhProbeRay &ray) {
    return {ray.o[0], ray.o[1], ray.o[2],  kNear,       ray.d[0], ray.d[1],
            ray.d[2], 0.0f,     ray.t_max, 0xffffffffu, 0,        0};
}

void set_ray(RTCRay8 &rays, std::size_t lane, const BvhProbeRay &ray) {
    rays.org_x[lane] = ray.o[0];
    rays.org_y[lane] = ray.o[1];
    rays.org_z[lane] = ray.o[2];
    rays.dir_x[lane] = ray.d[0];
    rays.dir_y[lane] = ray.d[1];
    rays.dir_z[lane] = ray.d[2];
    rays.tnear[lane] = kNear;
    rays.tfar[lane] = ray.t_max;
    rays.mask[lane] = 0xffffffffu;
}

/// Calls `trace(context, first ray, end)` for all rays, task by task.
template <class Trace> void for_each_task(const Rays &rays, const Trace &trace) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rays.size(), kGrain),
                      [&](const tbb::blocked_range<std::size_t> &range) {
                          RTCIntersectContext context;
                          rtcInitIntersectContext(&context);
                          trace(context, range.begin(), range.end());
                      });
}

} // namespace

EmbreeScene::EmbreeScene(const Triangles &triangles, RTCBuildQuality quality) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto *vertices = static_cast<glm::vec3 *>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                sizeof(glm::vec3), 3 * triangles.size()));
    auto *indices = static_cast<uint *>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint), triangles.size()));
    for (std::size_t i = 0; i < 3 * triangles.size(); ++i) {
        vertices[i] = triangles[i / 3][i % 3];
        indices[i] = uint(i);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneBuildQuality(scene_, quality);
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t cpu_start = std::clock();
    rtcCommitScene(scene_);
    wall_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    cpu_seconds_ = double(std::clock() - cpu_start) / CLOCKS_PER_SEC;
}

EmbreeScene::~EmbreeScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
}

void EmbreeScene::trace_single(const RaySet &set) const {
    for_each_task(set.rays, [&](RTCIntersectContext &context, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            RTCRayHit query{};
            query.ray = embree_ray(set.rays[i]);
            query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            if (set.any) {
                rtcOccluded1(scene_, &context, &query.ray);
            } else {
                rtcIntersect1(scene_, &context, &query);
            }
        }
    });
}

void EmbreeScene::trace_packets(const RaySet &set) const {
    for_each_task(set.rays, [&](RTCIntersectContext &context, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; i += 8) {
            alignas(32) int valid[8]{};
            RTCRayHit8 query{};
            for (std::size_t lane = 0; lane < std::min<std::size_t>(8, end - i); ++lane) {
                valid[lane] = -1;
                set_ray(query.ray, lane, set.rays[i + lane]);
                query.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
            }
            if (set.any) {
                rtcOccluded8(valid, scene_, &context, &query.ray);
            } else {
                rtcIntersect8(valid, scene_, &context, &query);
            }
        }
    });
}

} // namespace clrender::bench
