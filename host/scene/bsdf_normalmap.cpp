#include "mitsuba_scene.h"

namespace clrender::mitsuba {

PerturbedNormals read_perturbed_normals(Properties &properties) {
    PerturbedNormals normals;
    normals.flip_invalid = properties.boolean("flip_invalid_normals", true);
    normals.shadow = properties.boolean("use_shadowing_function", true);
    return normals;
}

void SceneReader::read_model(Properties &properties, NormalMapBsdf &bsdf) {
    bsdf.normalmap = read_colour(properties, "normalmap", SpectrumUse::data);
    if (bsdf.normalmap == none)
        properties.fail("normalmap", "is missing, expected a texture");
    bsdf.normals = read_perturbed_normals(properties);
    bsdf.nested = read_nested(properties, 1).front();
}

} // namespace clrender::mitsuba
