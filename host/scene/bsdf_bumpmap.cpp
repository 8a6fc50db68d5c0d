#include "mitsuba_scene.h"

namespace clrender::mitsuba {

void SceneReader::read_model(Properties &properties, BumpMapBsdf &bsdf) {
    const auto textures = properties.children("texture");
    if (textures.size() != 1)
        throw InputError(properties.where(), properties.description() + " has " +
                                                 std::to_string(textures.size()) +
                                                 " nested textures, expected one");
    bsdf.height = read_texture(textures.front()->object, SpectrumUse::number);
    if (scene_.textures.at(static_cast<std::size_t>(bsdf.height)).kind == TextureKind::attribute)
        throw UnsupportedError(document_.where(document_.at(textures.front()->object)),
                               properties.description() + ": its height is a \"mesh_attribute\", "
                                                          "expected a \"bitmap\"");
    bsdf.scale = properties.number("scale", 1);
    bsdf.normals = read_perturbed_normals(properties);
    bsdf.nested = read_turned(properties);
}

} // namespace clrender::mitsuba
