// Writes a plant as the bytes of a .plant file (plant.h names the blocks, format.h lays out the head).
#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

// What goes into the file; ranges of parts refer to these arrays.
struct PlantBlocks {
    std::string name;
    Box bounds_plant;
    std::vector<PackedPart> parts;
    std::vector<PackedVertex> triangle_vertices;
    std::vector<PackedVertex> points;
    std::vector<uint32_t> point_owners;
    std::vector<PackedVertex> line_vertices;
    std::vector<PackedPart> cells;
    std::vector<PackedCrown> crowns;
    std::vector<PackedLeaf> leaves;
    uint32_t dropped_triangles = 0;
    uint32_t dropped_vertices = 0;
};

// Same plant, same bytes. Names longer than their field are cut between two characters.
std::vector<std::byte> pack_plant(const PlantBlocks& plant);

// Copies as much of UTF-8 `text` as fits with its terminating zero, never half a character; fills up with
// zeros.
void copy_name(std::string_view text, char* field, size_t field_bytes);

}  // namespace coppice
