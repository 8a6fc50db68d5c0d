#pragma once
/// BSDFs and lights of the materials of a glTF file.

#include "gltf_images.h"
#include "gltf_material.h"
#include "scene.h"

#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace clrender::gltf {

/// Names of the attributes that a mesh has for its surface.
inline const std::string color_attribute = "vertex_color";
inline const std::string alpha_attribute = "vertex_alpha";
std::string coordinates_attribute(int set);

/// What a primitive has that its surface depends on.
struct SurfaceNeeds {
    int material = -1;
    bool has_colors = false, has_alphas = false; ///< COLOR_0
    bool flips_normals = false; ///< (u, v) are mirrored: the y axis of a normal map turns over

    bool operator<(const SurfaceNeeds &o) const {
        return std::tie(material, has_colors, has_alphas, flips_normals) <
               std::tie(o.material, o.has_colors, o.has_alphas, o.flips_normals);
    }
};

/// What a shape gets of its material.
struct Surface {
    int bsdf = none;
    int radiance = none; ///< a texture, of what shines
    bool has_normal_map = false;
    int set = 0;                         ///< TEXCOORD_<set> is (u, v)
    std::set<int> sets;                  ///< all that textures ask for
    std::vector<int> attribute_textures; ///< as Shape has them
};

/// Makes the BSDFs and textures of a scene. Both sides of a surface are alike where light does not
/// pass through. What the BSDFs cannot carry is warned of, once.
class SurfaceMaker {
public:
    SurfaceMaker(const Document &document, Images &images, Scene &scene)
        : document_(document), images_(images), scene_(scene) {}

    const Material &material(int index);
    const Surface &surface(const SurfaceNeeds &needs);

private:
    struct Work; ///< one surface that is being made

    int add(const BsdfModel &model, const std::string &id = {});
    int add(Texture texture);
    int constant(const Rgb &value);
    int number(double value);
    int bitmap(Work &work, const TextureUse &use, std::shared_ptr<const Image> image, bool raw,
               const Rgb &scale, const std::string &product);
    int base_color(Work &work, const Rgb &scale);
    int channel(Work &work, const TextureUse &use, int channel, double factor);
    int opacity(Work &work);
    int turned(Work &work, int bsdf);
    int opaque(Work &work, double metallic);
    int principled(Work &work, const PrincipledBsdf &bsdf);
    PrincipledBsdf principled_of(Work &work);
    int transmitting(Work &work);
    int thin(Work &work);
    int solid(Work &work);
    int emission(Work &work);
    void choose_sets(Work &work) const;

    const Document &document_;
    Images &images_;
    Scene &scene_;
    std::map<int, Material> materials_;
    std::map<SurfaceNeeds, Surface> surfaces_;
};

} // namespace clrender::gltf
