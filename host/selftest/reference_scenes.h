#pragma once
/// Small scenes whose pictures have a closed form, through the whole renderer.

#include "check.h"
#include "render/render.h"

namespace clrender::selftest {

/// Renders them as `how` says of device, lanes and kernels: a furnace of spheres, a box that shines
/// inwards, and a floor under lights of all kinds. Throws DeviceError.
std::vector<Check> check_reference_scenes(const RenderOptions &how);

} // namespace clrender::selftest
