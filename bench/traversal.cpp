/// How fast the tree is walked, and how fast and large it is built, beside Embree on the same
/// triangles, rays and threads.
///
///     bench_traversal [--threads N] [--rounds N] [--size PIXELS] [--kernels DIR]... [MESH...]
///
/// MESH is an OBJ file or SHAPE:COUNT, a shape of scenes/generator. Without one: the shared meshes
/// of 6 and 70 thousand triangles where there are any (else generated ones), 1 and 10 million.
/// Every column is measured in turns, round after round, after one round that does not count.
/// Rates are million rays a CPU second of one thread, medians of the rounds; ratios are medians of
/// each round's ratio. CPU time, because a machine is seldom idle. Each DIR adds a column with the
/// kernels in that folder, for one who changes them: they have to read the same tree. "packets" are
/// camera rays, LANES at once; the ratios behind the first are to the stackless single rays.

#include "cl_test_device.h"
#include "flatten/bvh_builder.h"
#include "traversal_rays.h"

#ifdef CLRENDER_BENCH_EMBREE
#include "embree_scene.h"
#endif

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <malloc.h>
#include <memory>
#include <sstream>
#include <tbb/global_control.h>
#include <thread>

using namespace clrender;
using namespace clrender::bench;

namespace {

struct Options {
    int threads = int(std::max(1u, std::thread::hardware_concurrency()));
    int rounds = 7;
    int image_size = 1024;
    std::vector<std::string> kernel_folders;
    std::vector<std::string> meshes;
};

// ---- measuring ----

/// What one measurement traces at least.
constexpr std::size_t kLeastRays = 500000;

/// Wall and CPU seconds of one call; the latter of all threads.
struct Seconds {
    double wall = 0.0;
    double cpu = 0.0;
};

template <class Work> Seconds measure(const Work &work) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t cpu_start = std::clock();
    work();
    return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
            double(std::clock() - cpu_start) / CLOCKS_PER_SEC};
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values.empty() ? NAN : values[values.size() / 2];
}

/// The median of a[i] / b[i].
double median_ratio(const std::vector<double> &a, const std::vector<double> &b) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
        ratios.push_back(a[i] / b[i]);
    }
    return median(ratios);
}

/// A line of /proc/self/status in bytes.
double process_bytes(const std::string &key) {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
        if (line.rfind(key + ":", 0) == 0) {
            return 1024.0 * std::stod(line.substr(key.size() + 1));
        }
    }
    return NAN;
}

/// The largest memory in use during `work` less what was in use before.
template <class Work> double peak_bytes(const Work &work) {
    malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << 5; // the high-water mark starts anew
    const double before = process_bytes("VmRSS");
    work();
    return process_bytes("VmHWM") - before;
}

// ---- columns ----

/// Rays of a work-item, one traced after the other: as wide as the renderer would be.
int lanes_of(const test::ClTestDevice &device) {
    return device.native_width() >= 16 ? 16 : 8;
}

/// As the renderer compiles them for a scene of meshes.
std::string options_for(const test::ClTestDevice &device) {
    return "-DHAS_BVH_SPHERES=0 -DLANES=" + std::to_string(lanes_of(device));
}

struct Column {
    std::string name;
    std::function<void(const RaySet &)> trace;
    bool coherent_only = false; ///< other rays are left out
    std::vector<double> rates{};
};

/// The kernels for closest and any hits of one program; some have closest hits by packets as well.
struct Kernels {
    cl::Kernel closest, any, packet;
};

/// The tree and the rays on the device.
class DeviceTree {
public:
    DeviceTree(const test::ClTestDevice &device, const Bvh &bvh)
        : device_(device), nodes_(device.upload(std::span<const BvhNode>(bvh.nodes))),
          triangles_(device.upload(std::span<const TriangleBlock>(bvh.triangle_blocks))),
          spheres_(device.upload(std::span<const SphereBlock>(bvh.sphere_blocks))) {}

    void set_rays(const Rays &rays) {
        rays_ = device_.upload(std::span<const BvhProbeRay>(rays));
        hits_ = device_.allocate(std::max<std::size_t>(1, rays.size()) * sizeof(BvhProbeHit));
    }

    void trace(cl::Kernel &kernel, std::size_t count) const {
        if (count == 0) {
            return;
        }
        kernel.setArg(0, nodes_);
        kernel.setArg(1, triangles_);
        kernel.setArg(2, spheres_);
        kernel.setArg(3, rays_);
        kernel.setArg(4, hits_);
        kernel.setArg(5, cl_uint(count));
        const auto lanes = static_cast<std::size_t>(lanes_of(device_));
        device_.run(kernel, (count + lanes - 1) / lanes);
    }

    [[nodiscard]] Hits hits(std::size_t count) const {
        return count == 0 ? Hits() : device_.download<BvhProbeHit>(hits_, count);
    }

private:
    const test::ClTestDevice &device_;
    cl::Buffer nodes_, triangles_, spheres_, rays_, hits_;
};

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

Kernels product_kernels(const test::ClTestDevice &device,
                        const std::vector<KernelSource> &sources) {
    const cl::Program program = device.build("probes/bvh_probes.cl", options_for(device), sources);
    return {cl::Kernel(program, "probe_bvh_closest"), cl::Kernel(program, "probe_bvh_any"),
            cl::Kernel(program, "probe_bvh_packet")};
}

Kernels stack_kernels(const test::ClTestDevice &device) {
    std::ifstream file(BENCH_STACK_KERNEL);
    std::stringstream text;
    text << file.rdbuf();
    std::vector<KernelSource> sources = embedded_kernel_sources();
    sources.push_back({"stack_traversal.cl", text.str()});
    const cl::Program program = device.build("stack_traversal.cl", options_for(device), sources);
    return {cl::Kernel(program, "bench_stack_closest"), cl::Kernel(program, "bench_stack_any"), {}};
}

/// All that is compared, compiled once for all meshes.
struct Contenders {
    explicit Contenders(const test::ClTestDevice &device, const Options &options)
        : names{"stackless", "stack"}, kernels{product_kernels(device, embedded_kernel_sources()),
                                               stack_kernels(device)} {
        for (const std::string &folder : options.kernel_folders) {
            names.push_back(folder.substr(folder.size() - std::min<std::size_t>(9, folder.size())));
            kernels.push_back(product_kernels(device, sources_in(folder)));
        }
    }
    std::vector<std::string> names;
    std::vector<Kernels> kernels;
};

// ---- one mesh ----

struct Built {
    Bvh bvh;
    std::vector<double> wall, cpu, embree_wall, embree_cpu;
    double peak = 0.0;
};

/// Builds in turns with Embree's medium quality.
Built build_all(const Triangles &triangles, int rounds) {
    Built built;
    for (int round = 0; round < rounds; ++round) {
        built.bvh = Bvh();
        Seconds ours;
        built.peak = peak_bytes([&] { ours = measure([&] { built.bvh = build_bvh(triangles); }); });
        built.wall.push_back(ours.wall);
        built.cpu.push_back(ours.cpu);
#ifdef CLRENDER_BENCH_EMBREE
        const EmbreeScene embree(triangles, RTC_BUILD_QUALITY_MEDIUM);
        built.embree_wall.push_back(embree.build_wall_seconds());
        built.embree_cpu.push_back(embree.build_cpu_seconds());
#endif
    }
    return built;
}

void print_build(const std::string &mesh, const Triangles &triangles, const Built &built) {
    const Bvh &bvh = built.bvh;
    const double count = double(std::max<std::size_t>(1, triangles.size()));
    const double bytes = double(bvh.nodes.size() * sizeof(BvhNode) +
                                bvh.triangle_blocks.size() * sizeof(TriangleBlock));
    std::printf(
        "\n%s: %zu triangles; %zu nodes in %d levels, %zu blocks (%.2f triangles each), "
        "cost %.2f\n",
        mesh.c_str(), triangles.size(), bvh.nodes.size(), bvh.levels, bvh.triangle_blocks.size(),
        double(bvh.primitives) / double(std::max<std::size_t>(1, bvh.triangle_blocks.size())),
        bvh.cost);
    std::printf("  %.1f bytes a triangle on the device, %.1f at the peak of the build (besides the "
                "triangles)\n",
                bytes / count, built.peak / count);
    std::printf("  built in %.3f s (%.3f CPU s)", median(built.wall), median(built.cpu));
    if (!built.embree_wall.empty()) {
        std::printf("; Embree, medium quality, %.3f s (%.3f CPU s): ratio %.2f (%.2f)",
                    median(built.embree_wall), median(built.embree_cpu),
                    median_ratio(built.wall, built.embree_wall),
                    median_ratio(built.cpu, built.embree_cpu));
    }
    std::printf("\n");
}

void print_rates(const RaySet &set, const std::vector<Column> &columns, std::size_t embree) {
    std::printf("  %-13s %9zu", set.label.c_str(), set.rays.size());
    for (const Column &column : columns) {
        std::printf(column.rates.empty() ? "          -" : " %10.2f", median(column.rates));
    }
    if (embree < columns.size()) {
        std::printf(" %8.3f", median_ratio(columns[0].rates, columns[embree].rates));
    }
    for (std::size_t i = 2; i < std::min(embree, columns.size()); ++i) {
        if (!columns[i].rates.empty()) {
            std::printf(" %8.3f", median_ratio(columns[i].rates, columns[0].rates));
        }
    }
    std::printf("\n");
}

void trace_in_turns(const RaySet &set, std::vector<Column> &all, int rounds) {
    std::vector<std::reference_wrapper<Column>> columns;
    for (Column &column : all) {
        column.rates.clear();
        if (set.coherent || !column.coherent_only) {
            columns.emplace_back(column);
            column.trace(set); // compiles the kernel and touches the memory
        }
    }
    // Small sets several times over: the first pass finds the caches full of another's tree.
    const std::size_t passes = kLeastRays / set.rays.size() + 1;
    for (int round = 0; round < rounds; ++round) {
        for (Column &column : columns) {
            const Seconds seconds = measure([&] {
                for (std::size_t pass = 0; pass < passes; ++pass) {
                    column.trace(set);
                }
            });
            column.rates.push_back(double(passes * set.rays.size()) * 1e-6 / seconds.cpu);
        }
    }
}

void run_mesh(const std::string &mesh, const test::ClTestDevice &device, Contenders &contenders,
              const Options &options) {
    const Triangles triangles = load_mesh(mesh);
    const Built built = build_all(triangles, std::min(3, options.rounds));
    print_build(mesh, triangles, built);

    DeviceTree tree(device, built.bvh);
    const auto closest = [&](const Rays &rays) {
        tree.set_rays(rays);
        tree.trace(contenders.kernels[0].closest, rays.size());
        return tree.hits(rays.size());
    };
    const std::vector<RaySet> sets = make_rays(triangles, options.image_size, closest);

    std::vector<Column> columns;
    for (std::size_t i = 0; i < contenders.names.size(); ++i) {
        Kernels &kernels = contenders.kernels[i];
        columns.push_back({contenders.names[i], [&](const RaySet &set) {
                               tree.trace(set.any ? kernels.any : kernels.closest, set.rays.size());
                           }});
    }
    columns.push_back(
        {"packets",
         [&](const RaySet &set) { tree.trace(contenders.kernels[0].packet, set.rays.size()); },
         true});
    const std::size_t first_embree = columns.size();
#ifdef CLRENDER_BENCH_EMBREE
    const EmbreeScene embree(triangles, RTC_BUILD_QUALITY_HIGH);
    columns.push_back({"Embree 1", [&](const RaySet &set) { embree.trace_single(set); }});
    columns.push_back({"Embree 8", [&](const RaySet &set) { embree.trace_packets(set); }});
#endif

    std::printf("  %-13s %9s", "", "rays");
    for (const Column &column : columns) {
        std::printf(" %10s", column.name.c_str());
    }
    std::printf(" %8s\n", first_embree < columns.size() ? "ratio" : "");
    for (const RaySet &set : sets) {
        if (!set.rays.empty()) {
            tree.set_rays(set.rays);
            trace_in_turns(set, columns, options.rounds);
            print_rates(set, columns, first_embree);
        }
    }
    std::fflush(stdout);
}

// ---- the command line ----

std::vector<std::string> default_meshes() {
    const auto file_or = [](const char *file, const char *otherwise) {
        return std::string(std::filesystem::exists(file) ? file : otherwise);
    };
    return {file_or("../shared/meshes/spot.obj", "coral:6000"),
            file_or("../shared/meshes/bunny.obj", "coral:70000"), "coral:1000000",
            "coral:10000000"};
}

Options parse(const std::vector<std::string> &words) {
    Options options;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const std::string &word = words[i];
        if (word.rfind("--", 0) != 0) {
            options.meshes.push_back(word);
            continue;
        }
        const std::string value = i + 1 < words.size() ? words[++i] : "";
        if (word == "--kernels" && !value.empty()) {
            options.kernel_folders.push_back(value);
        } else if (word == "--threads" || word == "--rounds" || word == "--size") {
            int &number = word == "--threads"  ? options.threads
                          : word == "--rounds" ? options.rounds
                                               : options.image_size;
            number = std::max(1, std::stoi(value));
        } else {
            throw std::invalid_argument("what is " + word + "?");
        }
    }
    if (options.meshes.empty()) {
        options.meshes = default_meshes();
    }
    return options;
}

void run(const Options &options) {
    // PoCL reads its number of threads when the device is opened.
    setenv("POCL_MAX_PTHREAD_COUNT", std::to_string(options.threads).c_str(), 1);
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    std::size_t(options.threads));
    const test::ClTestDevice device;
    std::printf("million rays a CPU second, %d threads, %s\n", options.threads,
                device.name().c_str());
    Contenders contenders(device, options);
    for (const std::string &mesh : options.meshes) {
        run_mesh(mesh, device, contenders, options);
    }
}

} // namespace

int main(int argc, char **argv) {
    try {
        run(parse(std::vector<std::string>(argv + 1, argv + argc)));
        return 0;
    } catch (const std::exception &error) {
        std::fprintf(stderr, "bench_traversal: %s\n", error.what());
        return 1;
    }
}
