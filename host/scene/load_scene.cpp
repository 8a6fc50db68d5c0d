#include "load_scene.h"

#include "../log.h"
#include "../memory_limit.h"
#include "mitsuba_xml.h"
#include "model_scene.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace clrender {

Scene load_scene(const std::string &path, const LoadOptions &options) {
    forget_memory_claims();
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (extension == ".xml")
        return load_mitsuba_xml(path, options);
    if (extension != ".obj" && extension != ".ply")
        throw InputError({path, 0}, "unknown kind of scene, expected a .xml, .obj or .ply file");

    for (const auto &[name, value] : options.defines)
        log::warn(std::string("-D ").append(name).append(": nothing in ").append(path) +
                  " uses it");
    return load_model(path);
}

} // namespace clrender
