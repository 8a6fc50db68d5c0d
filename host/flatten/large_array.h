#pragma once
/// Memory for the build of large trees.

#include "huge_pages.h"

#include <cstddef>
#include <cstdlib>
#include <new>
#include <type_traits>

namespace clrender {

namespace bvh {

/// An array of unset elements. Throws std::bad_alloc.
template <class T> class LargeArray {
    static_assert(std::is_trivially_destructible_v<T>);

public:
    explicit LargeArray(std::size_t count) {
        constexpr std::size_t huge = std::size_t(1) << 21;
        const std::size_t bytes = count * sizeof(T);
        const std::size_t alignment = bytes >= 4 * huge ? huge : 64;
        data_ = static_cast<T *>(
            std::aligned_alloc(alignment, (bytes + alignment) / alignment * alignment));
        if (data_ == nullptr) {
            throw std::bad_alloc();
        }
        if (alignment == huge) {
            advise_huge_pages(data_, bytes);
        }
    }
    ~LargeArray() { std::free(data_); }
    LargeArray(const LargeArray &) = delete;
    LargeArray &operator=(const LargeArray &) = delete;

    [[nodiscard]] T *data() { return data_; }
    [[nodiscard]] const T *data() const { return data_; }
    T &operator[](std::size_t i) { return data_[i]; }
    const T &operator[](std::size_t i) const { return data_[i]; }

private:
    T *data_ = nullptr;
};

} // namespace bvh
} // namespace clrender
