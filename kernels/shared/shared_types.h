#ifndef CLR_SHARED_TYPES_H
#define CLR_SHARED_TYPES_H
/* What lets one header be read by the host's C++ compiler and by the device's OpenCL C compiler.
   Shared structs hold only float, int and uint, and arrays of them: no bool, no enum, no pointer.
   Every one is followed by its CLR_STATIC_SIZE. */

#define CLR_ALIGNED(bytes) __attribute__((aligned(bytes)))

#ifdef __OPENCL_C_VERSION__

#define CLR_SHARED_BEGIN
#define CLR_SHARED_END
#define CLR_STATIC_SIZE(type, bytes)                                                               \
    typedef char clr_size_of_##type[(sizeof(type) == (bytes)) ? 1 : -1]

#else

#include <cstdint>

namespace clrender {
using uint = std::uint32_t;
}

#define CLR_SHARED_BEGIN namespace clrender {
#define CLR_SHARED_END }
#define CLR_STATIC_SIZE(type, bytes)                                                               \
    static_assert(sizeof(type) == (bytes), "host and device see different sizes")

#endif
#endif
