#pragma once
/// What a bare model lacks to be a scene, and the parts that scenes are made of where no file
/// describes them.

#include "scene.h"

namespace clrender {

/// A sphere around all vertices of the scene's meshes, instances included.
struct ModelBounds {
    glm::dvec3 center{0.0};
    double radius = 1;
    double floor = 0; ///< smallest y
};
ModelBounds bounds_of_meshes(const Scene &scene);

/// A large grey disk below the model, which has +y up.
void add_ground(Scene &scene, const ModelBounds &bounds);

/// A large soft light above to the left, and a dim sky.
void add_lights(Scene &scene, const ModelBounds &bounds);

/// A camera that frames the model from above its right front, in a picture of the film's size.
void add_camera(Scene &scene, const ModelBounds &bounds);

/// All return indices into the scene's lists.
int add_color(Scene &scene, const Rgb &color);
int add_bsdf(Scene &scene, const Bsdf &bsdf);
/// The same on both sides: models are seldom closed.
int add_twosided(Scene &scene, const BsdfModel &model);
int add_diffuse(Scene &scene, int reflectance);

Shape &add_shape(Scene &scene, ShapeKind kind, const glm::dmat4 &to_world, int bsdf);
/// Makes the last shape shine with a texture.
void add_area_light(Scene &scene, int radiance);

} // namespace clrender
