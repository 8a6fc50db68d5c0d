#include "film_border.h"

#include <cmath>

namespace clrender {

double filter_radius(const ReconstructionFilter &filter) {
    switch (filter.kind) {
    case FilterKind::box:
        return 0.5;
    case FilterKind::tent:
        return filter.radius;
    case FilterKind::gaussian:
        return 4 * filter.stddev;
    case FilterKind::mitchell:
    case FilterKind::catmullrom:
        return 2;
    case FilterKind::lanczos:
        return filter.lobes;
    }
    return 0;
}

int filter_border(const ReconstructionFilter &filter) {
    return static_cast<int>(std::ceil(filter_radius(filter) - 0.5));
}

int sampled_border(const FilmSettings &film) {
    return film.sample_border ? filter_border(film.filter) : 0;
}

} // namespace clrender
