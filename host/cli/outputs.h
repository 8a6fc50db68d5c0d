#pragma once
/// All files of a run are written, whatever becomes of the others.

#include "image/image.h"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace clrender::cli {

/// What has been written, and what could not be.
class Outputs {
public:
    /// Runs `write`, which writes `path`. What it throws is kept as one line for report().
    void attempt(const std::string &path, const std::function<void()> &write);

    /// Where no picture has been written: puts it as EXR, else as PFM, under a new name that begins
    /// with `name`, into the current folder or else the one for temporary files.
    void rescue(const std::string &name, const Image &image,
                const std::map<std::string, std::string> &metadata);

    /// Prints a line for each failure, and where a rescued picture is. True if there was none.
    [[nodiscard]] bool report() const;

    [[nodiscard]] const std::vector<std::string> &written() const { return written_; }

private:
    std::vector<std::string> written_;
    std::vector<std::string> failures_;
    std::string rescued_;
};

} // namespace clrender::cli
