/// The numbers and names of the scene's shapes and instances, as layers tell them.

#include "mitsuba_scene.h"

#include <algorithm>
#include <fmt/core.h>

namespace clrender::mitsuba {

void SceneReader::number_object(int object, std::size_t first_shape, std::size_t first_instance) {
    const bool is_instance = document_.at(object).type == "instance";
    if (scene_.shapes.size() == first_shape && scene_.instances.size() == first_instance)
        return;
    const ShapeKind kind =
        scene_.shapes.size() > first_shape ? scene_.shapes.back().kind : ShapeKind::sphere;
    if (!is_instance && (kind == ShapeKind::mesh || kind == ShapeKind::rectangle)) {
        meshes_.push_back({object, first_shape});
        return;
    }
    const int number = name_object(object);
    for (std::size_t i = first_shape; i < scene_.shapes.size(); ++i)
        scene_.shapes[i].object = number;
    for (std::size_t i = first_instance; i < scene_.instances.size(); ++i)
        scene_.instances[i].object = number;
}

void SceneReader::number_meshes() {
    std::for_each(meshes_.rbegin(), meshes_.rend(), [this](const auto &mesh) {
        scene_.shapes[mesh.shape].object = name_object(mesh.object);
    });
}

int SceneReader::name_object(int object) {
    const Object &source = document_.at(object);
    const std::size_t number = scene_.object_names.size();
    scene_.object_names.push_back(source.id.empty() ? fmt::format("{}_{}", source.type, number + 1)
                                                    : source.id);
    return static_cast<int>(number);
}

} // namespace clrender::mitsuba
