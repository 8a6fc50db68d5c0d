#include "mitsuba_scene.h"

namespace clrender::mitsuba {

void SceneReader::read_model(Properties &properties, TwosidedBsdf &bsdf) {
    const auto nested = properties.children("bsdf");
    if (nested.empty() || nested.size() > 2)
        throw InputError(properties.where(), properties.description() + " has " +
                                                 std::to_string(nested.size()) +
                                                 " nested BSDFs, expected one or two");
    for (const Child *child : nested)
        if (lets_light_through(scene_, read_bsdf(child->object)))
            throw InputError(document_.where(properties.object(), child->line),
                             "twosided contains a " + document_.at(child->object).type +
                                 ", expected a BSDF that lets no light through");
    bsdf.front = read_bsdf(nested.front()->object);
    bsdf.back = read_bsdf(nested.back()->object);

    // Both sides of the outer BSDF show the front of a nested one.
    for (int *side : {&bsdf.front, &bsdf.back})
        if (const auto *inner =
                std::get_if<TwosidedBsdf>(&scene_.bsdfs.at(static_cast<std::size_t>(*side)).model))
            *side = inner->front;
}

} // namespace clrender::mitsuba
