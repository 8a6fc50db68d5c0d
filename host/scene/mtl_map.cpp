#include "mtl_map.h"

#include "obj_lines.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <map>

namespace clrender {

namespace {

/// How many values an option takes, the last one at least 1.
const std::map<std::string_view, std::size_t> &options() {
    static const std::map<std::string_view, std::size_t> counts = {
        {"-blendu", 1}, {"-blendv", 1}, {"-bm", 1},      {"-boost", 1},     {"-cc", 1},
        {"-clamp", 1},  {"-mm", 2},     {"-o", 3},       {"-s", 3},         {"-t", 3},
        {"-texres", 1}, {"-type", 1},   {"-imfchan", 1}, {"-colorspace", 1}};
    return counts;
}

bool is_number(std::string_view word) {
    return check_number(word).empty();
}

double number(std::string_view word) {
    return std::strtod(std::string(word).c_str(), nullptr);
}

/// One to three numbers for u, v and w; those that are left out keep their default.
void take_vector(const std::vector<std::string_view> &values, glm::dvec2 &target) {
    for (std::size_t i = 0; i < std::min<std::size_t>(values.size(), 2); ++i)
        target[static_cast<int>(i)] = number(values[i]);
}

/// True if the option with these values changes nothing that we render.
bool says_nothing(std::string_view option, const std::vector<std::string_view> &values) {
    if (option == "-mm")
        return number(values[0]) == 0 && number(values[1]) == 1;
    if (option == "-t")
        return std::all_of(values.begin(), values.end(),
                           [](std::string_view v) { return number(v) == 0; });
    return option == "-cc" && values[0] == "off";
}

void apply(std::string_view option, const std::vector<std::string_view> &values, MtlMap &map) {
    if (option == "-s")
        take_vector(values, map.scale);
    else if (option == "-o")
        take_vector(values, map.offset);
    else if (option == "-clamp")
        map.is_clamped = values[0] == "on";
    else if (option == "-bm")
        map.bump_scale = number(values[0]);
    else if (!says_nothing(option, values))
        map.ignored.emplace(option);
}

} // namespace

std::string parse_mtl_map(const std::vector<std::string_view> &words, MtlMap &map) {
    std::size_t at = 0;
    while (at < words.size()) {
        const auto option = options().find(words[at]);
        if (option == options().end())
            break;
        const bool is_vector = option->second == 3;
        const bool is_numeric = is_vector || option->first == "-mm" || option->first == "-bm";
        std::vector<std::string_view> values;
        for (++at; at < words.size() && values.size() < option->second; ++at) {
            if (is_numeric && !is_number(words[at]))
                break;
            values.push_back(words[at]);
        }
        if (values.empty() || (!is_vector && values.size() < option->second))
            return "option " + std::string(option->first) + " without its values, expected " +
                   (is_vector ? "one to three numbers" : std::to_string(option->second));
        apply(option->first, values, map);
    }
    for (; at < words.size(); ++at)
        map.file.append(map.file.empty() ? "" : " ").append(words[at]);
    if (map.file.size() > 2 && map.file.front() == '"' && map.file.back() == '"')
        map.file = map.file.substr(1, map.file.size() - 2);
    std::replace(map.file.begin(), map.file.end(), '\\', '/');
    return map.file.empty() ? "no file name, expected one" : "";
}

} // namespace clrender
