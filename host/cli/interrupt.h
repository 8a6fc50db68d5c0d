#pragma once
/// Ctrl-C and SIGTERM: the end at once while there is no picture, else a question that the render
/// loop asks, so that the picture so far is written.

namespace clrender::cli {

/// From now on SIGINT and SIGTERM end the process with a line that says so and exit code 128 + the
/// signal's number.
void catch_interrupts();

/// There is something to be kept: from now on the first signal only sets a flag. The second ends
/// the process at once.
void keep_picture();

/// The signal that has set the flag, or 0.
int interrupted();

/// A file that grows beyond what the system allows, or a pipe that nobody reads, fails the write
/// and not the process: the other files are still to be written.
void ignore_write_signals();

} // namespace clrender::cli
