// A plant as an author or a modeller gives it: parts with their full geometry, and the structure where it is
// known. This is what the cook takes in. Metres, y up, foot of the plant at the origin.
#pragma once
#include <cstdint>
#include <string>
#include <vector>
#include "runtime/core/math.h"

namespace coppice {

// Of every coordinate of a plant, in the description and packed. Beyond it a float no longer resolves a leaf.
inline constexpr float k_position_limit_m = 1e5f;

// What a part turns into in the distance.
enum class PartKind : uint8_t {
    automatic,  // the cook decides by shape
    points,     // of PartSettings: and nothing else
    lines,
    leaves,  // of PartSettings alone: leaves, joined by and by, as far as there are levels of them, then points
};

inline constexpr float k_importance_limit = 1000.0f;

// What a person decided of all parts of that name as they come out of the cook (cook/part_settings.h).
struct PartSettings {
    std::string name;
    PartKind kind = PartKind::automatic;
    float importance = 0.0f;  // up to k_importance_limit; 0: as it would be
    bool operator==(const PartSettings&) const = default;
};

struct DescriptionVertex {
    vec3 position_plant;
    vec3 normal_plant;  // unit
    vec3 color_linear;  // [0, 1], textures already applied
};

// A piece of a stem, a straight cone. Consecutive pieces of one stem share their ends.
struct SkeletonSegment {
    vec3 begin_plant, end_plant;
    float begin_radius_m, end_radius_m;
    uint32_t stem;   // which stem of the plant
    uint32_t level;  // 0 trunk, 1 branches, ...
    vec3 color_linear;
};

struct PartDescription {
    std::string name;
    PartKind kind = PartKind::automatic;
    bool leaf = false;        // two-sided and translucent (leaves, petals, grass), or opaque (bark, fruit)
    float importance = 0.0f;  // factor on the primitive counts; 0: the cook decides by colour
    std::vector<DescriptionVertex> vertices;
    std::vector<uint32_t> indices;  // three a triangle, into vertices
    // Triangles of leaf i: [element_first_triangle[i], element_first_triangle[i + 1]). Empty where leaves are
    // not known apart; else it starts with 0 and ends with the number of triangles.
    std::vector<uint32_t> element_first_triangle;
    std::vector<SkeletonSegment> skeleton;  // empty where not known
};

struct PlantDescription {
    std::string name;
    std::vector<PartDescription> parts;
    std::vector<PartSettings> settings;
    uint32_t dropped_vertices = 0;  // of the author's file, used by no triangle and left out already
};

}  // namespace coppice
