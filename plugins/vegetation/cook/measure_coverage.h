// How much more or less of a part's projected area its points or lines must be drawn with, so that as many pixels show
// them as show its triangles, in the whole plant: parts hide each other and themselves. Triangles hide one another in
// another way than points strewn over them: where leaves are larger than a pixel, points fall on each other and leave gaps;
// where a plant is a point or two, nothing falls on anything, and points must ask for no more than what is seen of them. The
// paper's splat factor c_p (1.2 to 1.5) is one number for this; here it is measured, for every part and size on the screen,
// and from the side and from above, from where more or less may be hidden (docs/decisions.md).
#pragma once
#include <span>
#include "plugins/vegetation/plant/pack.h"

namespace coppice {

// Sets coverage_gain and height_gain of each part. parts: of one plant, a part each, which together are all of it.
// Draws them on the CPU by the rules of the kernels, at one pixel of sample distance. The same on any number of threads.
void measure_coverage(std::span<PlantBlocks> parts);

}  // namespace coppice
