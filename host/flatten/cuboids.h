#pragma once
/// Cubes that every ray tests, lane-wise.

#include "real.h"
#include "scene/scene.h"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace clrender::inline CLR_PRECISION {

/// The faces of a cuboid by Scene::shapes: those of its three axes, the negative side first.
using CuboidFaces = std::array<std::size_t, 6>;

/// A scene in which rectangles stand for cubes.
struct SceneOfFaces {
    Scene scene;
    std::vector<CuboidFaces> cuboids;
};

/// The same scene with each cube as six rectangles, of which the first stands in its place; nothing
/// where that would not spare the rays a tree, which is where there are no cubes, other shapes than
/// few spheres, rectangles and disks, or cubes that are many, emit or have aslant edges.
std::optional<SceneOfFaces> cubes_as_faces(const Scene &scene);

} // namespace clrender::inline CLR_PRECISION
