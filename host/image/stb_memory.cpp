#include "stb_memory.h"

#include <cstdlib>
#include <cstring>
#include <limits>

namespace {

constexpr std::size_t no_limit = std::numeric_limits<std::size_t>::max();

/// Bytes that stb_image may still take on this thread.
thread_local std::size_t left = no_limit;

/// Stands before each block, and keeps it aligned.
struct alignas(std::max_align_t) BlockHead {
    std::size_t size;
};

BlockHead *head_of(void *block) {
    return static_cast<BlockHead *>(block) - 1;
}

} // namespace

void *clrender_stb_malloc(std::size_t size) {
    if (size > left)
        return nullptr;
    auto *head = static_cast<BlockHead *>(std::malloc(sizeof(BlockHead) + size));
    if (head == nullptr)
        return nullptr;
    head->size = size;
    if (left != no_limit)
        left -= size;
    return head + 1;
}

void *clrender_stb_realloc(void *block, std::size_t size) {
    if (block == nullptr)
        return clrender_stb_malloc(size);
    const std::size_t old_size = head_of(block)->size;
    if (size > old_size && size - old_size > left)
        return nullptr;
    auto *head = static_cast<BlockHead *>(std::realloc(head_of(block), sizeof(BlockHead) + size));
    if (head == nullptr)
        return nullptr;
    head->size = size;
    if (left != no_limit)
        left += old_size - size; // modulo 2^64, which takes off what it has grown by
    return head + 1;
}

void clrender_stb_free(void *block) {
    if (block == nullptr)
        return;
    if (left != no_limit)
        left += head_of(block)->size;
    std::free(head_of(block));
}

namespace clrender::image_format {

StbMemory::StbMemory(std::size_t most) {
    left = most;
}

StbMemory::~StbMemory() {
    left = no_limit;
}

} // namespace clrender::image_format
