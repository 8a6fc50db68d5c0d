#pragma once
/// `clrender test SCENE --reference REF.exr`.

#include "cli/options.h"
#include "render/render.h"

#include <functional>

namespace clrender::cli {

/// Samples a pixel where -s sets no limit.
inline constexpr int default_test_samples = 65536;

/// Renders until the picture differs from the reference by more than the noise of both, or the
/// effect is excluded, or RenderOptions::spp samples are taken; prints which, and where the
/// pictures differ. `write` gets the last picture. Returns the exit code. Throws InputError.
int test_command(const TestOptions &options, Scene &&scene, const RenderOptions &how,
                 const std::function<void(const RenderResult &)> &write);

} // namespace clrender::cli
