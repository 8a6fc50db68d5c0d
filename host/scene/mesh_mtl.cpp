#include "mesh_mtl.h"

#include "obj_lines.h"

#define TINYOBJLOADER_USE_DOUBLE
#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <istream>
#include <map>

namespace clrender {

namespace {

/// Checks the lines we use and hides all others from the parser. `has_color` gets one entry for
/// each material: whether a colour that makes it visible is stated.
std::string check_mtl_line(std::string &line, std::vector<bool> &has_color) {
    constexpr std::array<std::string_view, 9> numeric = {"Kd", "Ks", "Ke", "Kt",   "Tf",
                                                         "Ni", "d",  "Tr", "illum"};
    const auto words = split_words(line);
    if (words[0] == "newmtl") {
        has_color.push_back(false);
        return words.size() < 2 ? "newmtl without a name" : "";
    }
    if (words[0] == "map_Kd") {
        std::replace(line.begin(), line.end(), '\\', '/');
        if (!has_color.empty())
            has_color.back() = true;
        return words.size() < 2 ? "map_Kd without a file name" : "";
    }
    if (std::find(numeric.begin(), numeric.end(), words[0]) == numeric.end()) {
        line.clear();
        return {};
    }

    // Colours have three numbers, or one that stands for all three.
    if (words.size() < 2)
        return std::string(words[0]) + " without a value, expected a number";
    for (std::size_t i = 1; i < words.size(); ++i)
        if (std::string reason = check_number(words[i]); !reason.empty())
            return reason;
    if (words[0].starts_with('K') && !has_color.empty())
        has_color.back() = true;
    if (words.size() == 2 && (words[0][0] == 'K' || words[0] == "Tf"))
        line = std::string(words[0]) + " " + std::string(words[1]) + " " + std::string(words[1]) +
               " " + std::string(words[1]);
    return {};
}

ObjMaterial convert(const tinyobj::material_t &source, bool has_color,
                    const std::filesystem::path &folder) {
    const auto color = [](const double(&c)[3]) { return Rgb(c[0], c[1], c[2]); };
    ObjMaterial material;
    material.name = source.name.substr(0, source.name.find_last_not_of(" \t") + 1);
    if (has_color)
        material.diffuse = color(source.diffuse);
    if (!source.diffuse_texname.empty())
        material.diffuse_map = (folder / source.diffuse_texname).string();
    material.specular = color(source.specular);
    material.emission = color(source.emission);
    material.transmittance = color(source.transmittance);
    material.ior = source.ior;
    material.dissolve = source.dissolve;
    material.illum = source.illum;
    return material;
}

} // namespace

std::vector<ObjMaterial> read_mtl(const std::string &path, const SourceLocation &referrer) {
    std::vector<bool> has_color;
    ObjLines lines(path, referrer,
                   [&](std::string &line) { return check_mtl_line(line, has_color); });
    std::istream stream(&lines);
    stream.exceptions(std::ios::badbit);

    std::map<std::string, int> indices;
    std::vector<tinyobj::material_t> parsed;
    std::string warning, error;
    tinyobj::LoadMtl(&indices, &parsed, &stream, &warning, &error);

    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    std::vector<ObjMaterial> materials;
    for (std::size_t i = 0; i < std::min(parsed.size(), has_color.size()); ++i)
        materials.push_back(convert(parsed[i], has_color[i], folder));
    return materials;
}

} // namespace clrender
