#include "model_scene.h"

#include "../log.h"
#include "mesh_attributes.h"
#include "mesh_io.h"
#include "model_surroundings.h"
#include "scene_files.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fmt/core.h>
#include <limits>
#include <map>
#include <utility>
#include <vector>

namespace clrender {

namespace {

/// Textures that may turn out not to be readable, and the colour that then takes their place.
using TextureColors = std::vector<std::pair<int, Rgb>>;

/// A colour of a material, which reflects all light at most.
Rgb reflectance(const ObjMaterial &material, const Rgb &colour) {
    const Rgb held = glm::clamp(colour, 0.0, 1.0);
    if (held != colour)
        log::warn(fmt::format("material \"{}\": its colour {:g} {:g} {:g} is held to 0 to 1",
                              material.name, colour.r, colour.g, colour.b));
    return held;
}

/// Makes BSDFs of the materials of an MTL file.
class MaterialMaker {
public:
    MaterialMaker(Scene &scene, SceneFiles &files, TextureColors &colors)
        : scene_(scene), files_(files), colors_(colors) {}

    /// The index of the BSDF; a new one for each call.
    int add(const ObjMaterial &material) {
        switch (surface_of(material)) {
        case ObjSurface::glass: {
            const double ior = material.ior.value_or(1.5);
            return add_named(material, DielectricBsdf{{ior > 1 ? ior : 1.5, 1}});
        }
        case ObjSurface::mirror:
            return add_named(material, ConductorBsdf{add_color(
                                           scene_, reflectance(material, material.specular))});
        case ObjSurface::rough_metal:
            return add_opaque(material, rough_metal(material));
        case ObjSurface::glossy:
            return add_opaque(material, glossy(material));
        case ObjSurface::principled:
            return add_opaque(material, principled(material));
        case ObjSurface::diffuse:
            break;
        }
        return add_opaque(material, DiffuseBsdf{diffuse(material)});
    }

private:
    int add_named(const ObjMaterial &material, const BsdfModel &model) {
        return add_bsdf(scene_, {model, material.name, {}});
    }

    /// A surface with its normals, on both sides, where the material is not cut out.
    int add_opaque(const ObjMaterial &material, const BsdfModel &model) {
        int side = add_named(material, model);
        if (material.normal_map.is_there())
            side = add_bsdf(
                scene_, {NormalMapBsdf{map(material.normal_map, Rgb(0.5, 0.5, 1), true), {}, side},
                         {},
                         {}});
        else if (material.bump_map.is_there())
            side = add_bsdf(
                scene_,
                {BumpMapBsdf{number(material.bump_map, 0), material.bump_map.scale, {}, side},
                 {},
                 {}});
        const int both = add_bsdf(scene_, {TwosidedBsdf{side, side}, {}, {}});
        if (material.opacity_map.is_there())
            return add_bsdf(
                scene_, {MaskBsdf{number(material.opacity_map, material.dissolve), both}, {}, {}});
        if (material.dissolve >= 1)
            return both;
        const double opacity = std::max(material.dissolve, 0.0);
        return add_bsdf(scene_, {MaskBsdf{add_color(scene_, Rgb(opacity)), both}, {}, {}});
    }

    /// Kd, or the texture in its place.
    int diffuse(const ObjMaterial &material) {
        const Rgb colour = reflectance(material, material.diffuse);
        return material.diffuse_map.is_there() ? map(material.diffuse_map, colour, false)
                                               : add_color(scene_, colour);
    }

    /// A texture, or `colour` where it cannot be read. Data are linear.
    int map(const ObjMap &source, const Rgb &colour, bool is_data) {
        Texture texture;
        texture.kind = TextureKind::bitmap;
        texture.to_uv = source.to_uv;
        texture.format.raw = is_data;
        texture.wrap = source.is_clamped ? TextureWrap::clamp : TextureWrap::repeat;
        texture.bitmap =
            files_.image(source.file, source.where, {.raw = is_data, .is_optional = true});
        scene_.textures.push_back(std::move(texture));
        const int index = static_cast<int>(scene_.textures.size()) - 1;
        colors_.emplace_back(index, colour);
        return index;
    }

    int number(const ObjMap &source, double value) {
        const int index = map(source, Rgb(value), true);
        scene_.textures.back().is_number = true;
        return index;
    }

    int number(const ObjMap &source, const std::optional<double> &value, double fallback) {
        const double constant = std::clamp(value.value_or(fallback), 0.0, 1.0);
        return source.is_there() ? number(source, constant) : add_color(scene_, Rgb(constant));
    }

    /// The roughness that resembles Phong's exponent (Walter et al. 2007, section 5.4).
    static double alpha(const ObjMaterial &material) {
        return std::sqrt(2 / (std::max(material.exponent.value_or(0), 0.0) + 2));
    }

    BsdfModel rough_metal(const ObjMaterial &material) {
        RoughConductorBsdf bsdf;
        bsdf.microfacets.alpha_u = bsdf.microfacets.alpha_v =
            add_color(scene_, Rgb(alpha(material)));
        bsdf.specular_reflectance = add_color(scene_, reflectance(material, material.specular));
        return bsdf;
    }

    /// A boundary that reflects .08 Ks straight on, as modelling programs export their dielectrics.
    BsdfModel glossy(const ObjMaterial &material) {
        const Rgb specular = reflectance(material, material.specular);
        const double strength = std::max({specular.r, specular.g, specular.b});
        RoughPlasticBsdf bsdf;
        const double root = std::sqrt(0.08 * strength);
        bsdf.plastic.ior = {(1 + root) / (1 - root), 1};
        bsdf.plastic.diffuse_reflectance = diffuse(material);
        bsdf.plastic.specular_reflectance = add_color(scene_, specular / strength);
        bsdf.alpha = alpha(material);
        return bsdf;
    }

    BsdfModel principled(const ObjMaterial &material) {
        PrincipledBsdf bsdf;
        bsdf.base_color = diffuse(material);
        bsdf.roughness = number(material.roughness_map, material.roughness,
                                material.exponent ? std::sqrt(alpha(material)) : 0.5);
        bsdf.metallic = number(material.metallic_map, material.metallic, 0);
        bsdf.sheen = number(material.sheen_map, material.sheen, 0);
        bsdf.anisotropic = number({}, material.anisotropy, 0);
        bsdf.clearcoat = number({}, material.clearcoat, 0);
        bsdf.clearcoat_gloss = number({}, 1 - material.clearcoat_roughness.value_or(0), 1);
        bsdf.spec_tint = bsdf.sheen_tint = bsdf.flatness = add_color(scene_, Rgb(0));
        bsdf.eta = material.ior && *material.ior > 1 ? *material.ior : 1.5;
        return bsdf;
    }

    Scene &scene_;
    SceneFiles &files_;
    TextureColors &colors_;
};

/// Gives textures without a picture a plain colour.
void replace_missing(Scene &scene, const TextureColors &colors) {
    for (const auto &[index, color] : colors) {
        Texture &texture = scene.textures[static_cast<std::size_t>(index)];
        if (texture.bitmap->width > 0)
            continue;
        const bool is_number = texture.is_number;
        texture = Texture();
        texture.is_number = is_number;
        texture.value = color;
    }
}

/// The attribute that a bare model is coloured by, with its colours made linear; null for none.
const MeshAttribute *colors_of(Mesh &mesh) {
    for (const char *name : {"vertex_color", "face_color"})
        for (MeshAttribute &attribute : mesh.attributes)
            if (attribute.name == name && attribute.channels == 3 && !attribute.values.empty()) {
                decode_colors(attribute);
                return &attribute;
            }
    return nullptr;
}

/// Shows the colours of a mesh on a shape without material.
void show_colors(Scene &scene, const MeshAttribute &colors, Shape &shape) {
    Texture texture;
    texture.kind = TextureKind::attribute;
    texture.attribute = colors.name;
    const int index = static_cast<int>(scene.textures.size());
    scene.textures.push_back(std::move(texture));
    shape.attribute_textures.push_back(index);
    shape.bsdf = add_diffuse(scene, index);
}

void add_model(Scene &scene, ObjFile &model) {
    SceneFiles files;
    TextureColors colors;
    std::map<std::string, const ObjMaterial *> materials;
    for (const ObjMaterial &material : model.materials)
        materials.try_emplace(material.name, &material);

    MaterialMaker maker(scene, files, colors);
    std::map<std::string, int> bsdfs;
    const int default_bsdf = add_diffuse(scene, add_color(scene, Rgb(0.7, 0.66, 0.6)));
    for (ObjPart &part : model.parts) {
        const auto found = materials.find(part.material);
        const ObjMaterial *material = found == materials.end() ? nullptr : found->second;
        if (material != nullptr && bsdfs.count(part.material) == 0)
            bsdfs[part.material] = maker.add(*material);
        Shape &shape = add_shape(scene, ShapeKind::mesh, glm::dmat4(1.0),
                                 material ? bsdfs[part.material] : default_bsdf);
        if (const MeshAttribute *colors = material == nullptr ? colors_of(part.mesh) : nullptr)
            show_colors(scene, *colors, shape);
        shape.mesh = std::make_shared<const Mesh>(std::move(part.mesh));
        shape.id = part.material;
        if (material != nullptr &&
            std::max({material->emission.r, material->emission.g, material->emission.b}) > 0)
            add_area_light(scene, add_color(scene, glm::max(material->emission, 0.0)));
    }
    files.read();
    replace_missing(scene, colors);
}

} // namespace

Scene load_model(const std::string &path) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    ObjFile model;
    if (extension == ".ply")
        model.parts.push_back(
            {"", read_ply_mesh(path, {.attributes = {"vertex_color", "face_color"}})});
    else
        model = read_obj_file(path);

    Scene scene;
    scene.name = std::filesystem::path(path).stem().string();
    scene.film.crop_width = scene.film.width;
    scene.film.crop_height = scene.film.height;
    scene.integrator.max_depth = 8;
    scene.sample_count = 64;
    add_model(scene, model);
    const ModelBounds bounds = bounds_of_meshes(scene);
    add_ground(scene, bounds);
    add_lights(scene, bounds);
    add_camera(scene, bounds);
    return scene;
}

} // namespace clrender
