#include "kernel_program.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fmt/core.h>
#include <fstream>
#include <sstream>

namespace clrender {

namespace fs = std::filesystem;

namespace {

/// FNV-1a, 64 bits: names a file, guards nothing.
std::uint64_t hash_text(const std::string &text, std::uint64_t hash = 0xcbf29ce484222325ull) {
    for (const unsigned char c : text)
        hash = (hash ^ c) * 0x100000001b3ull;
    return hash;
}

fs::path cache_folder() {
    if (const char *cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache != '\0')
        return fs::path(cache) / "clrender";
    if (const char *home = std::getenv("HOME"); home != nullptr && *home != '\0')
        return fs::path(home) / ".cache" / "clrender";
    return {};
}

} // namespace

std::vector<KernelSource> read_kernel_sources(const std::string &folder) {
    std::vector<KernelSource> sources;
    std::error_code error;
    for (const auto &entry : fs::recursive_directory_iterator(folder, error)) {
        if (!entry.is_regular_file())
            continue;
        std::ifstream file(entry.path());
        std::stringstream text;
        text << file.rdbuf();
        sources.push_back({fs::relative(entry.path(), folder).string(), text.str()});
    }
    const bool has_entry = std::any_of(sources.begin(), sources.end(), [](const auto &source) {
        return source.name == "path_trace.cl";
    });
    if (error || !has_entry)
        throw InputError({folder, 0}, "expected a folder of kernel sources with path_trace.cl");
    return sources;
}

cl::Program compile_program(const cl::Context &context, const cl::Device &device,
                            const std::vector<KernelSource> &sources, const std::string &main,
                            const std::string &options) {
    cl::Program program;
    std::vector<cl::Program> headers;
    std::vector<cl_program> handles;
    std::vector<const char *> names;
    for (const KernelSource &source : sources) {
        if (source.name == main) {
            program = cl::Program(context, source.text);
            continue;
        }
        headers.emplace_back(context, source.text);
        handles.push_back(headers.back()());
        names.push_back(source.name.c_str());
    }
    const std::string all_options = "-cl-std=CL1.2 " + options;
    const cl_device_id id = device();
    const cl_int status = clCompileProgram(program(), 1, &id, all_options.c_str(),
                                           static_cast<cl_uint>(handles.size()), handles.data(),
                                           names.data(), nullptr, nullptr);
    if (status != CL_SUCCESS)
        throw DeviceError(fmt::format("the kernel does not compile (OpenCL error {}):\n{}", status,
                                      program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device)));
    return with_device("linking the kernel",
                       [&] { return cl::linkProgram(std::vector<cl::Program>{program}); });
}

bool was_compiled_before(const DeviceEntry &entry, const std::vector<KernelSource> &sources,
                         const std::string &options) {
    std::uint64_t hash = hash_text(options);
    hash = hash_text(entry.name + entry.platform + entry.version, hash);
    hash = hash_text(entry.device.getInfo<CL_DRIVER_VERSION>(), hash);
    for (const KernelSource &source : sources)
        hash = hash_text(source.name + source.text, hash);
    const fs::path folder = cache_folder();
    if (folder.empty())
        return false;
    const fs::path marker = folder / "kernels" / fmt::format("{:016x}", hash);
    std::error_code error;
    if (fs::exists(marker, error))
        return true;
    fs::create_directories(marker.parent_path(), error);
    std::ofstream(marker) << options << '\n';
    return false;
}

} // namespace clrender
