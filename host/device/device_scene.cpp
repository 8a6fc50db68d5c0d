#include "device_scene.h"

#include "memory_limit.h"
#include "upload.h"

#include <algorithm>
#include <fmt/core.h>

namespace clrender::inline CLR_PRECISION {

namespace {

/// The bytes of one array, in the order of the kernel's arguments.
struct View {
    const void *data;
    std::size_t bytes;
};

template <typename T> View view(const std::vector<T> &array) {
    return {array.data(), array.size() * sizeof(T)};
}

std::vector<View> views(const FlatScene &flat) {
    return {{&flat.frame, sizeof(flat.frame)},
            view(flat.spheres),
            view(flat.sphere_tests),
            view(flat.planars),
            view(flat.records),
            view(flat.bvh.nodes),
            view(flat.bvh.triangle_blocks),
            view(flat.bvh.sphere_blocks),
            view(flat.triangles),
            view(flat.normals),
            view(flat.uvs),
            view(flat.shape_of),
            view(flat.shapes),
            view(flat.shape_frames),
            view(flat.materials),
            view(flat.emitters),
            view(flat.lights),
            view(flat.light_triangles),
            view(flat.light_nodes),
            view(flat.textures),
            view(flat.texels_u8),
            view(flat.texels_f32),
            view(flat.decode),
            view(flat.env_texels),
            view(flat.env_cdf),
            view(flat.env_guide),
            view(flat.filter)};
}

void check_memory(const DeviceEntry &entry, const std::vector<View> &arrays,
                  std::size_t film_bytes) {
    std::size_t total = film_bytes;
    std::size_t largest = film_bytes;
    for (const View &array : arrays) {
        total += array.bytes;
        largest = std::max(largest, array.bytes);
    }
    // The arrays lie on the host too.
    const std::size_t everywhere = 2 * total - film_bytes;
    if (everywhere > memory_limit())
        throw InputError({"--max-memory", 0},
                         fmt::format("the scene and the film need {} bytes, expected at most {}",
                                     everywhere, memory_limit()));
    if (total > entry.memory_bytes)
        throw DeviceError(fmt::format("the scene and the film need {} bytes, but {} has {}", total,
                                      entry.name, entry.memory_bytes));
    if (largest > entry.max_allocation_bytes)
        throw DeviceError(fmt::format("one array of {} bytes is needed, but {} allows {}", largest,
                                      entry.name, entry.max_allocation_bytes));
}

} // namespace

DeviceScene::DeviceScene(const cl::Context &context, const cl::CommandQueue &queue,
                         const DeviceEntry &entry, const FlatScene &flat, std::size_t film_bytes) {
    const std::vector<View> arrays = views(flat);
    check_memory(entry, arrays, film_bytes);
    with_device("uploading the scene", [&] {
        for (const View &array : arrays) {
            buffers_.push_back(upload(context, queue, array.data, array.bytes));
            bytes_ += array.bytes;
        }
    });
}

cl_uint DeviceScene::bind(cl::Kernel &kernel) const {
    cl_uint index = 0;
    for (const cl::Buffer &buffer : buffers_)
        kernel.setArg(index++, buffer);
    return index;
}

} // namespace clrender::inline CLR_PRECISION
