#pragma once
/// A picture with the exact sums that it comes from, in one EXR file: it opens as a picture, a
/// render goes on from it, and parts of a render add up to the whole.

#include "control.h"
#include "film.h"
#include "work_done.h"

#include <map>
#include <string>
#include <vector>

namespace clrender {

/// What the sums mean; of films that add up all of it is the same.
struct FilmLayout {
    int width = 0, height = 0, exponent = 0;
    int lanes = 0;
    PixelFormat format = PixelFormat::rgb;
    WorkGrid grid;
    ControlLayout control;
    bool measured = false; ///< with moments

    bool operator==(const FilmLayout &other) const;
};

struct Checkpoint {
    FilmLayout layout;
    Film film;                         ///< of whole blocks of samples
    std::vector<ControlPixel> control; ///< as ControlSums
    Work work;                         ///< the samples that are in them
    std::string options;               ///< JSON: what else has to be the same, and how to go on
};

/// Writes both as one file: the channels of `picture`, and behind them the sums as UINT layers.
/// `metadata`: as write_image(). Throws OutputError.
void write_checkpoint(const std::string &path, const Checkpoint &checkpoint, const Image &picture,
                      const std::map<std::string, std::string> &metadata);

/// Throws InputError where it is none, or damaged.
Checkpoint read_checkpoint(const std::string &path);

/// Adds the samples of another checkpoint of the same layout.
void add_checkpoint(Checkpoint &sum, const Checkpoint &part);

/// The samples that every pixel has: those of the first whole blocks that are there completely.
int samples_of(const Checkpoint &checkpoint);

} // namespace clrender
