#pragma once
/// Reading untrusted files: only regular files are opened, so that a folder, a FIFO or a device
/// named by a scene is an error and never blocks.

#include "error.h"

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>

namespace clrender {

/// A regular file opened for reading from its beginning.
class InputFile {
public:
    /// Throws InputError at `referrer` (the line that names the file) or, without one, at `path`.
    explicit InputFile(const std::string &path, const SourceLocation &referrer = {});
    ~InputFile();
    InputFile(const InputFile &) = delete;
    InputFile &operator=(const InputFile &) = delete;

    /// Bytes in the file when it was opened.
    [[nodiscard]] std::uint64_t size() const { return size_; }

    /// Goes to a byte of the file. Throws InputError.
    void seek(std::uint64_t offset);

    /// Reads up to `count` bytes; less only at the end of the file. Throws InputError.
    std::size_t read(char *buffer, std::size_t count);

private:
    [[noreturn]] void fail(const std::string &reason) const;

    std::string path_;
    SourceLocation referrer_;
    int descriptor_ = -1;
    std::uint64_t size_ = 0;
};

/// Files that a scene consists of, for telling scenes apart: all InputFiles note themselves,
/// whoever reads in another way does it.
void note_input_file(const std::string &path);
/// Their names, each once, since the last call of forget_input_files().
std::set<std::string> noted_input_files();
void forget_input_files();

/// `path` in quotes, at its full length, without control characters: for messages.
std::string quoted_path(const std::string &path);

/// The whole content of a regular file. Throws InputError as InputFile does.
std::string read_input_file(const std::string &path, const SourceLocation &referrer = {});

} // namespace clrender
