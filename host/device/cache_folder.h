#pragma once
/// Where compiled kernels are kept from one run to the next.

#include <filesystem>

namespace clrender {

/// clrender's folder below $XDG_CACHE_HOME, else below ~/.cache; where neither can be written, a
/// temporary one that goes when the program ends. Empty where there is not even that.
const std::filesystem::path &cache_folder();

/// Names the folder for PoCL's own cache, in POCL_CACHE_DIR, unless the user has named one that can
/// be written: PoCL aborts without. To be called before the first OpenCL call.
void choose_pocl_cache();

/// Where PoCL's cache is, after choose_pocl_cache().
std::filesystem::path pocl_cache();

} // namespace clrender
