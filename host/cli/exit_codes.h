#pragma once
/// What the program's exit code says; README and manual list them.

namespace clrender::cli {

enum ExitCode {
    exit_fine = 0,
    exit_differs = 1,   ///< compare: beyond the tolerance; test: beyond the noise
    exit_input = 2,     ///< an option or a file is wrong
    exit_device = 3,    ///< no usable device, or it failed
    exit_output = 4,    ///< a file could not be written; all others are
    exit_memory = 5,    ///< the system has no more memory
    exit_internal = 70, ///< a fault of the program itself (EX_SOFTWARE of sysexits.h)
    exit_signal = 128   ///< plus the signal's number: 130 after SIGINT, 143 after SIGTERM
};

} // namespace clrender::cli
