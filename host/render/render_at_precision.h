#pragma once
/// The functions of render.h, compiled once for each precision.

#include "render.h"
#include "shared/shared_types.h"

namespace clrender::inline CLR_PRECISION {

MemoryNeed memory_at_precision(Scene &&scene, const RenderOptions &options);

RenderResult render_at_precision(Scene &&scene, const RenderOptions &options);

std::unique_ptr<AdvancingRender> start_at_precision(Scene &&scene, const RenderOptions &options);

} // namespace clrender::inline CLR_PRECISION
