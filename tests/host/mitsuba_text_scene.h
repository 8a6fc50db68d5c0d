#pragma once
/// Scenes for tests, from text.

#include "files.h"
#include "log.h"
#include "scene/load_scene.h"

#include <string>

namespace test {

inline clrender::Scene load(const std::string &path,
                            const std::map<std::string, std::string> &defines = {}) {
    clrender::LoadOptions options;
    options.defines = defines;
    return clrender::load_scene(path, options);
}

/// The scene with this content inside of its <scene> element.
inline clrender::Scene load_text(const std::string &content,
                                 const std::map<std::string, std::string> &defines = {}) {
    const ScratchFolder folder;
    return load(folder.file("scene.xml", "<scene version=\"3.0.0\">\n" + content + "\n</scene>\n"),
                defines);
}

/// The error of such a scene, from the line number on: "LINE: message". The content begins in
/// line 2.
inline std::string error_of_text(const std::string &content,
                                 const std::map<std::string, std::string> &defines = {}) {
    const std::string error = error_of([&] { load_text(content, defines); });
    const std::string file = "scene.xml:";
    const std::size_t at = error.find(file);
    return at == std::string::npos ? error : error.substr(at + file.size());
}

} // namespace test
