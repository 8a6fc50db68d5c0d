#include "input_file.h"

#include "memory_limit.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <mutex>
#include <new>

namespace clrender {

namespace {

struct NotedFiles {
    std::mutex mutex;
    std::set<std::string> names;
};

NotedFiles &noted_files() {
    static NotedFiles files;
    return files;
}

} // namespace

void note_input_file(const std::string &path) {
    NotedFiles &noted = noted_files();
    const std::lock_guard lock(noted.mutex);
    noted.names.insert(path);
}

std::set<std::string> noted_input_files() {
    NotedFiles &noted = noted_files();
    const std::lock_guard lock(noted.mutex);
    return noted.names;
}

void forget_input_files() {
    NotedFiles &noted = noted_files();
    const std::lock_guard lock(noted.mutex);
    noted.names.clear();
}

InputFile::InputFile(const std::string &path, const SourceLocation &referrer)
    : path_(path), referrer_(referrer) {
    if (path.empty() || path.find('\0') != std::string::npos)
        fail("not a file name, expected the path of a file");

    // Without O_NONBLOCK a FIFO that nobody writes to would block here.
    descriptor_ = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor_ < 0)
        fail(std::string("cannot be opened (") + std::strerror(errno) +
             "), expected a readable file");

    struct stat status = {};
    if (::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) {
        ::close(descriptor_);
        fail(S_ISDIR(status.st_mode) ? "is a folder, expected a file"
                                     : "is not a regular file, expected a file");
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
    note_input_file(path);
}

InputFile::~InputFile() {
    ::close(descriptor_);
}

void InputFile::seek(std::uint64_t offset) {
    if (::lseek(descriptor_, static_cast<off_t>(offset), SEEK_SET) < 0)
        fail(std::string("cannot be read (") + std::strerror(errno) + ")");
}

std::size_t InputFile::read(char *buffer, std::size_t count) {
    std::size_t done = 0;
    while (done < count) {
        const ssize_t got = ::read(descriptor_, buffer + done, count - done);
        if (got == 0)
            break;
        if (got < 0 && errno != EINTR)
            fail(std::string("cannot be read (") + std::strerror(errno) + ")");
        if (got > 0)
            done += static_cast<std::size_t>(got);
    }
    return done;
}

void InputFile::fail(const std::string &reason) const {
    if (referrer_.file.empty())
        throw InputError({path_, 0}, reason);
    throw InputError(referrer_, path_ + ": " + reason);
}

std::string quoted_path(const std::string &path) {
    return '"' + as_one_line(path) + '"';
}

std::string read_input_file(const std::string &path, const SourceLocation &referrer) {
    InputFile file(path, referrer);
    const SourceLocation where = referrer.file.empty() ? SourceLocation{path, 0} : referrer;
    if (const std::string reason = claim_memory(file.size()); !reason.empty())
        throw InputError(where, path + ": " + reason);
    std::string bytes;
    try {
        bytes.resize(file.size());
    } catch (const std::exception &) {
        throw InputError(where, path + ": does not fit into memory");
    }
    bytes.resize(file.read(bytes.data(), bytes.size()));
    return bytes;
}

} // namespace clrender
