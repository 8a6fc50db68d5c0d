#pragma once
/// The memory that a scene may take, asked for before it is taken: --max-memory, or what the
/// machine has. A short file can promise a huge picture or mesh.

#include <cstdint>
#include <string>

namespace clrender {

/// Sets the limit in bytes, for the host and the device together; nothing has been claimed yet.
void set_memory_limit(std::uint64_t bytes);

/// What has been set, else the machine's memory, or its container's where that is less.
std::uint64_t memory_limit();

/// Forgets all claims, where a new scene begins.
void forget_memory_claims();

/// Claims `bytes` for the rest of the scene; thread-safe. Returns "", or why they are not to be
/// had, with the byte counts; then nothing is claimed.
std::string claim_memory(std::uint64_t bytes);

} // namespace clrender
