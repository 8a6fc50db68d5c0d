#pragma once
/// Large pages, where the system gives them on request.

#include <cstddef>
#ifdef __linux__
#include <sys/mman.h>
#endif

namespace clrender {

/// Asks the system to back [data, data + bytes) with pages of 2 MiB, where it does that on request:
/// a large tree is read all over, and there are too few entries for the addresses of small pages.
/// Before the memory is first written to; without effect on what it holds.
inline void advise_huge_pages(void *data, std::size_t bytes) {
#ifdef __linux__
    constexpr std::size_t page = 4096;
    const std::size_t skipped = (page - reinterpret_cast<std::size_t>(data) % page) % page;
    if (bytes > skipped) {
        madvise(static_cast<char *>(data) + skipped, bytes - skipped, MADV_HUGEPAGE);
    }
#else
    (void)data;
    (void)bytes;
#endif
}

} // namespace clrender
