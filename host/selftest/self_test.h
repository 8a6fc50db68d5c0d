#pragma once
/// clrender --self-test: whether a device computes what it should.

#include "render/render.h"

namespace clrender::selftest {

/// Runs the checks of the device functions and the reference scenes on the device that `how` names,
/// with its lanes and kernels, and prints the table, what failed once more at its end. True if all
/// has passed. Throws DeviceError where the device cannot run them.
bool run_self_test(const RenderOptions &how);

} // namespace clrender::selftest
