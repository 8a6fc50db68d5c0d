#include "kernel_program.h"

#include "kernel_cache.h"
#include "log.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fmt/core.h>
#include <fstream>
#include <set>
#include <sstream>

namespace clrender {

namespace fs = std::filesystem;

namespace {

void append_source(const std::vector<KernelSource> &sources, const std::string &name,
                   std::set<std::string> &done, std::string &text) {
    const auto source = std::find_if(sources.begin(), sources.end(),
                                     [&](const KernelSource &s) { return s.name == name; });
    if (source == sources.end())
        throw DeviceError("there is no kernel source " + name);
    if (!done.insert(name).second)
        return;
    const std::string include = "#include \"";
    text += fmt::format("#line 1 \"{}\"\n", name);
    std::istringstream lines(source->text);
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        if (line.compare(0, include.size(), include) != 0) {
            text += line + '\n';
            continue;
        }
        const std::size_t end = line.find('"', include.size());
        append_source(sources, line.substr(include.size(), end - include.size()), done, text);
        text += fmt::format("#line {} \"{}\"\n", number + 1, name);
    }
    // Without a guard it is wanted again, by other macros.
    if (source->text.rfind("#ifndef ", 0) != 0)
        done.erase(name);
}

/// The options that every program is compiled with, and these. Where a device can round quotients
/// and roots correctly it does so when asked; else OpenCL lets them be off by some units.
std::string with_standard(const cl::Device &device, const std::string &options) {
    const bool exact =
        (device.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>() & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0;
    return std::string("-cl-std=CL1.2 ") +
           (exact ? "-cl-fp32-correctly-rounded-divide-sqrt " : "") + options;
}

/// The program from its binary; none where the driver does not take it.
cl::Program take_binary(const cl::Context &context, const cl::Device &device,
                        const std::vector<unsigned char> &binary, const std::string &options) {
    try {
        cl::Program program(context, {device}, {binary});
        program.build({device}, options.c_str());
        return program;
    } catch (const cl::Error &) {
        return {};
    }
}

/// What the compiler has said; nothing where the runtime has not come so far.
std::string build_log_of(const cl::Program &program, const cl::Device &device) {
    try {
        return program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device);
    } catch (const cl::Error &) {
        return {};
    }
}

/// The first line of a compiler's log that tells of an error, else its first one.
std::string first_error(const std::string &build_log) {
    std::istringstream lines(build_log);
    std::string first;
    for (std::string line; std::getline(lines, line);) {
        if (line.find("error") != std::string::npos)
            return as_one_line(line);
        if (first.empty())
            first = line;
    }
    return first.empty() ? "the compiler does not say why" : as_one_line(first);
}

} // namespace

std::vector<KernelSource> read_kernel_sources(const std::string &folder) {
    std::vector<KernelSource> sources;
    std::error_code error;
    fs::recursive_directory_iterator entry(folder, error);
    for (const fs::recursive_directory_iterator end; !error && entry != end;
         entry.increment(error)) {
        if (!entry->is_regular_file())
            continue;
        std::ifstream file(entry->path());
        if (!file)
            throw InputError({entry->path().string(), 0}, "cannot be read, expected kernel source");
        std::stringstream text;
        text << file.rdbuf();
        sources.push_back({entry->path().lexically_relative(folder).string(), text.str()});
    }
    if (error)
        throw InputError({folder, 0}, "cannot be read (" + error.message() +
                                          "), expected a folder of kernel sources");
    const bool has_entry = std::any_of(sources.begin(), sources.end(), [](const auto &source) {
        return source.name == "path_trace.cl";
    });
    if (!has_entry)
        throw InputError({folder, 0}, "expected a folder of kernel sources with path_trace.cl");
    return sources;
}

std::string join_sources(const std::vector<KernelSource> &sources, const std::string &main) {
    std::set<std::string> done;
    std::string text;
    append_source(sources, main, done, text);
    return text;
}

cl::Program compile_program(const cl::Context &context, const cl::Device &device,
                            const std::string &text, const std::string &options) {
    cl::Program program(context, text);
    try {
        program.build({device}, with_standard(device, options).c_str());
    } catch (const cl::Error &e) {
        const std::string build_log = build_log_of(program, device);
        log::detail(build_log);
        throw DeviceError(fmt::format("the kernel does not compile (OpenCL error {}): {}", e.err(),
                                      first_error(build_log)));
    }
    return program;
}

BuiltKernel build_kernel(const cl::Context &context, const DeviceEntry &entry,
                         const std::string &text, const std::string &name,
                         const std::string &options,
                         const std::function<void(cl::Kernel &)> &launch) {
    const auto start = std::chrono::steady_clock::now();
    const std::string all_options = with_standard(entry.device, options);
    KernelCache cache(entry, text, all_options);
    BuiltKernel built;
    built.cached = cache.look_up();
    std::string reason = cache.why_not();
    cl::Program program;
    if (!cache.binary().empty()) {
        program = take_binary(context, entry.device, cache.binary(), all_options);
        if (program() == nullptr) {
            built.cached = false;
            reason = "the driver does not take the cached one";
        }
    }
    log::detail(built.cached ? "kernel: from the cache" : "kernel: compiling, " + reason);
    if (program() == nullptr)
        program = compile_program(context, entry.device, text, options);
    with_device("compiling the kernel", [&] {
        built.kernel = cl::Kernel(program, name.c_str());
        launch(built.kernel);
        if (!built.cached)
            cache.store(program);
    });
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    built.seconds = took.count();
    return built;
}

} // namespace clrender
