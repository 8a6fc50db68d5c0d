#include "mitsuba_scene.h"

namespace clrender::mitsuba {

PerturbedNormals read_perturbed_normals(Properties &properties) {
    PerturbedNormals normals;
    normals.flip_invalid = properties.boolean("flip_invalid_normals", true);
    normals.shadow = properties.boolean("use_shadowing_function", true);
    return normals;
}

namespace {

/// Whether a map turns the normals of a BSDF or of one that it nests.
struct IsTurned {
    const Scene &scene;

    [[nodiscard]] bool of(int bsdf) const {
        return std::visit(*this, scene.bsdfs.at(static_cast<std::size_t>(bsdf)).model);
    }
    bool operator()(const NormalMapBsdf &) const { return true; }
    bool operator()(const BumpMapBsdf &) const { return true; }
    bool operator()(const MaskBsdf &b) const { return of(b.nested); }
    bool operator()(const BlendBsdf &b) const { return of(b.first) || of(b.second); }
    bool operator()(const TwosidedBsdf &b) const { return of(b.front) || of(b.back); }
    bool operator()(const auto &) const { return false; }
};

} // namespace

int SceneReader::read_turned(Properties &properties) {
    const int nested = read_nested(properties, 1).front();
    if (IsTurned{scene_}.of(nested))
        throw UnsupportedError(properties.where(),
                               properties.description() +
                                   " nests another normal or bump map, expected one at most");
    return nested;
}

void SceneReader::read_model(Properties &properties, NormalMapBsdf &bsdf) {
    bsdf.normalmap = read_colour(properties, "normalmap", SpectrumUse::data);
    if (bsdf.normalmap == none)
        properties.fail("normalmap", "is missing, expected a texture");
    bsdf.normals = read_perturbed_normals(properties);
    bsdf.nested = read_turned(properties);
}

} // namespace clrender::mitsuba
