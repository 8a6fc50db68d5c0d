/// How fast the tree is walked: million rays a second for the rays of a camera, for diffuse bounces
/// off what the camera sees, and for shadow rays from there to a point.
///
///     bench_traversal MODEL.obj [KERNEL_DIR...]
///
/// Without a KERNEL_DIR the embedded kernels run. Several folders are measured in turns, round
/// after round, so that a ratio between two of them does not depend on what else the machine does.

#include "cl_test_device.h"
#include "flatten/bvh_builder.h"
#include "shared/bvh_probe.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <random>
#include <sstream>
#include <tbb/parallel_for.h>
#ifdef CLRENDER_BENCH_EMBREE
#include <embree3/rtcore.h>
#endif

using namespace clrender;

namespace {

using Triangles = std::vector<std::array<glm::vec3, 3>>;
using Rays = std::vector<BvhProbeRay>;
using Hits = std::vector<BvhProbeHit>;

constexpr int kImageSize = 1024;
constexpr int kRounds = 7;

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Positions and faces of an OBJ file; polygons become fans.
Triangles read_obj(const std::string &path) {
    std::ifstream file(path);
    if (!file) {
        throw std::runtime_error("cannot read " + path);
    }
    std::vector<glm::vec3> vertices;
    Triangles triangles;
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string word;
        words >> word;
        if (word == "v") {
            glm::vec3 &v = vertices.emplace_back();
            words >> v.x >> v.y >> v.z;
        } else if (word == "f") {
            std::vector<glm::vec3> corners;
            while (words >> word) {
                const long index = std::stol(word);
                const long count = long(vertices.size());
                corners.push_back(vertices.at(std::size_t(index > 0 ? index - 1 : count + index)));
            }
            for (std::size_t i = 2; i < corners.size(); ++i) {
                triangles.push_back({corners[0], corners[i - 1], corners[i]});
            }
        }
    }
    return triangles;
}

/// Moves and scales the model into the unit cube, as the renderer does.
void normalize(Triangles &triangles) {
    glm::vec3 lower(1e30f), upper(-1e30f);
    for (const auto &t : triangles) {
        for (const glm::vec3 &v : t) {
            lower = glm::min(lower, v);
            upper = glm::max(upper, v);
        }
    }
    const glm::vec3 middle = 0.5f * (lower + upper);
    const glm::vec3 size = upper - lower;
    const float scale = 2.0f / std::max({size.x, size.y, size.z});
    for (auto &t : triangles) {
        for (glm::vec3 &v : t) {
            v = (v - middle) * scale;
        }
    }
}

BvhProbeRay make_ray(const glm::vec3 &o, const glm::vec3 &d, float t_max, uint self) {
    return {{o.x, o.y, o.z}, t_max, {d.x, d.y, d.z}, self};
}

glm::vec3 vec(const float *v) {
    return {v[0], v[1], v[2]};
}

/// A camera that looks at the model from the front, in tiles of 8x8 pixels.
Rays camera_rays() {
    Rays rays;
    for (int tile = 0; tile < (kImageSize / 8) * (kImageSize / 8); ++tile) {
        for (int i = 0; i < 64; ++i) {
            const int x = tile % (kImageSize / 8) * 8 + i % 8;
            const int y = tile / (kImageSize / 8) * 8 + i / 8;
            const float px = (float(x) + 0.5f) / float(kImageSize) - 0.5f;
            const float py = (float(y) + 0.5f) / float(kImageSize) - 0.5f;
            rays.push_back(make_ray({0.3f, 0.4f, 3.2f},
                                    glm::normalize(glm::vec3(px - 0.08f, py - 0.12f, -1.2f)),
                                    INFINITY, BVH_NO_PRIM));
        }
    }
    return rays;
}

/// What a path does next at each hit: a ray in proportion to the cosine, or one to a light.
void secondary_rays(const Triangles &triangles, const Rays &rays, const Hits &hits, Rays &bounces,
                    Rays &shadows) {
    std::mt19937 random(7);
    std::normal_distribution<float> normal;
    const glm::vec3 light(2.0f, 3.0f, 2.0f);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (hits[i].prim == BVH_NO_PRIM) {
            continue;
        }
        const auto &t = triangles[hits[i].prim];
        glm::vec3 n = glm::normalize(glm::cross(t[1] - t[0], t[2] - t[0]));
        n = glm::dot(n, vec(rays[i].d)) > 0.0f ? -n : n;
        const glm::vec3 p = vec(rays[i].o) + hits[i].t * vec(rays[i].d);
        const float a = normal(random), b = normal(random), c = normal(random);
        bounces.push_back(make_ray(p,
                                   glm::normalize(n + 0.999f * glm::normalize(glm::vec3(a, b, c))),
                                   INFINITY, hits[i].prim));
        const float distance = glm::length(light - p);
        shadows.push_back(make_ray(p, (light - p) / distance, distance, hits[i].prim));
    }
}

/// One set of kernels over one tree.
struct Contender {
    std::string name;
    cl::Kernel closest;
    cl::Kernel any;
};

struct Tree {
    cl::Buffer nodes, triangles, spheres;
};

Hits trace(const test::ClTestDevice &device, cl::Kernel &kernel, const Tree &tree, const Rays &rays,
           double *seconds) {
    const cl::Buffer ray_buffer = device.upload(std::span<const BvhProbeRay>(rays));
    const cl::Buffer hit_buffer = device.allocate(rays.size() * sizeof(BvhProbeHit));
    kernel.setArg(0, tree.nodes);
    kernel.setArg(1, tree.triangles);
    kernel.setArg(2, tree.spheres);
    kernel.setArg(3, ray_buffer);
    kernel.setArg(4, hit_buffer);
    kernel.setArg(5, cl_uint(rays.size()));
    device.run(kernel, rays.size()); // compiles the kernel and touches the memory
    const auto start = std::chrono::steady_clock::now();
    device.run(kernel, rays.size());
    *seconds = seconds_since(start);
    return device.download<BvhProbeHit>(hit_buffer, rays.size());
}

std::vector<KernelSource> sources_in(const std::filesystem::path &folder) {
    std::vector<KernelSource> sources;
    for (const auto &entry : std::filesystem::recursive_directory_iterator(folder)) {
        if (entry.is_regular_file()) {
            std::ifstream file(entry.path());
            std::stringstream text;
            text << file.rdbuf();
            sources.push_back({std::filesystem::relative(entry.path(), folder), text.str()});
        }
    }
    return sources;
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

#ifdef CLRENDER_BENCH_EMBREE
/// Embree's single-ray calls on the same rays, over all cores.
class Embree {
public:
    explicit Embree(const Triangles &triangles) {
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto *vertices = static_cast<glm::vec3 *>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                    sizeof(glm::vec3), 3 * triangles.size()));
        auto *indices = static_cast<uint *>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                    3 * sizeof(uint), triangles.size()));
        for (std::size_t i = 0; i < 3 * triangles.size(); ++i) {
            vertices[i] = triangles[i / 3][i % 3];
            indices[i] = uint(i);
        }
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
        rtcCommitScene(scene_);
    }

    [[nodiscard]] double trace(const Rays &rays, bool any) const {
        const auto start = std::chrono::steady_clock::now();
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rays.size(), 4096),
                          [&](const tbb::blocked_range<std::size_t> &range) {
                              RTCIntersectContext context;
                              rtcInitIntersectContext(&context);
                              for (std::size_t i = range.begin(); i < range.end(); ++i) {
                                  trace_one(context, rays[i], any);
                              }
                          });
        return seconds_since(start);
    }

private:
    void trace_one(RTCIntersectContext &context, const BvhProbeRay &ray, bool any) const {
        RTCRayHit query{};
        query.ray = {ray.o[0], ray.o[1], ray.o[2],  1e-4f,       ray.d[0], ray.d[1],
                     ray.d[2], 0.0f,     ray.t_max, 0xffffffffu, 0,        0};
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        if (any) {
            rtcOccluded1(scene_, &context, &query.ray);
        } else {
            rtcIntersect1(scene_, &context, &query);
        }
    }

    RTCDevice device_ = rtcNewDevice(nullptr);
    RTCScene scene_ = rtcNewScene(device_);
};
#endif

struct Workload {
    const char *label;
    const Rays *rays;
    bool any;
};

double time_of(const test::ClTestDevice &device, Contender &contender, const Tree &tree,
               const Workload &load) {
    double seconds = 0.0;
    trace(device, load.any ? contender.any : contender.closest, tree, *load.rays, &seconds);
    return seconds;
}

/// The median of each column, and its ratio to the first one's.
void print_row(const char *label, const std::vector<std::vector<double>> &rates) {
    std::printf("%-16s", label);
    for (const auto &column : rates) {
        std::printf(" %10.2f (%4.2f)", median(column), median(column) / median(rates[0]));
    }
    std::printf("\n");
}

int run(const std::vector<std::string> &arguments) {
    Triangles triangles = read_obj(arguments.at(0));
    normalize(triangles);
    const auto start = std::chrono::steady_clock::now();
    const Bvh bvh = build_bvh(triangles);
    std::printf(
        "%zu triangles: built in %.3f s, %zu nodes, %zu blocks (%.2f a block), %d levels, "
        "cost %.2f\n",
        triangles.size(), seconds_since(start), bvh.nodes.size(), bvh.triangle_blocks.size(),
        double(bvh.primitives) / double(std::max<std::size_t>(1, bvh.triangle_blocks.size())),
        bvh.levels, bvh.cost);

    const test::ClTestDevice device;
    std::vector<Contender> contenders;
    for (std::size_t i = 1; i < std::max<std::size_t>(2, arguments.size()); ++i) {
        const bool embedded = arguments.size() < 2;
        const cl::Program program =
            device.build("probes/bvh_probes.cl", "-DLANES=1",
                         embedded ? embedded_kernel_sources() : sources_in(arguments[i]));
        contenders.push_back({embedded ? "embedded" : arguments[i],
                              cl::Kernel(program, "probe_bvh_closest"),
                              cl::Kernel(program, "probe_bvh_any")});
    }
    const Tree tree{device.upload(std::span<const BvhNode>(bvh.nodes)),
                    device.upload(std::span<const TriangleBlock>(bvh.triangle_blocks)),
                    device.upload(std::span<const SphereBlock>(bvh.sphere_blocks))};

    const Rays camera = camera_rays();
    double unused = 0.0;
    const Hits hits = trace(device, contenders[0].closest, tree, camera, &unused);
    Rays bounces, shadows;
    secondary_rays(triangles, camera, hits, bounces, shadows);

    std::printf("million rays a second on %s (and relative to the first column):\n%-16s",
                device.name().c_str(), "");
    for (const Contender &contender : contenders) {
        std::printf(" %17.17s", contender.name.c_str());
    }
#ifdef CLRENDER_BENCH_EMBREE
    const Embree embree(triangles);
    std::printf(" %17s", "Embree 3");
#endif
    std::printf("\n");

    for (const Workload &load :
         {Workload{"camera", &camera, false}, Workload{"diffuse bounce", &bounces, false},
          Workload{"shadow", &shadows, true}}) {
        std::vector<std::vector<double>> rates(contenders.size());
        std::vector<double> embree_rates;
        const double million = double(load.rays->size()) * 1e-6;
        for (int round = 0; round < kRounds; ++round) {
            for (std::size_t i = 0; i < contenders.size(); ++i) {
                rates[i].push_back(million / time_of(device, contenders[i], tree, load));
            }
#ifdef CLRENDER_BENCH_EMBREE
            embree_rates.push_back(million / embree.trace(*load.rays, load.any));
#endif
        }
        if (!embree_rates.empty()) {
            rates.push_back(embree_rates);
        }
        print_row(load.label, rates);
    }
    return 0;
}

} // namespace

int main(int argc, char **argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: bench_traversal MODEL.obj [KERNEL_DIR...]\n");
        return 2;
    }
    try {
        return run(std::vector<std::string>(argv + 1, argv + argc));
    } catch (const std::exception &error) {
        std::fprintf(stderr, "bench_traversal: %s\n", error.what());
        return 1;
    }
}
