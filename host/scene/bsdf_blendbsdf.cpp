#include "mitsuba_scene.h"

namespace clrender::mitsuba {

void SceneReader::read_model(Properties &properties, BlendBsdf &bsdf) {
    if (!properties.has("weight"))
        properties.fail("weight", "is missing, expected the share of the second BSDF");
    bsdf.weight = read_number(properties, "weight", 0.5);
    const std::vector<int> nested = read_nested(properties, 2);
    bsdf.first = nested[0];
    bsdf.second = nested[1];
}

} // namespace clrender::mitsuba
