// A plant's orthographic picture: what it looks like from the far side of an axis. For textures of billboards.
#pragma once
#include <cstdint>
#include <vector>
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

// Seen from the positive side of `axis` (0 x, 1 y, 2 z). Columns run along the axis after it, rows along the one after
// that, both upwards from the least corner of the plant's bounds.
struct PlantPicture {
    int axis;
    float sample_m;  // side of a sample
    uint32_t columns, rows;
    std::vector<uint8_t> covered;   // 1: some triangle holds the sample's centre
    std::vector<Surface> surfaces;  // of the nearest one, where covered
};

// All triangles, from both their sides. Where several are equally near, the first. Requires sample_m such that a side
// of the plant takes at most 8192 samples. Same plant, same picture.
PlantPicture picture_plant(const Plant& plant, int axis, float sample_m);

}  // namespace coppice
