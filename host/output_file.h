#pragma once
/// Files that the program leaves behind. A failure leaves an older file as it was.

#include <string>
#include <string_view>

namespace clrender {

/// Writes `bytes` to a temporary file in the folder of `path`, waits until they are on the disk,
/// and gives them the name `path`. Throws OutputError that names `path` and the reason.
void write_output_file(const std::string &path, std::string_view bytes);

/// Why `path` cannot be written, or "". Finds out by making a temporary file in its folder, which
/// is removed again.
std::string why_not_writable(const std::string &path);

} // namespace clrender
