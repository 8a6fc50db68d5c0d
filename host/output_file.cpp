#include "output_file.h"

#include "error.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>

namespace clrender {

namespace {

std::string folder_of(const std::string &path) {
    const std::string folder = std::filesystem::path(path).parent_path().string();
    return folder.empty() ? "." : folder;
}

/// Small pieces are put together to so many bytes.
constexpr std::size_t buffer_bytes = std::size_t(1) << 18;

} // namespace

AtomicFile::AtomicFile(const std::string &path) : path_(path) {
    // The name of a device, a FIFO or a folder must not be replaced by a picture.
    struct stat status = {};
    if (::stat(path.c_str(), &status) == 0) {
        if (!S_ISREG(status.st_mode))
            throw OutputError(path_, "is not a regular file, expected a file to write to");
        if (::access(path.c_str(), W_OK) != 0)
            fail();
    } else if (errno != ENOENT) {
        fail();
    }
    static std::atomic<int> counter{0};
    temporary_ =
        folder_of(path) + "/.clr" + std::to_string(::getpid()) + "-" + std::to_string(counter++);
    constexpr mode_t mode = 0666;
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    if (descriptor_ < 0)
        fail();
}

AtomicFile::~AtomicFile() {
    if (descriptor_ >= 0)
        ::close(descriptor_);
    if (!committed_)
        ::unlink(temporary_.c_str());
}

void AtomicFile::write(std::string_view bytes) {
    pending_ += bytes;
    if (pending_.size() >= buffer_bytes)
        flush();
}

void AtomicFile::seek(std::uint64_t position) {
    flush();
    if (::lseek(descriptor_, static_cast<off_t>(position), SEEK_SET) < 0)
        fail();
    written_ = position;
}

void AtomicFile::flush() {
    std::string_view bytes = pending_;
    while (!bytes.empty()) {
        const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
        if (count < 0 && errno != EINTR)
            fail();
        bytes.remove_prefix(count > 0 ? static_cast<std::size_t>(count) : 0);
    }
    written_ += pending_.size();
    pending_.clear();
}

void AtomicFile::commit() {
    check();
    flush();
    if (::fsync(descriptor_) != 0)
        fail();
    const int closed = ::close(descriptor_);
    descriptor_ = -1;
    if (closed != 0 || std::rename(temporary_.c_str(), path_.c_str()) != 0)
        fail();
    committed_ = true;
    sync_folder();
}

/// Puts the new name on the disk too. Where a file system cannot do that, the file is written all
/// the same.
void AtomicFile::sync_folder() const {
    const int folder = ::open(folder_of(path_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0)
        return;
    ::fsync(folder);
    ::close(folder);
}

void AtomicFile::check() const {
    if (failure_ != 0)
        throw OutputError(path_,
                          std::string("cannot be written (") + std::strerror(failure_) + ")");
}

void AtomicFile::fail() {
    failure_ = errno;
    check();
    throw OutputError(path_, "cannot be written");
}

void write_output_file(const std::string &path, std::string_view bytes) {
    AtomicFile file(path);
    file.write(bytes);
    file.commit();
}

void write_encoded_file(const std::string &path, const std::function<void(AtomicFile &)> &encode) {
    AtomicFile file(path);
    try {
        encode(file);
    } catch (const OutputError &) {
        throw;
    } catch (const std::bad_alloc &) {
        throw;
    } catch (const std::exception &error) {
        file.check();
        throw OutputError(path, std::string("cannot be encoded (") + error.what() + ")");
    }
    file.commit();
}

std::string why_not_writable(const std::string &path) {
    std::error_code ignored;
    if (path.empty())
        return "the file name is empty";
    if (std::filesystem::is_directory(path, ignored))
        return "'" + path + "' is a folder";
    if (!std::filesystem::is_directory(folder_of(path), ignored))
        return "there is no folder '" + folder_of(path) + "'";
    try {
        const AtomicFile probe(path);
    } catch (const OutputError &error) {
        return error.what();
    }
    return {};
}

} // namespace clrender
