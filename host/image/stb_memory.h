#pragma once
/// What stb_image may take while it decodes a picture: a short file can make it ask for gigabytes.

#include <cstddef>

namespace clrender::image_format {

/// While it lives, stb_image on this thread gets at most `most` bytes in all; beyond that its
/// allocations fail, and it reports being out of memory.
class StbMemory {
public:
    explicit StbMemory(std::size_t most);
    ~StbMemory();
    StbMemory(const StbMemory &) = delete;
    StbMemory &operator=(const StbMemory &) = delete;
};

} // namespace clrender::image_format

// For stb_image itself, in place of malloc, realloc and free.
void *clrender_stb_malloc(std::size_t size);
void *clrender_stb_realloc(void *block, std::size_t size);
void clrender_stb_free(void *block);
