#pragma once
/// Names of what layers tell apart.

#include "scene.h"

namespace clrender {

/// Numbers and names the shapes and instances that the reader has not numbered, one after the
/// other.
void name_objects(Scene &scene);

/// By Scene::bsdfs: their ids, or made-up names.
std::vector<std::string> bsdf_names(const Scene &scene);

} // namespace clrender
