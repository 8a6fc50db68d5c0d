/// Films and reconstruction filters.

#include "mitsuba_scene.h"
#include "mitsuba_text.h"
#include "scene/limits.h"

#include <algorithm>
#include <fmt/format.h>

namespace clrender::mitsuba {

namespace {

void read_size(Properties &properties, FilmSettings &film) {
    film.width = static_cast<int>(properties.integer("width", film.width, 1, max_picture_side));
    film.height = static_cast<int>(properties.integer("height", film.height, 1, max_picture_side));
    if (std::int64_t{film.width} * film.height > max_picture_pixels)
        properties.fail("width", "times height is " +
                                     std::to_string(std::int64_t{film.width} * film.height) +
                                     " pixels, expected at most 268435456");

    // The crop window lies within the film.
    film.crop_x = static_cast<int>(properties.integer("crop_offset_x", 0, 0, film.width - 1));
    film.crop_y = static_cast<int>(properties.integer("crop_offset_y", 0, 0, film.height - 1));
    film.crop_width =
        static_cast<int>(properties.integer("crop_width", film.width, 1, max_picture_side));
    film.crop_height =
        static_cast<int>(properties.integer("crop_height", film.height, 1, max_picture_side));
    if (film.crop_x + film.crop_width > film.width)
        properties.fail("crop_width", "reaches beyond the film, expected at most width - "
                                      "crop_offset_x = " +
                                          std::to_string(film.width - film.crop_x));
    if (film.crop_y + film.crop_height > film.height)
        properties.fail("crop_height", "reaches beyond the film, expected at most height - "
                                       "crop_offset_y = " +
                                           std::to_string(film.height - film.crop_y));
}

void check_range(const Properties &properties, const std::string &name, double value, double lowest,
                 double highest) {
    if (!(value >= lowest && value <= highest))
        properties.fail(name, fmt::format("is {:g}, expected a number from {:g} to {:g}", value,
                                          lowest, highest));
}

} // namespace

ReconstructionFilter read_filter(const Document &document, int object) {
    const std::vector<std::string> types{"box",      "tent",       "gaussian",
                                         "mitchell", "catmullrom", "lanczos"};
    Properties properties(document, object);
    const auto type = std::find(types.begin(), types.end(), properties.object().type);
    if (type == types.end())
        fail_unsupported(document, properties.object(), types);

    ReconstructionFilter filter;
    filter.kind = static_cast<FilterKind>(type - types.begin());
    if (filter.kind == FilterKind::tent) {
        filter.radius = properties.number("radius", filter.radius);
        check_range(properties, "radius", filter.radius, min_filter_size, max_filter_size);
    } else if (filter.kind == FilterKind::gaussian) {
        filter.stddev = properties.number("stddev", filter.stddev);
        check_range(properties, "stddev", filter.stddev, min_filter_size, max_filter_size);
    } else if (filter.kind == FilterKind::mitchell) {
        filter.b = properties.number("B", filter.b);
        filter.c = properties.number("C", filter.c);
        check_range(properties, "B", filter.b, -max_filter_parameter, max_filter_parameter);
        check_range(properties, "C", filter.c, -max_filter_parameter, max_filter_parameter);
    } else if (filter.kind == FilterKind::lanczos) {
        filter.lobes = static_cast<int>(properties.integer("lobes", filter.lobes, 1, 64));
    }
    properties.finish();
    return filter;
}

void SceneReader::read_film(int object) {
    FilmSettings &film = scene_.film;
    film = FilmSettings();
    film.crop_width = film.width;
    film.crop_height = film.height;
    if (object == none)
        return;

    Properties properties(document_, object);
    if (properties.object().type != "hdrfilm")
        fail_unsupported(document_, properties.object(), {"hdrfilm"});
    film.where = properties.where();
    read_size(properties, film);
    film.pixel_format = static_cast<PixelFormat>(
        properties.choice("pixel_format", static_cast<std::size_t>(PixelFormat::rgb),
                          {"luminance", "luminance_alpha", "rgb", "rgba", "xyz", "xyza"}));

    film.sample_border = properties.boolean("sample_border", false);

    // How the picture is stored is the command line's choice.
    properties.choice("file_format", 0, {"openexr", "exr", "rgbe", "pfm"});
    properties.choice("component_format", 0, {"float16", "float32", "uint32"});
    properties.ignore({"banner", "compensate", "attach_log"});

    const auto filters = properties.children("rfilter");
    if (filters.size() > 1)
        throw InputError(document_.where(properties.object(), filters[1]->line),
                         properties.description() + " has a second rfilter, expected one");
    if (!filters.empty())
        film.filter = read_filter(document_, filters[0]->object);
    properties.finish();
}

} // namespace clrender::mitsuba
