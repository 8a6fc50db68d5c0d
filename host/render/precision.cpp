#include "render_at_precision.h"

#include <utility>

namespace clrender {

/// render.cpp and all that it flattens with, compiled with CLR_DOUBLE.
namespace double_precision {

MemoryNeed memory_at_precision(Scene &&scene, const RenderOptions &options);
RenderResult render_at_precision(Scene &&scene, const RenderOptions &options);
std::unique_ptr<AdvancingRender> start_at_precision(Scene &&scene, const RenderOptions &options);

} // namespace double_precision

MemoryNeed memory_needed(Scene &&scene, const RenderOptions &options) {
    return options.double_precision
               ? double_precision::memory_at_precision(std::move(scene), options)
               : single_precision::memory_at_precision(std::move(scene), options);
}

RenderResult render_scene(const Scene &scene, const RenderOptions &options) {
    return render_scene(Scene(scene), options);
}

RenderResult render_scene(Scene &&scene, const RenderOptions &options) {
    return options.double_precision
               ? double_precision::render_at_precision(std::move(scene), options)
               : single_precision::render_at_precision(std::move(scene), options);
}

std::unique_ptr<AdvancingRender> start_render(Scene &&scene, const RenderOptions &options) {
    return options.double_precision
               ? double_precision::start_at_precision(std::move(scene), options)
               : single_precision::start_at_precision(std::move(scene), options);
}

} // namespace clrender
