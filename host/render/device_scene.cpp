#include "device_scene.h"

#include "device/upload.h"

#include <algorithm>
#include <cstddef>
#include <type_traits>

namespace clrender::inline CLR_PRECISION {

std::size_t largest_array_bytes(const FlatScene &flat) {
    std::size_t largest = 0;
    for_each_array(flat, [&](const auto &array) { largest = std::max(largest, bytes_of(array)); });
    return largest;
}

DeviceScene::DeviceScene(const cl::Context &context, const cl::CommandQueue &queue,
                         FlatScene &flat) {
    with_device("uploading the scene", [&] {
        const auto add = [&](const void *data, std::size_t bytes) {
            buffers_.push_back(upload(context, queue, data, bytes));
            bytes_ += bytes;
        };
        add(&flat.frame, sizeof(flat.frame));
        for_each_array(flat, [&](auto &array) {
            add(array.data(), bytes_of(array));
            array = std::remove_reference_t<decltype(array)>();
        });
    });
}

void DeviceScene::set_samples(const cl::CommandQueue &queue, int samples) const {
    with_device("setting the number of samples", [&] {
        const auto value = static_cast<cl_uint>(samples);
        queue.enqueueWriteBuffer(buffers_.front(), CL_TRUE, offsetof(FrameData, total_samples),
                                 sizeof(value), &value);
    });
}

cl_uint DeviceScene::bind(cl::Kernel &kernel) const {
    cl_uint index = 0;
    for (const cl::Buffer &buffer : buffers_)
        kernel.setArg(index++, buffer);
    return index;
}

} // namespace clrender::inline CLR_PRECISION
