#pragma once
/// Ctrl-C and SIGTERM as a question the render loop asks, so that the picture so far is written.

namespace clrender::cli {

/// From now on the first SIGINT or SIGTERM only sets a flag; the second ends the process at once.
void catch_interrupts();

/// True after such a signal.
bool interrupted();

} // namespace clrender::cli
