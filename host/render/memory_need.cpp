#include "memory_need.h"

#include "error.h"
#include "memory_limit.h"

#include <algorithm>
#include <fmt/core.h>
#include <fstream>
#include <limits>
#include <string>

namespace clrender {

namespace {

/// What the OpenCL runtime and its compiler take, as measured on PoCL with a kernel in its cache.
constexpr std::size_t runtime_bytes = std::size_t{150} << 20;
/// The part of the film that is turned into pixels, and what it becomes on the way (picture.cpp).
constexpr std::size_t reading_bytes = std::size_t{64} << 20;

/// The number behind `name` in a file of lines `name number unit`, in bytes; none: `otherwise`.
std::size_t kilobytes_in(const char *path, const std::string &name, std::size_t otherwise) {
    std::ifstream file(path);
    std::string word, rest;
    std::size_t number = 0;
    while (file >> word) {
        if (word == name && file >> number)
            return number << 10;
        std::getline(file, rest);
    }
    return otherwise;
}

/// A number of bytes alone in a file; `max`, or no such file, is none.
std::size_t bytes_in(const char *path) {
    std::size_t bytes = 0;
    return std::ifstream(path) >> bytes ? bytes : std::numeric_limits<std::size_t>::max();
}

/// Memory that the system can still give: to the machine, and to the container (cgroup 2).
std::size_t available_bytes() {
    const std::size_t none = std::numeric_limits<std::size_t>::max();
    const std::size_t machine = kilobytes_in("/proc/meminfo", "MemAvailable:", none);
    const std::size_t limit = bytes_in("/sys/fs/cgroup/memory.max");
    const std::size_t used = bytes_in("/sys/fs/cgroup/memory.current");
    return limit == none || used == none ? machine
                                         : std::min(machine, limit - std::min(limit, used));
}

} // namespace

MemoryNeed memory_need(const DeviceEntry &entry, const SceneBytes &scene, const FilmBytes &film,
                       std::size_t picture, bool to_compile) {
    MemoryNeed need;
    need.device = scene.total + film.band + film.control;
    need.largest = std::max({scene.largest_array, film.band, film.control});
    // The scene's arrays are freed as they are uploaded, one by one.
    const std::size_t on_host = entry.is_cpu ? film.band + film.control + scene.largest_array : 0;
    need.to_come = picture + std::min(reading_bytes, 2 * film.band) + on_host +
                   (to_compile ? runtime_bytes : 0);
    const std::size_t taken = kilobytes_in("/proc/self/status", "VmRSS:", 0);
    const std::size_t peak = kilobytes_in("/proc/self/status", "VmHWM:", 0);
    need.process = std::max(peak, taken + need.to_come);
    return need;
}

void check_memory_need(const MemoryNeed &need, const DeviceEntry &entry) {
    check_total_memory(need.process + (entry.is_cpu ? 0 : need.device));
    if (need.device > entry.memory_bytes)
        throw DeviceError(fmt::format("the scene and the film need {} bytes, but {} has {}",
                                      need.device, entry.name, entry.memory_bytes));
    if (need.largest > entry.max_allocation_bytes)
        throw DeviceError(fmt::format("one array of {} bytes is needed, but {} allows {}",
                                      need.largest, entry.name, entry.max_allocation_bytes));
    const std::size_t available = available_bytes();
    if (need.to_come > available)
        throw MemoryError(fmt::format("the render needs {} bytes more, but the system has {}",
                                      need.to_come, available));
}

} // namespace clrender
