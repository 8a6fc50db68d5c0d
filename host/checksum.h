#pragma once
/// Checksums of data: they find damage and what has changed, and are no seal.

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace clrender {

/// That of `data` behind what `before` is the checksum of (0: nothing). FNV-1a, 8 bytes at a time.
inline std::uint64_t checksum(std::uint64_t before, const void *data, std::size_t bytes) {
    constexpr std::uint64_t start = 0xcbf29ce484222325U, prime = 0x100000001b3U;
    std::uint64_t sum = before ^ start;
    const char *at = static_cast<const char *>(data);
    while (bytes > 0) {
        std::uint64_t word = 0;
        const std::size_t taken = bytes < sizeof(word) ? bytes : sizeof(word);
        std::memcpy(&word, at, taken);
        sum = (sum ^ word ^ std::uint64_t{taken} << 56U) * prime;
        sum ^= sum >> 32U;
        at += taken;
        bytes -= taken;
    }
    return sum;
}

} // namespace clrender
