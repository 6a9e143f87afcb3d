// Plants that a host places, moves and takes away one by one while they are drawn; picture, shadows and stems follow with the
// next frame. The scene's own plants stay as they are: what may be felled is placed here. Drawn plant by plant, since nothing
// stands for them in the distance: for thousands about the viewer, not for millions.
#pragma once
#include <map>
#include <unordered_map>
#include <vector>
#include "plugins/vegetation/eco/place.h"
#include "plugins/vegetation/query/stem_index.h"
#include "plugins/vegetation/vegetation.h"

namespace coppice {

inline constexpr uint32_t k_first_loose_plant = 1u << 31;  // numbers below are rows of the scene
inline constexpr double k_loose_square_m = 16.0;           // plants of a square are one loose tile

// What is known of a model beside what is drawn of it.
struct LooseModel {
    std::string name;
    Box bounds_plant;
    StemShape stem;
};

// One thread at a time, between frames.
class LoosePlants {
  public:
    // square_limit: VegetationSettings::loose_tiles, as many squares may have plants. Both references outlive this.
    LoosePlants(Vegetation& vegetation, StemIndex& stems, std::vector<LooseModel> models,
                uint32_t square_limit)
        : vegetation_(vegetation), stems_(stems), models_(std::move(models)), square_limit_(square_limit) {}

    // The plant's number, never given again: what stems say of it. Errors: value_out_of_range (a place that is not finite or
    // farther than 10^9 m from the origin, a scale not above 0, a model that the scene lacks), limit_exceeded.
    Result<uint32_t> add(const Placement& placement);
    // Also with another size, turn or model. Errors: add's, and name_unknown; the plant stays as it was then.
    Status move(uint32_t plant, const Placement& placement);
    // Errors: name_unknown.
    Status remove(uint32_t plant);
    size_t size() const { return place_of_.size(); }

    // Gives what changed to the vegetation. Before a frame's schedule. Errors: set_loose_tile's; what was not taken is tried
    // again.
    Status show();
    // After another scene has taken the place of the old one: plants keep their numbers, and get the models that have the
    // same names, variation by variation. Those whose names are gone are removed; returns how many.
    size_t change_models(std::vector<LooseModel> models);

  private:
    using SquareName = uint64_t;
    struct Square {
        std::vector<uint32_t> plants;  // of both the same rows
        std::vector<Placement> placements;
        bool changed = false;
    };
    struct Place {
        SquareName square;
        size_t row;
    };
    Status check(const Placement& placement) const;
    Result<Place> find(uint32_t plant) const;
    // Whether one more square may have plants, after one of them was left.
    bool has_room(SquareName name, size_t left) const;
    void put(uint32_t plant, SquareName name, const Placement& placement);
    void take(const Place& place);
    Status show_square(SquareName name, Square& square);

    Vegetation& vegetation_;
    StemIndex& stems_;
    std::vector<LooseModel> models_;
    uint32_t square_limit_;
    uint32_t next_plant_ = k_first_loose_plant;
    std::map<SquareName, Square> squares_;  // those without plants only until they have been shown
    size_t used_squares_ = 0;               // with plants
    std::unordered_map<uint32_t, Place> place_of_;
};

}  // namespace coppice
