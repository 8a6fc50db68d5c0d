#pragma once
/// Scratch files for the tests of the readers and writers.

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace test {

/// A new folder that vanishes with everything in it.
class ScratchFolder {
public:
    ScratchFolder() {
        std::string pattern =
            (std::filesystem::temp_directory_path() / "clrender-test-XXXXXX").string();
        folder_ = ::mkdtemp(pattern.data());
    }
    ~ScratchFolder() { std::filesystem::remove_all(folder_); }
    ScratchFolder(const ScratchFolder &) = delete;
    ScratchFolder &operator=(const ScratchFolder &) = delete;

    [[nodiscard]] std::string path(const std::string &name) const {
        return (folder_ / name).string();
    }
    /// Writes a file and returns its path. (A new one: some file systems flush at a truncation.)
    [[nodiscard]] std::string file(const std::string &name, const std::string &bytes) const {
        std::filesystem::remove(path(name));
        std::ofstream(path(name), std::ios::binary) << bytes;
        return path(name);
    }
    [[nodiscard]] std::size_t count() const {
        const std::filesystem::directory_iterator files(folder_);
        return static_cast<std::size_t>(std::distance(begin(files), end(files)));
    }

private:
    std::filesystem::path folder_;
};

inline std::string read_bytes(const std::string &path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// What an InputError says, or "" if there was none.
template <class Function> std::string error_of(Function &&function) {
    try {
        function();
    } catch (const std::exception &error) {
        return error.what();
    }
    return {};
}

} // namespace test
