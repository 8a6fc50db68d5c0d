#pragma once
/// The readers of untrusted files as libFuzzer and the replay of its findings call them.

#include <string>
#include <string_view>
#include <vector>

namespace clrender::fuzz {

/// A reader that takes the bytes of a file.
struct Reader {
    std::string name;      ///< of the fuzz target and of the folder in tests/fuzz/corpus
    std::string extension; ///< of the file that it reads
    void (*read)(const std::string &path);
};

/// All of them.
const std::vector<Reader> &readers();

/// Gives `bytes` to a reader, in a folder of its own. Returns normally if they are read or are
/// refused by an InputError of one line; what else happens escapes. The scene and the model
/// readers go on to the arrays of the device. An OBJ file may be followed by `mtl_mark` and the
/// MTL file `model.mtl`.
void read_bytes(const Reader &reader, std::string_view bytes);

inline constexpr std::string_view mtl_mark = "\n%%mtl\n";

} // namespace clrender::fuzz
