#include "object_names.h"

namespace clrender {

void name_objects(Scene &scene) {
    for (Shape &shape : scene.shapes) {
        if (shape.object != none)
            continue;
        shape.object = static_cast<int>(scene.object_names.size());
        scene.object_names.push_back(shape.id.empty() ? "shape_" + std::to_string(shape.object + 1)
                                                      : shape.id);
    }
}

std::vector<std::string> bsdf_names(const Scene &scene) {
    std::vector<std::string> names;
    for (const Bsdf &bsdf : scene.bsdfs)
        names.push_back(bsdf.id.empty() ? "material_" + std::to_string(names.size() + 1) : bsdf.id);
    return names;
}

} // namespace clrender
