#pragma once
/// Errors a person can act on. Every reader reports bad input as one line
/// `file:line: what is wrong, what was expected`; `main` turns the type into the exit code.

#include <stdexcept>
#include <string>

namespace clrender {

/// A place in an input file. `line` is 1-based; 0 means the file as a whole (binary formats).
struct SourceLocation {
    std::string file;
    int line = 0;

    /// `file:line`, or only `file` where no line is known.
    [[nodiscard]] std::string str() const {
        return line > 0 ? file + ":" + std::to_string(line) : file;
    }
};

/// Bad input: exit code 2, no output file.
class InputError : public std::runtime_error {
public:
    InputError(const SourceLocation &where, const std::string &what)
        : std::runtime_error(where.str() + ": " + what) {}
};

/// A file that cannot be written: exit code 4; everything else is written all the same.
class OutputError : public std::runtime_error {
public:
    OutputError(const std::string &path, const std::string &what)
        : std::runtime_error(path + ": " + what) {}
};

/// No usable device, or the device failed: exit code 3.
class DeviceError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

} // namespace clrender
