/// Groups of shapes and their instances.

#include "mitsuba_scene.h"
#include "mitsuba_transform.h"
#include "similarity.h"

#include <cmath>

namespace clrender::mitsuba {

namespace {

/// Spheres, ellipsoids, cylinders and disks are no triangles: the scene gets one for each instance.
bool is_copied(const Shape &shape) {
    return shape.kind != ShapeKind::rectangle && shape.kind != ShapeKind::mesh;
}

} // namespace

int SceneReader::read_group(int object) {
    const auto known = groups_.find(object);
    if (known != groups_.end())
        return known->second;

    Properties properties(document_, object);
    ReadGroup group;
    for (const Child *child : properties.children("shape")) {
        const Object &member = document_.at(child->object);
        if (member.type == "shapegroup" || member.type == "instance")
            throw UnsupportedError(document_.where(properties.object(), child->line),
                                   properties.description() + " contains another " + member.type +
                                       ", expected shapes: groups do not nest");
        Properties shape(document_, child->object);
        for (const Child *emitter : shape.children("emitter"))
            throw UnsupportedError(document_.where(member, emitter->line),
                                   "a shape of a shapegroup emits, expected none that does: "
                                   "emitters have no instances");

        // Read as a shape of the scene, and taken out of there.
        const std::size_t files = shapes_from_files_.size();
        read_shape(child->object);
        const bool from_file = shapes_from_files_.size() > files;
        shapes_from_files_.resize(files);
        Shape placed = std::move(scene_.shapes.back());
        scene_.shapes.pop_back();
        if (is_copied(placed)) {
            group.copied.push_back(std::move(placed));
        } else {
            group.shapes.shapes.push_back(std::move(placed));
            group.from_files.push_back(from_file);
        }
    }
    properties.finish();
    read_groups_.push_back(std::move(group));
    return groups_[object] = static_cast<int>(read_groups_.size() - 1);
}

void SceneReader::read_instance(int object) {
    Properties properties(document_, object);
    const auto shapes = properties.children("shape");
    const Child *child = shapes.empty() ? nullptr : shapes.front();
    if (child == nullptr)
        throw InputError(properties.where(), properties.description() +
                                                 " shows no shape, expected a <ref> to a shape "
                                                 "of type \"shapegroup\"");
    if (shapes.size() > 1)
        throw InputError(document_.where(properties.object(), shapes[1]->line),
                         properties.description() + " shows a second shape, expected one group");
    if (document_.at(child->object).type != "shapegroup")
        throw InputError(document_.where(properties.object(), child->line),
                         properties.description() + " shows a " + document_.at(child->object).type +
                             ", expected a shape of type \"shapegroup\"");
    const glm::dmat4 to_world = properties.transform("to_world");
    properties.finish();

    const int group = read_group(child->object);
    const ReadGroup &content = read_groups_[static_cast<std::size_t>(group)];
    if (!content.shapes.shapes.empty())
        scene_.instances.push_back({group, glm::dmat4x3(to_world)});
    for (Shape copy : content.copied) {
        // A sphere that is mirrored by its own transform turns inside out, one by that of its
        // instance does not.
        const bool mirrors = glm::determinant(glm::dmat3(to_world)) < 0;
        if ((copy.kind == ShapeKind::sphere || copy.kind == ShapeKind::ellipsoid) && mirrors)
            copy.flip_normals = !copy.flip_normals;
        copy.to_world = to_world * copy.to_world;
        if (copy.kind == ShapeKind::sphere && !is_similarity(glm::dmat3(copy.to_world)))
            copy.kind = ShapeKind::ellipsoid;
        check_thickness(properties, copy);
        scene_.shapes.push_back(std::move(copy));
    }
}

void SceneReader::finish_groups() {
    for (ReadGroup &group : read_groups_) {
        for (std::size_t i = 0; i < group.shapes.shapes.size(); ++i)
            if (group.from_files[i])
                follow_transform(group.shapes.shapes[i]);
        scene_.groups.push_back(std::move(group.shapes));
    }
    read_groups_.clear();
}

} // namespace clrender::mitsuba
