#include "memory_limit.h"

#include <algorithm>
#include <atomic>
#include <fmt/format.h>
#include <fstream>
#include <unistd.h>

namespace clrender {

namespace {

std::uint64_t machine_memory() {
    const long pages = sysconf(_SC_PHYS_PAGES);
    const long page = sysconf(_SC_PAGESIZE);
    std::uint64_t bytes = UINT64_MAX;
    if (pages > 0 && page > 0)
        bytes = static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page);
    std::uint64_t container = 0; // the file says "max" where there is no limit
    if (std::ifstream("/sys/fs/cgroup/memory.max") >> container && container > 0)
        bytes = std::min(bytes, container);
    return bytes;
}

std::atomic<std::uint64_t> &limit() {
    static std::atomic<std::uint64_t> bytes{machine_memory()};
    return bytes;
}

std::atomic<std::uint64_t> claimed{0};

} // namespace

void set_memory_limit(std::uint64_t bytes) {
    limit() = bytes;
    forget_memory_claims();
}

std::uint64_t memory_limit() {
    return limit();
}

void forget_memory_claims() {
    claimed = 0;
}

std::string claim_memory(std::uint64_t bytes) {
    const std::uint64_t most = limit();
    std::uint64_t before = claimed;
    do {
        const std::uint64_t left = most - std::min(before, most);
        if (bytes > left)
            return fmt::format("needs {} bytes of memory, but of {} allowed only {} are left "
                               "(--max-memory)",
                               bytes, most, left);
    } while (!claimed.compare_exchange_weak(before, before + bytes));
    return {};
}

} // namespace clrender
