#pragma once
/// What code under test says to the person at the terminal.

#include "log.h"

#include <string>

namespace test {

/// The messages of this thread while `function` runs.
template <class Function> std::string stderr_of(Function &&function) {
    clrender::log::Holder holder;
    function();
    return holder.take();
}

} // namespace test
