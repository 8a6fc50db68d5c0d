#pragma once
/// The files that a scene names, read side by side.

#include <functional>
#include <vector>

namespace clrender {

class FileReads {
public:
    /// `read` is run later, on any thread; what it changes must be its own.
    void add(std::function<void()> read);

    /// Runs what has been added since. Messages come in the order of `add`, up to those of the
    /// first read that fails; what that one has thrown is thrown here. With `all_faults` none is
    /// left out, and the InputErrors are thrown as one.
    void run(bool all_faults = false);

private:
    std::vector<std::function<void()>> reads_;
};

} // namespace clrender
