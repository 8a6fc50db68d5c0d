#include "mitsuba_xml.h"

#include "mitsuba_document.h"
#include "mitsuba_scene.h"

#include <filesystem>

namespace clrender {

Scene load_mitsuba_xml(const std::string &path, const LoadOptions &options) {
    const mitsuba::Document document =
        mitsuba::read_document(path, options.defines, options.all_faults);
    Scene scene = mitsuba::SceneReader(document, options.sensor).read();
    scene.name = std::filesystem::path(path).stem().string();
    return scene;
}

} // namespace clrender
