#include "outputs.h"

#include "log.h"

#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <unistd.h>

namespace clrender::cli {

namespace fs = std::filesystem;

void Outputs::attempt(const std::string &path, const std::function<void()> &write) {
    try {
        write();
        written_.push_back(path);
    } catch (const std::bad_alloc &) {
        failures_.push_back(path + ": cannot be written (out of memory)");
    } catch (const std::exception &error) {
        failures_.emplace_back(error.what());
    }
}

void Outputs::rescue(const std::string &name, const Image &image,
                     const std::map<std::string, std::string> &metadata) {
    const char *temporary = std::getenv("TMPDIR");
    const std::vector<fs::path> folders = {".", temporary != nullptr && *temporary != 0 ? temporary
                                                                                        : "/tmp"};
    for (const fs::path &folder : folders)
        for (const char *extension : {".exr", ".pfm"}) {
            const std::string file = name + ".rescued-" + std::to_string(::getpid()) + extension;
            const fs::path path = folder / file;
            std::error_code ignored;
            if (fs::exists(fs::symlink_status(path, ignored)))
                continue;
            try {
                write_image(path.string(), image, 0, metadata);
                rescued_ = fs::absolute(path, ignored).lexically_normal().string();
                return;
            } catch (const std::exception &) {
                // The next place may be better; the outputs' own failures are reported.
                continue;
            }
        }
}

bool Outputs::report() const {
    for (const std::string &failure : failures_)
        log::error(failure);
    if (!rescued_.empty())
        log::error("no picture could be written where it was to be; it is in " + rescued_);
    return failures_.empty();
}

} // namespace clrender::cli
