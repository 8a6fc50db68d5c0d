#include "gltf_material.h"

#include "scene/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace clrender::gltf {

namespace {

using tinygltf::ExtensionMap;
using tinygltf::Value;

/// The members of an extension; all of them may be absent.
class Members {
public:
    Members(const Document &document, const Value *object, std::string place)
        : document_(document), object_(object), place_(std::move(place)) {}

    [[nodiscard]] bool is_there() const { return object_ != nullptr; }
    [[nodiscard]] const std::string &place() const { return place_; }

    [[nodiscard]] const Value *find(const char *name) const {
        return object_ != nullptr && object_->IsObject() && object_->Has(name) ? &object_->Get(name)
                                                                               : nullptr;
    }

    [[nodiscard]] double number(const char *name, double fallback, double least,
                                double most) const {
        const Value *value = find(name);
        if (value == nullptr)
            return fallback;
        if (!value->IsNumber())
            throw document_.error(place_, std::string(name) + " is no number");
        return in_range(name, value->GetNumberAsDouble(), least, most);
    }

    [[nodiscard]] Rgb color(const char *name, const Rgb &fallback, double most) const {
        const Value *value = find(name);
        if (value == nullptr)
            return fallback;
        Rgb color;
        if (!value->IsArray() || value->ArrayLen() != 3)
            throw document_.error(place_, std::string(name) + " is no array of three numbers");
        for (std::size_t c = 0; c < 3; ++c) {
            const Value &channel = value->Get(static_cast<int>(c));
            if (!channel.IsNumber())
                throw document_.error(place_, std::string(name) + " is no array of three numbers");
            color[static_cast<int>(c)] = in_range(name, channel.GetNumberAsDouble(), 0, most);
        }
        return color;
    }

    /// A number of a whole, or `fallback` where there is none.
    [[nodiscard]] int integer(const char *name, int fallback) const {
        const Value *value = find(name);
        return value != nullptr && value->IsInt() ? value->GetNumberAsInt() : fallback;
    }

    double in_range(const char *name, double value, double least, double most) const {
        if (!(value >= least && value <= most))
            throw document_.error(place_, fmt::format("{} is {:g}, expected a number from {:g} to "
                                                      "{:g}",
                                                      name, value, least, most));
        return value;
    }

private:
    const Document &document_;
    const Value *object_;
    std::string place_;
};

Members extension(const Document &document, const ExtensionMap &extensions, const std::string &name,
                  const std::string &place) {
    const auto found = extensions.find(name);
    return {document, found == extensions.end() ? nullptr : &found->second, place + "." + name};
}

/// Two numbers of a texture transform.
glm::dvec2 pair_of(const Document &document, const Members &members, const char *name,
                   double fallback) {
    const Value *value = members.find(name);
    if (value == nullptr)
        return glm::dvec2(fallback);
    if (!value->IsArray() || value->ArrayLen() != 2 || !value->Get(0).IsNumber() ||
        !value->Get(1).IsNumber())
        throw document.error(members.place(), std::string(name) + " is no array of two numbers");
    return {value->Get(0).GetNumberAsDouble(), value->Get(1).GetNumberAsDouble()};
}

/// Adds KHR_texture_transform: scale, then rotation, then offset.
void apply_transform(const Document &document, const Members &transform, TextureUse &use) {
    if (!transform.is_there())
        return;
    constexpr double most = 1e6;
    const glm::dvec2 offset = pair_of(document, transform, "offset", 0);
    const glm::dvec2 scale = pair_of(document, transform, "scale", 1);
    const double angle = transform.number("rotation", 0, -most, most);
    for (const double value : {offset.x, offset.y, scale.x, scale.y})
        (void)transform.in_range("offset or scale", value, -most, most);
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    use.to_uv = glm::dmat3({c * scale.x, -s * scale.x, 0}, {s * scale.y, c * scale.y, 0},
                           {offset.x, offset.y, 1});
    use.set = transform.integer("texCoord", use.set);
}

TextureUse texture_use(const Document &document, int index, int set, const ExtensionMap &extensions,
                       const std::string &place) {
    TextureUse use;
    if (index < 0)
        return use;
    (void)element(document, document.model.textures, index, "texture", place);
    use.texture = index;
    use.set = set;
    apply_transform(document, extension(document, extensions, "KHR_texture_transform", place), use);
    if (use.set < 0)
        throw document.error(place, fmt::format("texCoord is {}, expected at least 0", use.set));
    return use;
}

/// A texture of an extension, which tinygltf keeps as it stands.
TextureUse texture_use(const Document &document, const Members &members, const char *name) {
    const Value *info = members.find(name);
    if (info == nullptr)
        return {};
    const std::string place = members.place() + "." + name;
    const Members own(document, info, place);
    const int index = own.integer("index", -1);
    TextureUse use = texture_use(document, index, own.integer("texCoord", 0), {}, place);
    if (index < 0)
        throw document.error(place, "has no index, expected that of a texture");
    if (const Value *extensions = own.find("extensions");
        extensions != nullptr && extensions->IsObject() && extensions->Has("KHR_texture_transform"))
        apply_transform(document,
                        Members(document, &extensions->Get("KHR_texture_transform"), place), use);
    return use;
}

void read_transmission(const Document &document, const ExtensionMap &extensions,
                       Material &material) {
    const Members transmission =
        extension(document, extensions, "KHR_materials_transmission", material.place);
    material.transmission = transmission.number("transmissionFactor", 0, 0, 1);
    material.transmission_texture = texture_use(document, transmission, "transmissionTexture");

    const Members volume = extension(document, extensions, "KHR_materials_volume", material.place);
    material.thickness = volume.number("thicknessFactor", 0, 0, max_radiance);
    material.attenuation_color = volume.color("attenuationColor", Rgb(1), 1);
    material.attenuation_distance =
        volume.number("attenuationDistance", 0, 0, std::numeric_limits<double>::max());
    if (volume.find("thicknessTexture") != nullptr)
        document.warn(volume.place(), "thicknessTexture is ignored: light finds the thickness of "
                                      "the mesh itself");

    const Members ior = extension(document, extensions, "KHR_materials_ior", material.place);
    material.ior = ior.number("ior", 1.5, 0, 100);
    if (material.ior != 0 && material.ior < 1)
        throw document.error(ior.place(),
                             fmt::format("ior is {:g}, expected 0 or at least 1", material.ior));
    if (material.ior == 0) {
        document.warn(ior.place(), "ior 0, a mirror's reflectance over a dielectric, is not "
                                   "supported, 1.5 is taken");
        material.ior = 1.5;
    }
}

void read_coats(const Document &document, const ExtensionMap &extensions, Material &material) {
    const Members specular =
        extension(document, extensions, "KHR_materials_specular", material.place);
    material.specular = specular.number("specularFactor", 1, 0, 1);
    material.specular_color = specular.color("specularColorFactor", Rgb(1), max_radiance);
    if (specular.find("specularTexture") != nullptr ||
        specular.find("specularColorTexture") != nullptr)
        document.warn(specular.place(), "textures are ignored, its factors hold everywhere");

    const Members coat = extension(document, extensions, "KHR_materials_clearcoat", material.place);
    material.clearcoat = coat.number("clearcoatFactor", 0, 0, 1);
    material.clearcoat_texture = texture_use(document, coat, "clearcoatTexture");
    material.clearcoat_roughness = coat.number("clearcoatRoughnessFactor", 0, 0, 1);
    if (coat.find("clearcoatRoughnessTexture") != nullptr)
        document.warn(coat.place(), "clearcoatRoughnessTexture is ignored, its factor holds "
                                    "everywhere");
    if (coat.find("clearcoatNormalTexture") != nullptr)
        document.warn(coat.place(), "clearcoatNormalTexture is ignored: the coat has the normals "
                                    "of what is below");

    const Members sheen = extension(document, extensions, "KHR_materials_sheen", material.place);
    material.sheen = sheen.color("sheenColorFactor", Rgb(0), 1);
    if (sheen.find("sheenColorTexture") != nullptr ||
        sheen.find("sheenRoughnessTexture") != nullptr)
        document.warn(sheen.place(), "textures are ignored, its colour holds everywhere");
}

AlphaMode alpha_mode_of(const Document &document, const std::string &mode,
                        const std::string &place) {
    if (mode == "OPAQUE")
        return AlphaMode::opaque;
    if (mode == "MASK")
        return AlphaMode::mask;
    if (mode == "BLEND")
        return AlphaMode::blend;
    throw document.error(place,
                         "alphaMode " + mode.substr(0, 40) + ", expected OPAQUE, MASK or BLEND");
}

/// A factor of the standard, from 0 to 1.
double share(const Document &document, const char *name, double value, const std::string &place) {
    return Members(document, nullptr, place).in_range(name, value, 0, 1);
}

} // namespace

Material read_material(const Document &document, int index) {
    Material material;
    material.place = "the default material";
    if (index < 0)
        return material;
    material.place = place_of("materials", index);
    const std::string &place = material.place;
    const tinygltf::Material &source =
        element(document, document.model.materials, index, "material", place);
    material.name = source.name;
    const tinygltf::PbrMetallicRoughness &pbr = source.pbrMetallicRoughness;
    for (std::size_t c = 0; c < 3; ++c) {
        material.base[static_cast<int>(c)] =
            share(document, "baseColorFactor", pbr.baseColorFactor.at(c), place);
        material.emission[static_cast<int>(c)] =
            share(document, "emissiveFactor", source.emissiveFactor.at(c), place);
    }
    material.alpha = share(document, "baseColorFactor", pbr.baseColorFactor.at(3), place);
    material.metallic = share(document, "metallicFactor", pbr.metallicFactor, place);
    material.roughness = share(document, "roughnessFactor", pbr.roughnessFactor, place);
    const auto use = [&](const auto &info, const char *name) {
        return texture_use(document, info.index, info.texCoord, info.extensions,
                           place + "." + name);
    };
    material.base_texture = use(pbr.baseColorTexture, "baseColorTexture");
    material.metallic_roughness = use(pbr.metallicRoughnessTexture, "metallicRoughnessTexture");
    material.normal = use(source.normalTexture, "normalTexture");
    material.normal_scale =
        Members(document, nullptr, place).in_range("scale", source.normalTexture.scale, -1e3, 1e3);
    material.emission_texture = use(source.emissiveTexture, "emissiveTexture");
    material.alpha_mode = alpha_mode_of(document, source.alphaMode, place);
    material.cutoff = Members(document, nullptr, place)
                          .in_range("alphaCutoff", source.alphaCutoff, 0, max_radiance);
    if (source.occlusionTexture.index >= 0)
        document.warn(place, "occlusionTexture is ignored: light finds what covers a surface");

    material.is_unlit =
        extension(document, source.extensions, "KHR_materials_unlit", place).is_there();
    material.emission *=
        extension(document, source.extensions, "KHR_materials_emissive_strength", place)
            .number("emissiveStrength", 1, 0, max_radiance);
    read_transmission(document, source.extensions, material);
    read_coats(document, source.extensions, material);
    return material;
}

} // namespace clrender::gltf
