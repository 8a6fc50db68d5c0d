#include "device/upload.h"

#include "huge_pages.h"

#include <algorithm>
#include <cstring>
#include <vector>

namespace clrender {

namespace {

/// Below this small pages do.
constexpr std::size_t kLarge = std::size_t(4) << 20;
/// Runtimes differ in whether they take buffers of a few bytes; and the largest record, a table of
/// a rough plastic in double precision, has as many.
constexpr std::size_t kLeast = 512;

/// A processor's runtime maps the buffer where it lies; its pages are not yet mapped.
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
    if (bytes >= kLeast) {
        queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, bytes, data);
    } else {
        // Lanes that are off may read the first element of an array that has none.
        std::vector<unsigned char> padded(kLeast);
        if (bytes > 0) {
            std::memcpy(padded.data(), data, bytes);
        }
        queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, kLeast, padded.data());
    }
    return buffer;
}

} // namespace clrender
