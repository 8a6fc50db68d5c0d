/// Emitter "projector".

#include "mitsuba_scene.h"

namespace clrender::mitsuba {

void SceneReader::check_projected(const Properties &properties, const std::string &name,
                                  int texture) const {
    if (scene_.textures[static_cast<std::size_t>(texture)].kind == TextureKind::attribute)
        properties.fail(name, "is a \"mesh_attribute\", which lights without a mesh do not have, "
                              "expected a \"bitmap\" or a \"checkerboard\"");
}

void SceneReader::read_projector(Properties &properties, Emitter &emitter) {
    emitter.kind = EmitterKind::projector;
    emitter.radiance = read_colour(properties, "irradiance", SpectrumUse::emission);
    if (emitter.radiance == none)
        throw InputError(properties.where(),
                         properties.description() + " has no \"irradiance\", expected a texture");
    check_projected(properties, "irradiance", emitter.radiance);
    emitter.scale = read_emitter_scale(properties);
    emitter.to_world = properties.transform("to_world");
    const FieldOfView field = read_field_of_view(properties);
    emitter.fov = field.degrees;
    emitter.fov_axis = field.axis;
}

} // namespace clrender::mitsuba
