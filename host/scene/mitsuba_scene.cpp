#include "mitsuba_scene.h"

#include "../log.h"
#include "mitsuba_text.h"

#include <algorithm>
#include <fmt/core.h>
#include <sstream>
#include <tbb/parallel_for.h>

namespace clrender::mitsuba {

Scene SceneReader::read() {
    Properties root(document_, 0);
    read_shapes(root);
    read_scene_emitters(root);
    attempt([&] { read_files(); });
    read_view(root);
    attempt([&] { check_unused_bsdfs(root); });

    // Definitions that others refer to have been read with those; here they mean nothing.
    root.children("texture");
    root.children("spectrum");
    check_unused_media(root);
    for (const char *tag : {"film", "sampler"})
        for (const Child *child : root.children(tag))
            log::detail(document_.where(root.object(), child->line).str() + ": <" + tag +
                        "> outside of a sensor has no effect of its own");
    attempt([&] { root.finish(); });
    if (!faults_.empty())
        throw InputError(faults_);
    warn_of_missing(root);
    return std::move(scene_);
}

/// Runs a step of reading; where all faults are asked for, notes what it throws. False if it has
/// thrown.
bool SceneReader::attempt(const std::function<void()> &step) {
    try {
        step();
        return true;
    } catch (const InputError &error) {
        if (!all_faults_)
            throw;

        // Objects that are used twice fail twice.
        std::istringstream lines(error.what());
        for (std::string line; std::getline(lines, line);)
            if (std::find(faults_.begin(), faults_.end(), line) == faults_.end())
                faults_.push_back(line);
        return false;
    }
}

/// Reads what stands inside of an object that has failed, for its faults alone.
void SceneReader::check_children(int object) {
    for (const Child &child : document_.at(object).children) {
        const std::string &tag = document_.at(child.object).tag;
        if (tag == "bsdf")
            attempt([&] { read_bsdf(child.object); });
        else if (tag == "film")
            attempt([&] { read_film(child.object); });
        else if (tag == "sampler")
            attempt([&] { read_sampler(child.object); });
        else if (tag == "emitter" && area_emitters_.count(child.object) == 0)
            attempt([&] { read_area_emitter(child.object, none); });
    }
}

void SceneReader::warn_of_missing(Properties &root) const {
    if (scene_.shapes.empty() && scene_.instances.empty())
        log::warn(root.where(), "the scene has no shapes");
    if (scene_.emitters.empty() && scene_.integrator.kind != IntegratorKind::depth)
        log::warn(root.where(), "the scene has no light: the picture will be black");
    if (root.children("sensor").empty())
        log::warn(root.where(), "the scene has no sensor: the camera looks along +z at all of it");
    if (root.children("integrator").empty())
        log::warn(root.where(), "the scene has no integrator: path tracing is used");
}

void SceneReader::read_shapes(Properties &root) {
    std::set<int> seen; // a <ref> to a shape of the scene adds nothing
    for (const Child *child : root.children("shape")) {
        if (!seen.insert(child->object).second)
            continue;
        const std::size_t shapes = scene_.shapes.size(), instances = scene_.instances.size();
        if (attempt([&] { read_shape(child->object); })) {
            number_object(child->object, shapes, instances);
        } else {
            // The files of what failed belong to no shape.
            while (!shapes_from_files_.empty() && shapes_from_files_.back() >= scene_.shapes.size())
                shapes_from_files_.pop_back();
            check_children(child->object);
        }
    }
    number_meshes();
}

void SceneReader::read_scene_emitters(Properties &root) {
    std::set<int> seen;
    for (const Child *child : root.children("emitter"))
        if (seen.insert(child->object).second)
            attempt([&] { read_emitter(child->object); });
}

void SceneReader::read_files() {
    files_.read(all_faults_);
    tbb::parallel_for(std::size_t(0), shapes_from_files_.size(), [&](std::size_t i) {
        follow_transform(scene_.shapes[shapes_from_files_[i]]);
    });
    finish_groups();
}

void SceneReader::read_chosen_sensor(Properties &root) {
    const auto sensors = root.children("sensor");
    const std::size_t count = std::max(sensors.size(), std::size_t(1));
    const auto chosen = static_cast<std::size_t>(chosen_sensor_.value_or(0));
    if (chosen >= count)
        throw InputError(root.where(),
                         fmt::format("the scene has {}, expected --sensor from 0 to {}",
                                     count == 1 ? "one sensor" : fmt::format("{} sensors", count),
                                     count - 1));
    if (count > 1 && !chosen_sensor_)
        log::warn(document_.where(root.object(), sensors[1]->line),
                  fmt::format("the scene has {} sensors: only the first one is used (--sensor 0 to "
                              "{} chooses)",
                              count, count - 1));
    if (sensors.empty()) {
        place_default_sensor();
        return;
    }
    const bool is_read = attempt([&] { read_sensor(sensors[chosen]->object); });
    if (!is_read)
        check_children(sensors[chosen]->object);
}

void SceneReader::read_view(Properties &root) {
    attempt([&] { read_chosen_sensor(root); });
    check_other_sensors(root);

    const auto integrators = root.children("integrator");
    attempt([&] {
        if (integrators.size() > 1)
            throw InputError(document_.where(root.object(), integrators[1]->line),
                             "the scene has a second integrator, expected one");
        if (!integrators.empty())
            read_integrator(integrators[0]->object);
    });
}

/// Where all faults are asked for, those of the sensors that are not looked through.
void SceneReader::check_other_sensors(Properties &root) {
    const auto sensors = root.children("sensor");
    const auto chosen = static_cast<std::size_t>(chosen_sensor_.value_or(0));
    for (std::size_t i = 0; i < sensors.size() && all_faults_; ++i) {
        SceneReader checker(document_);
        checker.all_faults_ = false;
        if (i != chosen)
            attempt([&] { checker.read_sensor(sensors[i]->object); });
    }
}

/// A medium that an object has is a fault of that object; of others it is said that they are
/// ignored.
void SceneReader::check_unused_media(Properties &root) {
    for (const Child *child : root.children("medium")) {
        const auto has_it = [&](const Object &object) {
            return std::any_of(object.children.begin(), object.children.end(),
                               [&](const Child &c) { return c.object == child->object; });
        };
        if (std::none_of(document_.objects.begin() + 1, document_.objects.end(), has_it))
            log::warn(document_.where(root.object(), child->line),
                      "medium \"" + document_.at(child->object).type +
                          "\" is ignored: nothing uses it");
    }
}

void SceneReader::check_unused_bsdfs(Properties &root) {
    SceneReader checker(document_);
    checker.all_faults_ = false;
    checker.load_images_ = false;
    for (const Child *child : root.children("bsdf")) {
        if (bsdfs_.count(child->object) > 0)
            continue;
        try {
            checker.read_bsdf(child->object);
        } catch (const UnsupportedError &error) {
            log::warn(error.where(), error.fault() + " (no shape uses it)");
            checker.open_bsdfs_.clear();
        } catch (const InputError &) {
            checker.open_bsdfs_.clear();
            attempt([] { throw; });
        }
    }
}

} // namespace clrender::mitsuba
