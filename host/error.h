#pragma once
/// Errors a person can act on. Every reader reports bad input as one line
/// `file:line: what is wrong, what was expected`; `main` turns the type into the exit code.

#include <stdexcept>
#include <string>
#include <vector>

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

/// `text` as one line: names and texts out of a file may hold anything.
inline std::string as_one_line(std::string text) {
    for (char &c : text)
        if (static_cast<unsigned char>(c) < ' ' || c == '\x7f')
            c = '?';
    return text;
}

/// Bad input: exit code 2, no output file.
class InputError : public std::runtime_error {
public:
    InputError(const SourceLocation &where, const std::string &what)
        : std::runtime_error(as_one_line(where.str() + ": " + what)) {}

    /// Several faults, each a line as above.
    explicit InputError(const std::vector<std::string> &faults)
        : std::runtime_error(as_lines(faults)) {}

private:
    static std::string as_lines(const std::vector<std::string> &faults) {
        std::string lines;
        for (const std::string &fault : faults)
            lines += (lines.empty() ? "" : "\n") + as_one_line(fault);
        return lines;
    }
};

/// A file that cannot be written: exit code 4; everything else is written all the same.
class OutputError : public std::runtime_error {
public:
    OutputError(const std::string &path, const std::string &what)
        : std::runtime_error(as_one_line(path + ": " + what)) {}
};

/// The system has not the memory that the run would need: exit code 5.
class MemoryError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// No usable device, or the device failed: exit code 3.
class DeviceError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

} // namespace clrender
