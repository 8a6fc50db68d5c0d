#pragma once
/// Files that the program leaves behind. A failure leaves an older file as it was.

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace clrender {

/// A new file in the folder of `path` that takes its place by commit(), or else vanishes: pictures
/// go to it piece by piece, as they are encoded. All members throw OutputError that names `path`
/// and the reason.
class AtomicFile {
public:
    explicit AtomicFile(const std::string &path);
    ~AtomicFile();
    AtomicFile(const AtomicFile &) = delete;
    AtomicFile &operator=(const AtomicFile &) = delete;

    /// Adds bytes at the position, and moves it behind them.
    void write(std::string_view bytes);
    [[nodiscard]] std::uint64_t position() const { return written_ + pending_.size(); }
    void seek(std::uint64_t position);

    /// Throws if something has failed before: libraries may keep to themselves what they caught.
    void check() const;
    /// Waits until all bytes are on the disk, and gives them the name `path`.
    void commit();

private:
    void flush();
    void sync_folder() const;
    [[noreturn]] void fail();

    std::string path_, temporary_; ///< the latter is short: it can be made wherever `path` can
    std::string pending_;          ///< bytes that are not written yet
    std::uint64_t written_ = 0;    ///< the position before them
    int descriptor_ = -1;
    int failure_ = 0; ///< errno of the first failure
    bool committed_ = false;
};

/// Writes `bytes` to an AtomicFile and commits it.
void write_output_file(const std::string &path, std::string_view bytes);

/// Lets `encode` write to an AtomicFile, and commits it. What a library throws becomes an
/// OutputError; where the file had failed, the file's.
void write_encoded_file(const std::string &path, const std::function<void(AtomicFile &)> &encode);

/// Why `path` cannot be written, or "". Finds out by making a temporary file in its folder, which
/// is removed again.
std::string why_not_writable(const std::string &path);

} // namespace clrender
