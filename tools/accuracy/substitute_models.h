// A scene in which plants are drawn by stand-ins: each plant by the one of its model's ladder that is just fine enough
// where it stands. Both methods with geometry of their own, merged vertices and billboards, draw by it.
#pragma once
#include <deque>
#include <memory>
#include <span>
#include <vector>
#include "plugins/vegetation/plant/pack.h"
#include "tools/accuracy/method.h"

namespace coppice {

struct SubstituteLevel {
    Plant plant;    // with the bounds of the plant it stands for
    float grain_m;  // size of what it no longer shows; 0: shows everything
};
// From the finest, whose grain is 0, to the coarsest.
using SubstituteLadder = std::vector<SubstituteLevel>;

// Appends a part that is always drawn by all its triangles, three corners each: `like` in its name, flags, colour and
// importance, with neither points nor lines.
void add_triangle_part(const PackedPart& like, std::span<const PackedVertex> corners, PlantBlocks& plant);
// Without parts; name and bounds are the plant's.
PlantBlocks empty_blocks_like(const Plant& plant);
// Errors: load_plant_from_memory's.
Result<Plant> pack_substitute(const PlantBlocks& blocks);
// The plant's triangles and nothing else.
Result<Plant> triangles_only(const Plant& plant);

class SubstituteScenes {
  public:
    // ladders[i] stands for original.scene.models[i]. The scene's importance of a model is left out: who drops nothing
    // has nothing to weigh.
    SubstituteScenes(const MethodScene& original, std::vector<SubstituteLadder> ladders);

    struct Choice {
        const MethodScene* scene;  // lives until four others were chosen
        uint64_t revision;
    };
    // Every plant at its coarsest level whose grain takes at most grain_px on the picture; the distance is the one the
    // level of detail takes (lod/project.h). The same choice of levels gives the same scene.
    Choice choose(const Camera& camera, float focal_px, double grain_px);

  private:
    struct Made {
        std::unique_ptr<const MethodScene> scene;
        uint64_t revision;
    };
    MethodScene base_;  // all models at their finest
    std::vector<uint32_t> first_level_;
    std::vector<std::vector<float>> grains_m_;
    std::deque<Made> made_;  // the newest last
    uint64_t revision_ = 0;
};

}  // namespace coppice
