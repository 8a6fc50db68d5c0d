#pragma once
/// The memory of a render, known before it is taken.

#include "device/cl_context.h"

#include <cstddef>

namespace clrender {

/// Bytes that a render takes. `process` is the peak of the whole process, what it has taken so far
/// included; a processor's device memory is part of it.
struct MemoryNeed {
    std::size_t device = 0;  ///< the scene and the film
    std::size_t largest = 0; ///< of the device's buffers
    std::size_t process = 0;
    std::size_t to_come = 0; ///< of `process`, what is not taken yet
};

/// What a scene takes on a device.
struct SceneBytes {
    std::size_t total = 0, largest_array = 0;
};

/// What the film takes there: the sums of the largest band, and the control tiles.
struct FilmBytes {
    std::size_t band = 0, control = 0;
};

/// To be asked where the scene is ready to be uploaded. `picture`: bytes of the picture with its
/// layers on the host. `to_compile`: the kernel has not been compiled yet.
MemoryNeed memory_need(const DeviceEntry &entry, const SceneBytes &scene, const FilmBytes &film,
                       std::size_t picture, bool to_compile);

/// Throws, with the byte counts, where the device, the system or --max-memory has less:
/// DeviceError, MemoryError, InputError.
void check_memory_need(const MemoryNeed &need, const DeviceEntry &entry);

} // namespace clrender
