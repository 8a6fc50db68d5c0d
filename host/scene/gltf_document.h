#pragma once
/// A .gltf or .glb file, parsed and with its buffers in memory, before anything is made of it.

#include "../error.h"

#include "gltf_tiny.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace clrender::gltf {

/// An image of the file: encoded bytes in a buffer view or out of a data URI, or a file.
struct ImageSource {
    std::string file;     ///< path of a file, or ""
    std::string data;     ///< bytes of a data URI, where there is no file
    int buffer_view = -1; ///< the view that holds the bytes, or -1
    [[nodiscard]] bool is_there() const {
        return !file.empty() || !data.empty() || buffer_view >= 0;
    }
};

/// `model` is what tinygltf has read of the JSON text, which was checked before and had buffers,
/// images, animations and extras taken out: tinygltf opens no file and decodes nothing. Indices,
/// offsets and counts in it are unchecked.
struct Document {
    std::string path;
    tinygltf::Model model;
    std::vector<std::string> buffers; ///< bytes, each as long as the file states
    std::vector<ImageSource> images;
    bool has_animations = false;

    /// The error that the file is wrong at `place`, such as "accessors[3]".
    [[nodiscard]] InputError error(const std::string &place, const std::string &what) const {
        return {{path, 0}, place.empty() ? what : place + ": " + what};
    }
    void warn(const std::string &place, const std::string &what) const;

    /// Bytes of a buffer view. Throws InputError at `place` where it is not there.
    [[nodiscard]] std::string_view view(int index, const std::string &place) const;
};

/// Reads a file and those that it names, with escaped URIs and data URIs. Refuses what the standard
/// (glTF 2.0) forbids so far as it is looked at here, extensions that are required and not known,
/// and what does not fit into memory; warns of extensions that are ignored. Throws InputError.
Document read_document(const std::string &path);

/// `list[index]`, which is checked. Throws InputError at `place`.
template <typename T>
const T &element(const Document &document, const std::vector<T> &list, int index,
                 const std::string &name, const std::string &place) {
    if (index < 0 || static_cast<std::size_t>(index) >= list.size())
        throw document.error(place, "names " + name + " " + std::to_string(index) + ", of " +
                                        std::to_string(list.size()) + " that the file has");
    return list[static_cast<std::size_t>(index)];
}

/// `name[index]`, as errors name a place.
inline std::string place_of(const std::string &name, int index) {
    return name + "[" + std::to_string(index) + "]";
}

} // namespace clrender::gltf
