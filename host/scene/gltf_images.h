#pragma once
/// The pictures of a glTF file, decoded by the project's own readers.

#include "gltf_document.h"
#include "gltf_material.h"
#include "scene_files.h"

#include <map>
#include <memory>
#include <tuple>
#include <utility>

namespace clrender::gltf {

class Images {
public:
    explicit Images(const Document &document) : document_(document) {}

    /// Notes what a material shows.
    void want(const Material &material);

    /// Reads all that has been noted, side by side. What cannot be read is warned of.
    void read() { files_.read(); }

    /// The picture of a texture that has been read; null where there is none. The values of one
    /// with 16 bits are linear if `raw`, else they are decoded from sRGB.
    [[nodiscard]] std::shared_ptr<const Image> get(int texture, bool raw) const;

    /// Its alpha as a grey picture; null where it is 1 everywhere.
    std::shared_ptr<const Image> alpha(int texture);

    /// A normal map, with x and y multiplied with `scale`, and y mirrored if `flips`.
    std::shared_ptr<const Image> normals(int texture, double scale, bool flips);

private:
    void want(const TextureUse &use, bool raw);
    [[nodiscard]] int source_of(int texture) const;
    void claim(const Image &image, std::size_t bytes_per_pixel) const;

    const Document &document_;
    SceneFiles files_;
    std::map<std::pair<int, bool>, std::shared_ptr<const Image>> images_;
    std::map<int, std::shared_ptr<const Image>> alphas_;
    std::map<std::tuple<int, double, bool>, std::shared_ptr<const Image>> normals_;
};

} // namespace clrender::gltf
