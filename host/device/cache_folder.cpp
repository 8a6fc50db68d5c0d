#include "cache_folder.h"

#include "log.h"

#include <cstdlib>
#include <string>
#include <unistd.h>

namespace clrender {

namespace fs = std::filesystem;

namespace {

std::string environment(const char *name) {
    const char *value = std::getenv(name);
    return value != nullptr ? value : "";
}

/// True if the folder is there, or can be made, and takes a new file.
bool is_writable_folder(const fs::path &folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    std::string probe = (folder / "probe_XXXXXX").string();
    const int descriptor = mkstemp(probe.data());
    if (descriptor < 0)
        return false;
    close(descriptor);
    unlink(probe.c_str());
    return true;
}

/// A folder below the system's for temporary files, removed with what is in it at the end.
class TemporaryFolder {
public:
    TemporaryFolder() {
        std::error_code error;
        std::string name = (fs::temp_directory_path(error) / "clrender_XXXXXX").string();
        if (mkdtemp(name.data()) != nullptr)
            path_ = name;
    }
    ~TemporaryFolder() {
        std::error_code error;
        if (!path_.empty())
            fs::remove_all(path_, error);
    }
    TemporaryFolder(const TemporaryFolder &) = delete;
    TemporaryFolder &operator=(const TemporaryFolder &) = delete;

    [[nodiscard]] const fs::path &path() const { return path_; }

private:
    fs::path path_;
};

fs::path choose_cache_folder() {
    fs::path base = environment("XDG_CACHE_HOME");
    if (base.empty() && !environment("HOME").empty())
        base = fs::path(environment("HOME")) / ".cache";
    if (!base.empty() && is_writable_folder(base / "clrender"))
        return base / "clrender";
    static const TemporaryFolder temporary;
    log::detail("no folder for the kernel cache can be written: kernels are not kept");
    return temporary.path();
}

} // namespace

const fs::path &cache_folder() {
    static const fs::path folder = choose_cache_folder();
    return folder;
}

void choose_pocl_cache() {
    const fs::path named = pocl_cache();
    if (!named.empty() && is_writable_folder(named))
        return;
    if (!cache_folder().empty())
        setenv("POCL_CACHE_DIR", (cache_folder() / "pocl").c_str(), 1);
}

fs::path pocl_cache() {
    return environment("POCL_CACHE_DIR");
}

} // namespace clrender
