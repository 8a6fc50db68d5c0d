#ifndef CLR_SHARED_TYPES_H
#define CLR_SHARED_TYPES_H
/* What lets one header be read by the host's C++ compiler and by the device's OpenCL C compiler.
   Shared structs hold only numbers and arrays of them: no bool, no enum, no pointer. Every one is
   followed by its CLR_STATIC_SIZE; CLR_STATIC_WORDS counts numbers of the size of clr_real. */

/* Geometry, materials, lights and the paths themselves are held in `clr_real`: float, or double
   where both compilers are told CLR_DOUBLE (the kernel by DOUBLE_PRECISION). `clr_word` is an
   unsigned number of the same size, so that a record of both lies in memory as an array of either.
   A number that float32 would round is written for both: CLR_EITHER(in single, in double
   precision). */
#ifdef __OPENCL_C_VERSION__
#define CLR_DOUBLE DOUBLE_PRECISION
#elif !defined(CLR_DOUBLE)
#define CLR_DOUBLE 0
#endif
#if CLR_DOUBLE
#define CLR_EITHER(single_precision, double_precision) (double_precision)
#else
#define CLR_EITHER(single_precision, double_precision) (single_precision)
#endif

#define CLR_ALIGNED(bytes) __attribute__((aligned(bytes)))

#ifdef __OPENCL_C_VERSION__

#define CLR_SHARED_BEGIN
#define CLR_SHARED_END
#define CLR_PRECISION_BEGIN
#define CLR_PRECISION_END
#define CLR_STATIC_SIZE(type, bytes)                                                               \
    typedef char clr_size_of_##type[(sizeof(type) == (bytes)) ? 1 : -1]
#if CLR_DOUBLE
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
typedef double clr_real;
typedef ulong clr_word;
#else
typedef float clr_real;
typedef uint clr_word;
#endif

#else

#include <cstdint>

/* What depends on the precision is compiled once for each, into a namespace of its own. */
#if CLR_DOUBLE
#define CLR_PRECISION double_precision
#else
#define CLR_PRECISION single_precision
#endif

namespace clrender {
using uint = std::uint32_t;
inline namespace CLR_PRECISION {
#if CLR_DOUBLE
using clr_real = double;
using clr_word = std::uint64_t;
#else
using clr_real = float;
using clr_word = std::uint32_t;
#endif
} // namespace CLR_PRECISION
} // namespace clrender

#define CLR_SHARED_BEGIN namespace clrender {
#define CLR_SHARED_END }
#define CLR_PRECISION_BEGIN                                                                        \
    namespace clrender {                                                                           \
    inline namespace CLR_PRECISION {
#define CLR_PRECISION_END                                                                          \
    }                                                                                              \
    }
#define CLR_STATIC_SIZE(type, bytes)                                                               \
    static_assert(sizeof(type) == (bytes), "host and device see different sizes")

#endif

#define CLR_STATIC_WORDS(type, words) CLR_STATIC_SIZE(type, (words) * sizeof(clr_real))

#endif
