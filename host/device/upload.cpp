#include "device/upload.h"

#include "flatten/large_array.h"

#include <algorithm>

namespace clrender {

namespace {

/// Below this small pages do.
constexpr std::size_t kLarge = std::size_t(4) << 20;
/// Runtimes differ in whether they take buffers of a few bytes.
constexpr std::size_t kLeast = 256;

/// A processor's runtime maps the buffer where it lies; nobody has touched it yet.
void lay_into_large_pages(const cl::CommandQueue &queue, const cl::Buffer &buffer,
                          std::size_t bytes) {
    void *memory = queue.enqueueMapBuffer(buffer, CL_TRUE, CL_MAP_WRITE, 0, bytes);
    advise_huge_pages(memory, bytes);
    queue.enqueueUnmapMemObject(buffer, memory);
    queue.finish();
}

} // namespace

cl::Buffer upload(const cl::Context &context, const cl::CommandQueue &queue, const void *data,
                  std::size_t bytes) {
    cl::Buffer buffer(context, CL_MEM_READ_ONLY, std::max(bytes, kLeast));
    if (bytes >= kLarge &&
        queue.getInfo<CL_QUEUE_DEVICE>().getInfo<CL_DEVICE_TYPE>() == CL_DEVICE_TYPE_CPU) {
        lay_into_large_pages(queue, buffer, bytes);
    }
    if (bytes > 0) {
        queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, bytes, data);
    }
    return buffer;
}

} // namespace clrender
