#pragma once
/// The meshes and images that a scene names, each read once.

#include "file_reads.h"
#include "mesh_io.h"
#include "scene.h"

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace clrender {

enum class MeshFormat { obj, ply, serialized };

struct ImageUse {
    bool raw = false;         ///< 16-bit values are linear, else they are decoded from sRGB
    bool is_light = false;    ///< no value may be negative
    bool is_optional = false; ///< if it cannot be read, this is warned of and the image is empty
};

class SceneFiles {
public:
    /// What these return is empty until `read`. `where` is the line that names the file.
    std::shared_ptr<const Image> image(const std::string &path, const SourceLocation &where,
                                       const ImageUse &use);
    /// An image whose encoded bytes lie in memory until `read`, under a name of their own.
    std::shared_ptr<const Image> image_in_memory(std::string_view bytes, const std::string &name,
                                                 const SourceLocation &where, const ImageUse &use);
    std::shared_ptr<const Mesh> mesh(MeshFormat format, const std::string &path,
                                     const MeshReadOptions &options, const SourceLocation &where);

    /// Meshes are read with the attributes of this name.
    void want_attribute(const std::string &name) { attributes_.insert(name); }

    /// Notes what has to hold of the files; `check` is run when they have been read.
    void then(std::function<void()> check);

    /// Reads all that has been asked for since. Images have only finite values, and negative ones
    /// only where a reflectance lies outside of sRGB; what had to be replaced is warned of. Throws
    /// InputError, of the file that was asked for first if several are bad, or of all.
    void read(bool all_faults = false);

private:
    static void read_into(Image &image, const std::function<Image()> &reader,
                          const std::string &path, const SourceLocation &where,
                          const ImageUse &use);
    std::shared_ptr<const Image> image(const std::function<Image()> &reader,
                                       const std::string &path, const SourceLocation &where,
                                       const ImageUse &use);

    FileReads reads_;
    std::set<std::string> attributes_;
    std::vector<std::function<void()>> checks_;
    std::map<std::tuple<std::string, bool, bool, bool>, std::shared_ptr<const Image>> images_;
    std::map<std::tuple<std::string, MeshFormat, bool, bool, int>, std::shared_ptr<const Mesh>>
        meshes_;
};

} // namespace clrender
