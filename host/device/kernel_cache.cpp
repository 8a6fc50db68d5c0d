#include "kernel_cache.h"

#include "cache_folder.h"

#include <cstdint>
#include <fmt/core.h>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>
#include <unistd.h>

namespace clrender {

namespace fs = std::filesystem;

namespace {

/// FNV-1a, 64 bits: detects changes and damage, not forgery.
std::uint64_t hash_of(const std::string &text) {
    std::uint64_t hash = 0xcbf29ce484222325ull;
    for (const char c : text)
        hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
    return hash;
}

std::optional<std::string> read_file(const fs::path &path) {
    std::ifstream file(path, std::ios::binary);
    if (!file)
        return std::nullopt;
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

/// Other runs see all of a file or nothing: it gets its name when it is complete.
void write_file(const fs::path &path, const std::string &content) {
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    const fs::path unfinished = path.string() + "." + std::to_string(getpid());
    std::ofstream file(unfinished, std::ios::binary);
    file << content;
    file.close();
    if (file)
        fs::rename(unfinished, path, error);
    if (!file || error)
        fs::remove(unfinished, error);
}

/// PoCL's folders of programs.
std::vector<fs::path> pocl_programs() {
    std::vector<fs::path> programs;
    std::error_code error;
    for (const fs::directory_entry &group : fs::directory_iterator(pocl_cache(), error))
        for (const fs::directory_entry &program : fs::directory_iterator(group.path(), error))
            programs.push_back(program.path());
    return programs;
}

/// Those that PoCL has used since `start`: it touches a file in each.
std::vector<fs::path> pocl_programs_since(fs::file_time_type start) {
    std::vector<fs::path> programs = pocl_programs();
    std::erase_if(programs, [&](const fs::path &program) {
        std::error_code error;
        const auto used = fs::last_write_time(program / "last_accessed", error);
        return error || used < start;
    });
    return programs;
}

/// A line for each file of the programs: hash and path below PoCL's cache.
std::string describe_pocl_files(const std::vector<fs::path> &programs) {
    std::string lines;
    std::error_code error;
    for (const fs::path &program : programs)
        for (const fs::directory_entry &file : fs::recursive_directory_iterator(program, error)) {
            const auto content = file.is_regular_file() ? read_file(file.path()) : std::nullopt;
            if (content && !content->empty())
                lines += fmt::format("{:016x} {}\n", hash_of(*content),
                                     fs::relative(file.path(), pocl_cache(), error).string());
        }
    return lines;
}

/// A file of PoCL's, as an entry describes it.
struct PoclFile {
    std::string hash;
    fs::path name; ///< below PoCL's cache

    /// The folder of its program: the first two parts of the name.
    [[nodiscard]] fs::path program() const {
        auto part = name.begin();
        const fs::path group = *part++;
        return part == name.end() ? group : group / *part;
    }
};

/// The files that an entry, or its payload alone, describes; other lines are passed over.
std::vector<PoclFile> described_pocl_files(const std::string &entry) {
    constexpr std::size_t digits = 16;
    std::vector<PoclFile> files;
    std::istringstream lines(entry);
    for (std::string line; std::getline(lines, line);)
        if (line.size() > digits + 1 && line[digits] == ' ')
            files.push_back({line.substr(0, digits), line.substr(digits + 1)});
    return files;
}

/// Whether PoCL still has these files as they were; removes the programs of those that it has not.
bool pocl_files_are_sound(const std::string &payload) {
    bool sound = true;
    for (const PoclFile &file : described_pocl_files(payload)) {
        const auto content = read_file(pocl_cache() / file.name);
        if (content && fmt::format("{:016x}", hash_of(*content)) == file.hash)
            continue;
        sound = false;
        std::error_code error;
        fs::remove_all(pocl_cache() / file.program(), error);
    }
    return sound;
}

/// Removes PoCL's programs that no entry vouches for: a run that ended before it had written one
/// may have left them unfinished, and PoCL aborts on such. Those of the last hour may be another
/// run's. Only in a folder of our own.
void remove_unknown_programs() {
    std::error_code error;
    if (fs::relative(pocl_cache(), cache_folder(), error).string().rfind("..", 0) == 0 || error)
        return;
    std::set<fs::path> known;
    for (const fs::directory_entry &entry :
         fs::directory_iterator(cache_folder() / "kernels", error))
        for (const PoclFile &file : described_pocl_files(read_file(entry.path()).value_or("")))
            known.insert(pocl_cache() / file.program());
    const auto recent = fs::file_time_type::clock::now() - std::chrono::hours(1);
    const auto remove_old = [&](const fs::path &path) {
        if (fs::last_write_time(path, error) < recent && !error)
            fs::remove_all(path, error);
    };
    for (const fs::path &program : pocl_programs())
        if (known.count(program) == 0)
            remove_old(program);
    for (const fs::directory_entry &file : fs::directory_iterator(pocl_cache(), error))
        if (file.path().filename().string().rfind("tempfile", 0) == 0)
            remove_old(file.path());
}

} // namespace

KernelCache::KernelCache(const DeviceEntry &entry, const std::string &text,
                         const std::string &options)
    : driver_keeps_kernels_(entry.platform == "Portable Computing Language"),
      // Oclgrind has compiler options of its own, in its environment.
      enabled_(entry.platform != "Oclgrind" && !cache_folder().empty()),
      // File systems may round times down to whole seconds.
      start_(fs::file_time_type::clock::now() - std::chrono::seconds(1)) {
    const std::string driver = entry.version + entry.device.getInfo<CL_DRIVER_VERSION>();
    file_ = cache_folder() / "kernels" /
            fmt::format("{:016x}", hash_of(entry.name + entry.platform + options));
    identity_ = fmt::format("driver {:016x}\nsources {:016x}\n", hash_of(driver), hash_of(text));
}

/// The rest of the entry, if it is whole and was made from the same; else empty.
std::string KernelCache::read_payload() {
    const auto content = enabled_ ? read_file(file_) : std::nullopt;
    if (!content) {
        why_not_ = "it is not in the cache";
        return {};
    }
    const std::size_t line = identity_.find('\n');
    if (content->compare(0, line, identity_, 0, line) != 0) {
        why_not_ = "the driver has changed";
        return {};
    }
    if (content->compare(0, identity_.size(), identity_) != 0) {
        why_not_ = "the sources have changed";
        return {};
    }
    why_not_ = "the cached one is gone or damaged";
    const std::size_t end = content->find('\n', identity_.size());
    if (end == std::string::npos)
        return {};
    const std::string payload = content->substr(end + 1);
    const std::string check = content->substr(identity_.size(), end - identity_.size());
    return check == fmt::format("{:016x}", hash_of(payload)) ? payload : std::string();
}

bool KernelCache::look_up() {
    const std::string payload = read_payload();
    if (payload.empty()) {
        if (enabled_ && driver_keeps_kernels_)
            remove_unknown_programs();
        return false;
    }
    if (driver_keeps_kernels_)
        return pocl_files_are_sound(payload);
    binary_.assign(payload.begin(), payload.end());
    return true;
}

void KernelCache::store(const cl::Program &program) const {
    if (!enabled_)
        return;
    std::string payload;
    if (driver_keeps_kernels_) {
        payload = describe_pocl_files(pocl_programs_since(start_));
    } else {
        const auto binaries = program.getInfo<CL_PROGRAM_BINARIES>();
        if (!binaries.empty())
            payload.assign(binaries.front().begin(), binaries.front().end());
    }
    if (!payload.empty())
        write_file(file_, identity_ + fmt::format("{:016x}\n", hash_of(payload)) + payload);
}

} // namespace clrender
