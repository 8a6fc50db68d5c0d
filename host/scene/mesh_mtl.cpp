#include "mesh_mtl.h"

#include "../image/color.h"
#include "../log.h"
#include "mtl_map.h"
#include "obj_lines.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <istream>
#include <map>
#include <optional>

namespace clrender {

namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string_view>;

bool is_file(const fs::path &path) {
    std::error_code ignored;
    return fs::is_regular_file(path, ignored);
}

std::string lower(std::string_view text) {
    std::string result(text);
    std::transform(result.begin(), result.end(), result.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return result;
}

double brightest(const Rgb &color) {
    return std::max({color.r, color.g, color.b});
}

/// A statement that names a texture, and what the material has where that is not there.
struct MapStatement {
    ObjMap ObjMaterial::*member;
    std::string without;
};

const std::map<std::string, MapStatement> &maps() {
    static const std::map<std::string, MapStatement> all{
        {"map_kd", {&ObjMaterial::diffuse_map, "its plain colour"}},
        {"map_d", {&ObjMaterial::opacity_map, "no holes"}},
        {"norm", {&ObjMaterial::normal_map, "smooth normals"}},
        {"map_bump", {&ObjMaterial::bump_map, "no bumps"}},
        {"bump", {&ObjMaterial::bump_map, "no bumps"}},
        {"map_pr", {&ObjMaterial::roughness_map, "one roughness"}},
        {"map_pm", {&ObjMaterial::metallic_map, "one share of metal"}},
        {"map_ps", {&ObjMaterial::sheen_map, "one sheen"}}};
    return all;
}

const std::map<std::string, std::optional<double> ObjMaterial::*> &numbers() {
    static const std::map<std::string, std::optional<double> ObjMaterial::*> all{
        {"ns", &ObjMaterial::exponent},
        {"ni", &ObjMaterial::ior},
        {"pr", &ObjMaterial::roughness},
        {"pm", &ObjMaterial::metallic},
        {"ps", &ObjMaterial::sheen},
        {"pc", &ObjMaterial::clearcoat},
        {"pcr", &ObjMaterial::clearcoat_roughness},
        {"aniso", &ObjMaterial::anisotropy}};
    return all;
}

/// Takes the lines of an MTL file one after the other; keywords count in any case.
class MtlReader {
public:
    explicit MtlReader(const std::string &path, const SourceLocation &referrer)
        : folder_(fs::path(path).parent_path()),
          lines_(path, referrer, [this](std::string &line) { return take(line); }) {}

    std::vector<ObjMaterial> read();

private:
    std::string take(std::string &line);
    std::string take_statement(const std::string &keyword, const Words &words);
    std::string take_color(const std::string &keyword, const Words &words);
    std::string take_number(const std::string &keyword, const Words &words);
    std::string take_map(const Words &words, ObjMap &target, const std::string &without);
    void begin_material(const std::string &name);
    void end_material();
    void ignore(const std::string &what);
    void warn_of_ignored() const;

    fs::path folder_;
    ObjLines lines_;
    std::vector<ObjMaterial> materials_;
    std::vector<std::string> ignored_; ///< in the order of the file, each once
    SourceLocation where_ignored_;

    // Of the material at hand.
    bool has_diffuse_ = false, has_other_color_ = false, has_dissolve_ = false;
    std::optional<Rgb> transmittance_;
};

std::vector<ObjMaterial> MtlReader::read() {
    // All lines are emptied once they are taken: the stream itself has no content.
    std::istream stream(&lines_);
    stream.exceptions(std::ios::badbit);
    (void)stream.peek();
    end_material();
    warn_of_ignored();
    return std::move(materials_);
}

std::string MtlReader::take(std::string &line) {
    const Words words = split_words(line);
    const std::string keyword = lower(words[0]);
    std::string reason;
    if (keyword == "newmtl") {
        end_material();
        begin_material(joined_words(line.substr(line.find(words[0]) + words[0].size())));
        reason = words.size() < 2 ? "newmtl without a name" : "";
    } else if (materials_.empty()) {
        ignore(std::string(words[0]));
    } else {
        reason = take_statement(keyword, words);
    }
    line.clear();
    return reason;
}

std::string MtlReader::take_statement(const std::string &keyword, const Words &words) {
    const auto map = maps().find(keyword);
    if (map != maps().end())
        return take_map(words, materials_.back().*map->second.member, map->second.without);
    if (keyword == "kd" || keyword == "ks" || keyword == "ke" || keyword == "kt" || keyword == "tf")
        return take_color(keyword, words);
    if (keyword == "d" || keyword == "tr" || keyword == "illum" ||
        numbers().find(keyword) != numbers().end())
        return take_number(keyword, words);

    // Ambient light is what path tracing computes.
    if (keyword != "ka" && keyword != "sharpness")
        ignore(std::string(words[0]));
    return {};
}

/// Three numbers, or one that stands for all three; behind "xyz" they are CIE XYZ.
std::string MtlReader::take_color(const std::string &keyword, const Words &words) {
    if (words.size() > 1 && words[1] == "spectral") {
        ignore(std::string(words[0]) + " spectral");
        return {};
    }
    const bool is_xyz = words.size() > 1 && words[1] == "xyz";
    const std::size_t first = is_xyz ? 2 : 1;
    if (words.size() <= first)
        return std::string(words[0]) + " without a value, expected a number";
    for (std::size_t i = first; i < words.size(); ++i)
        if (std::string reason = check_number(words[i]); !reason.empty())
            return reason;
    Rgb color;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t at = first + c < words.size() ? first + c : first;
        color[static_cast<int>(c)] = std::strtod(std::string(words[at]).c_str(), nullptr);
    }
    if (is_xyz)
        color = glm::inverse(srgb_to_xyz()) * color;

    ObjMaterial &material = materials_.back();
    if (keyword == "kd") {
        material.diffuse = color;
        has_diffuse_ = true;
    } else if (keyword == "ks") {
        material.specular = color;
        has_other_color_ = true;
    } else if (keyword == "ke") {
        material.emission = color;
        has_other_color_ = true;
    } else {
        transmittance_ = color;
    }
    return {};
}

std::string MtlReader::take_number(const std::string &keyword, const Words &words) {
    const std::size_t at = words.size() > 2 && words[1] == "-halo" ? 2 : 1;
    if (words.size() <= at)
        return std::string(words[0]) + " without a value, expected a number";
    if (std::string reason = check_number(words[at]); !reason.empty())
        return reason;
    const double value = std::strtod(std::string(words[at]).c_str(), nullptr);
    ObjMaterial &material = materials_.back();
    const auto number = numbers().find(keyword);
    if (number != numbers().end()) {
        material.*number->second = value;
    } else if (keyword == "illum") {
        material.illum = value >= 0 && value <= 10 ? static_cast<int>(value) : material.illum;
    } else if (keyword == "d") {
        material.dissolve = value;
        has_dissolve_ = true;
    } else if (!has_dissolve_) {
        material.dissolve = 1 - value;
    }
    return {};
}

std::string MtlReader::take_map(const Words &words, ObjMap &target, const std::string &without) {
    MtlMap map;
    if (std::string reason = parse_mtl_map({words.begin() + 1, words.end()}, map); !reason.empty())
        return std::string(words[0]) + ": " + reason;
    for (const std::string &option : map.ignored)
        ignore(std::string(words[0]) + " " + option);

    // Paths from other machines: the file may lie beside the materials.
    const fs::path file = map.file;
    for (const fs::path &place : {folder_ / file, folder_ / file.filename()})
        if (is_file(place)) {
            // In the file, v counts from the bottom row of the picture; with us from the top.
            target = {place.string(), lines_.where(),
                      glm::dmat3({map.scale.x, 0, 0}, {0, map.scale.y, 0},
                                 {map.offset.x, 1 - map.scale.y - map.offset.y, 1}),
                      map.is_clamped, map.bump_scale};
            return {};
        }
    log::warn(lines_.where(), "the texture " + quoted_path(map.file) +
                                  " is not there: the material " +
                                  clrender::quoted(materials_.back().name) + " has " + without);
    return {};
}

void MtlReader::begin_material(const std::string &name) {
    materials_.emplace_back();
    materials_.back().name = name;
    has_diffuse_ = has_other_color_ = has_dissolve_ = false;
    transmittance_.reset();
}

/// What was left open while more could follow.
void MtlReader::end_material() {
    if (materials_.empty())
        return;
    ObjMaterial &material = materials_.back();
    if (!has_diffuse_ && has_other_color_)
        material.diffuse = Rgb(0);
    const ObjSurface surface = surface_of(material);
    const bool has_no_tint = surface == ObjSurface::diffuse || surface == ObjSurface::principled;
    if (has_no_tint && brightest(material.specular) > 0)
        ignore("Ks");
    if (surface == ObjSurface::glass && transmittance_ && *transmittance_ != Rgb(0) &&
        *transmittance_ != Rgb(1))
        ignore("Tf");
}

void MtlReader::ignore(const std::string &what) {
    if (std::find(ignored_.begin(), ignored_.end(), what) != ignored_.end())
        return;
    if (ignored_.empty())
        where_ignored_ = lines_.where();
    ignored_.push_back(what);
}

void MtlReader::warn_of_ignored() const {
    constexpr std::size_t shown = 20;
    if (ignored_.empty())
        return;
    std::string list;
    for (std::size_t i = 0; i < std::min(ignored_.size(), shown); ++i)
        list += (i == 0 ? "" : ", ") +
                (ignored_[i].size() <= 40 ? ignored_[i] : clrender::quoted(ignored_[i]));
    log::warn(where_ignored_, "not rendered: " + list + (ignored_.size() > shown ? ", ..." : ""));
}

} // namespace

ObjSurface surface_of(const ObjMaterial &m) {
    if (m.illum == 4 || m.illum == 6 || m.illum == 7 || m.illum == 9 || (m.dissolve < 1 && m.ior))
        return ObjSurface::glass;
    if (m.roughness || m.metallic || m.sheen || m.clearcoat || m.roughness_map.is_there() ||
        m.metallic_map.is_there() || m.sheen_map.is_there())
        return ObjSurface::principled;
    // Exponents from a thousand on are those of mirrors.
    const bool is_rough = m.exponent && *m.exponent < 1000;
    const bool has_diffuse = brightest(m.diffuse) > 0.01 || m.diffuse_map.is_there();
    if (m.illum == 5 || (!has_diffuse && brightest(m.specular) > 0.5))
        return m.illum != 5 && is_rough ? ObjSurface::rough_metal : ObjSurface::mirror;
    if (m.illum >= 2 && m.exponent && brightest(m.specular) > 0)
        return ObjSurface::glossy;
    return ObjSurface::diffuse;
}

std::vector<ObjMaterial> read_mtl(const std::string &path, const SourceLocation &referrer) {
    return MtlReader(path, referrer).read();
}

std::vector<std::string> find_libraries(const std::string &folder, const std::string &names,
                                        const SourceLocation &where) {
    std::string text = names;
    std::replace(text.begin(), text.end(), '\\', '/');
    const Words words = split_words(text);
    std::vector<std::string> found;
    for (std::size_t first = 0; first < words.size();) {
        // The longest run of words that is a file is one name.
        std::size_t end = std::min(words.size(), first + 32);
        fs::path path;
        for (; end > first; --end) {
            const char *begin = words[first].data();
            const std::string_view last = words[end - 1];
            path = fs::path(folder) /
                   std::string(begin, static_cast<std::size_t>(last.data() + last.size() - begin));
            if (is_file(path))
                break;
        }
        if (end > first) {
            found.push_back(path.string());
            first = end;
            continue;
        }
        log::warn(where, quoted_path((fs::path(folder) / words[first]).string()) +
                             " is not a file; its materials are left out");
        ++first;
    }
    return found;
}

} // namespace clrender
