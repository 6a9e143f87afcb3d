// How far a plant's levels of detail are from all its triangles, by its size in the picture: what tests bound and the editor
// plots.
#pragma once
#include "plugins/vegetation/lod/learn_cost.h"
#include "plugins/vegetation/report/plant_picture.h"

namespace coppice {

struct LevelFigures {
    float height_px = 0.0f;
    double coverage_px = 0.0;     // of all triangles: the pixels that show some
    double coverage_error = 0.0;  // of the level's coverage, over that: 0.02 is 2 % too much
    double color_error = 0.0;     // of the mean colour, the worst channel over the mean of all three
    PrimitiveCounts full, drawn;  // in the mean
};

// The plant that tall, in the mean over 16 directions from the side to 60 degrees above, each at several places of the pixel
// grid: the mean of what one sample a pixel shows of all triangles is their exact coverage. settings: of the level. Sizes up to
// the picture's side. Same plant, same settings, same figures on one device. Errors: limit_exceeded, device_lost.
Result<LevelFigures> measure_levels(PlantPicture& picture, float height_px, const FrameSettings& settings);

}  // namespace coppice
