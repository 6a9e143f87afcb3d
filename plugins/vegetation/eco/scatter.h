// Places plants over a region by density, by number or on a jittered grid, with a least distance, clearings,
// clumps, maps of density and distances to what stands there. A pure function of its settings: every cell of the ground draws from its own seed, so the
// result does not depend on the number of threads.
#pragma once
#include <optional>
#include <string>
#include <vector>
#include "plugins/shared/region.h"
#include "plugins/terrain/terrain.h"
#include "plugins/vegetation/eco/density_map.h"
#include "plugins/vegetation/eco/ground_rule.h"
#include "plugins/vegetation/eco/near_places.h"
#include "plugins/vegetation/eco/place.h"
#include "runtime/core/result.h"

namespace coppice {

struct ScatterSpecies {
    PlantKind kind;
    float weight = 1.0f;  // share of the plants, relative to the others
};

// Plants stand where fractal noise, of mean 0.5 and mostly within 0.2 to 0.8, is between from and to.
// Scatters with one seed and wavelength see the same noise, so one can fill what another leaves.
struct DensityNoise {
    float wavelength_m = 30.0f;
    float from = 0.0f, to = 1.0f;
    float softness = 0.05f;  // of the noise, over which density falls to zero
    uint32_t octaves = 3;
    uint32_t seed = 1;
    double period_m = 0.0;  // the noise repeats after it, for periodic ground; 0: it never does
};

// How far from some of the plants that stand there; null: any distance will do.
struct DistanceRule {
    std::shared_ptr<const NearPlaces> too_near, near_enough;
};

// What was scattered grows and thins itself (compete.h).
struct Competition {
    double crown_radius_m = 0.0;  // at scale 1; 0: none
    uint32_t steps = 0;
    double growth = 0.0;      // share a step
    double scale_most = 1.0;  // nothing grows beyond it
};

struct ScatterSettings {
    std::vector<ScatterSpecies> species;  // at least one
    Region region;                        // at least one shape
    Region exclude;                       // may be empty
    float edge_m = 0.0f;                  // density falls to zero over so much inside the region's border
    // One of the three:
    double density_per_m2 = 0.0;               // where nothing thins it
    uint64_t count = 0;                        // exactly
    double grid_spacing_m = 0.0;               // a plant a grid place
    uint32_t grid_columns = 0, grid_rows = 0;  // about the region's middle; 0: as many as fit into the region
    double grid_jitter_m = 0.0;                // along x and z, each way

    double spacing_m = 0.0;  // least distance between two plants of this scatter; not of a grid
    float scale_low = 1.0f, scale_high = 1.0f;
    float height_low_m = 0.0f,
          height_high_m = 0.0f;  // instead of scale, where the kind's height is known; 0: unused
    float lean_most_rad = 0.0f;  // any direction, any angle up to it
    GroundRule rule;
    bool noisy = false;
    DensityNoise noise;
    std::optional<DensityMap> map;
    std::vector<DistanceRule> distances;  // all of them hold
    Competition competition;              // density and count are what it begins with
    uint64_t seed = 1;
    const Terrain* terrain = nullptr;  // null: the plane y = 0

    bool keeps_distances(dvec2 p) const;
};

// In order of cells. Errors: limit_exceeded (before anything is allocated), value_out_of_range (the count or
// density cannot be had with that spacing); their place is `place`.
Result<std::vector<Placement>> scatter(const ScatterSettings& settings, const std::string& file,
                                       const std::string& place);

}  // namespace coppice
