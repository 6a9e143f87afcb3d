// Collision with millions of stems without a physics engine: the first that a ray meets, the nearest to a place, all in a
// box; stems come, move and go one by one. A grid of squares about as many as there are stems; what a square holds lies in
// one piece, and squares that are near lie near in memory.
#pragma once
#include <cstdint>
#include <unordered_map>
#include <vector>
#include "plugins/vegetation/query/stem.h"

namespace coppice {

struct StemHit {
    static constexpr uint32_t k_none = UINT32_MAX;
    uint32_t plant = k_none;      // Stem::plant; none: nothing was met
    float distance_m = INFINITY;  // along the ray, or to the stem's surface; 0 inside of it
    vec3 normal_world{0.0f};      // unit, of its surface there, away from it
    bool any() const { return plant != k_none; }
};

// Reads are from any number of threads, edits from one while nobody reads. Places are right to a millimetre within 10 km of
// the middle of the stems that it was built of.
class StemIndex {
  public:
    StemIndex() = default;
    // Of plants' numbers that are there twice the last holds. Stems without radius and such with numbers that are not finite are left out.
    explicit StemIndex(std::span<const Stem> stems);

    // direction: any length but zero. Nothing is met by a ray of numbers that are not finite.
    StemHit first_hit(dvec3 from_world, vec3 direction, float most_distance_m) const;
    // By the distance to its surface, at most within_m.
    StemHit nearest(dvec3 at_world, float within_m) const;
    // Those that touch the box, each once, in any order; appended. A physics engine makes bodies of them.
    void in_box(dvec3 least_world, dvec3 most_world, std::vector<Stem>& out) const;

    // In place of the one with its number, if there is one. Radius 0 removes it. Microseconds, but for every so many, when
    // all is sorted anew.
    void set(const Stem& stem);
    void remove(uint32_t plant);

    size_t size() const { return size_; }
    uint64_t size_bytes() const;

  private:
    struct Capsule {  // from the origin of the index
        vec3 foot;
        float radius_m;  // negative: removed
        vec3 axis;       // to the head
        uint32_t plant;
    };
    struct Squares {  // half-open, within the grid; empty where nothing of it is
        int first_x, first_z, end_x, end_z;
    };
    struct Row {  // where a plant is
        uint32_t plant, capsule;
    };
    void build(std::vector<Stem> stems);
    Capsule capsule_of(const Stem& stem) const;
    Stem stem_of(const Capsule& capsule) const;
    Squares squares_between(vec3 least, vec3 most) const;
    Squares squares_of(const Capsule& capsule) const;
    uint32_t square(int x, int z) const;
    std::span<const Capsule> built_in(uint32_t square) const;
    // All of a square: those it was built with, and those that came since.
    template <class Visit>
    void visit(uint32_t square, Visit&& visit) const;
    std::vector<Stem> all() const;
    const Capsule* find(uint32_t plant) const;

    dvec3 origin_{0.0};
    vec3 least_{0.0f}, most_{0.0f};  // of all capsules
    vec3 corner_{0.0f};              // of the grid
    float side_m_ = 1.0f;
    int count_x_ = 0, count_z_ = 0;
    uint32_t blocks_across_ = 0;
    std::vector<uint32_t> first_;    // of each square, and one more
    std::vector<Capsule> capsules_;  // by square; one that lies in several is in each
    std::vector<Row> rows_;          // by plant
    // Since all was sorted. What lies beside the grid is in no square.
    std::unordered_map<uint32_t, Capsule> added_;                  // by plant
    std::unordered_map<uint32_t, std::vector<Capsule>> added_in_;  // by square
    std::vector<Capsule> beside_;
    size_t size_ = 0;
};

}  // namespace coppice
