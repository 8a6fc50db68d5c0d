#pragma once
/// Cameras and lights of a glTF file.

#include "gltf_nodes.h"
#include "scene.h"

namespace clrender::gltf {

/// Makes the camera of a node the scene's, with a picture of its aspect ratio. A scale of the node
/// has no meaning. Throws InputError.
void read_camera(const Document &document, const PlacedNode &node, Scene &scene);

/// Adds the light of a node (KHR_lights_punctual). Candela are taken as W/sr and lux as W/m^2, as
/// emission is, so that what the standard has in photometric units keeps its ratios. Throws
/// InputError.
void read_light(const Document &document, const PlacedNode &node, int light, Scene &scene);

/// The light that a node has, or -1.
int light_of(const tinygltf::Node &node);

} // namespace clrender::gltf
