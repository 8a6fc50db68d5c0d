#pragma once
/// Materials as a glTF file states them, with their extensions, checked.

#include "gltf_document.h"
#include "scene.h"

#include <string>

namespace clrender::gltf {

/// A texture in its place: KHR_texture_transform has been applied.
struct TextureUse {
    int texture = -1; ///< index into Model::textures, -1 for none
    int set = 0;      ///< TEXCOORD_<set>
    glm::dmat3 to_uv{1.0};

    [[nodiscard]] bool is_there() const { return texture >= 0; }
};

enum class AlphaMode { opaque, mask, blend };

/// Numbers and colours are linear; each texture multiplies what stands before it.
struct Material {
    std::string name;
    std::string place; ///< as errors name it
    Rgb base{1.0};
    double alpha = 1;
    TextureUse base_texture; ///< sRGB, with alpha
    double metallic = 1, roughness = 1;
    TextureUse metallic_roughness; ///< blue: metallic, green: roughness
    TextureUse normal;
    double normal_scale = 1;
    Rgb emission{0.0}; ///< with KHR_materials_emissive_strength
    TextureUse emission_texture;
    AlphaMode alpha_mode = AlphaMode::opaque;
    double cutoff = 0.5;
    bool is_unlit = false;
    double transmission = 0;
    TextureUse transmission_texture; ///< red
    double ior = 1.5;
    double specular = 1;
    Rgb specular_color{1.0};
    double clearcoat = 0, clearcoat_roughness = 0;
    TextureUse clearcoat_texture; ///< red
    Rgb sheen{0.0};
    double thickness = 0; ///< above 0: the surface bounds a volume
    Rgb attenuation_color{1.0};
    double attenuation_distance = 0; ///< 0: nothing is absorbed
};

/// Material `index`; the standard's default for -1. Warns of what is ignored. Throws InputError.
Material read_material(const Document &document, int index);

} // namespace clrender::gltf
