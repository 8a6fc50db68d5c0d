#pragma once
/// Ctrl-C and SIGTERM as a question the render loop asks, so that the picture so far is written.

namespace clrender::cli {

/// From now on the first SIGINT or SIGTERM only sets a flag; the second ends the process at once.
void catch_interrupts();

/// A file that grows beyond what the system allows, or a pipe that nobody reads, fails the write
/// and not the process: the other files are still to be written.
void ignore_write_signals();

/// True after such a signal.
bool interrupted();

} // namespace clrender::cli
