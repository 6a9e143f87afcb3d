// A ground as it is drawn, packed: so that who flies over it need neither grow, colour nor shade it. Little-endian: a head,
// then the heights of the field, row by row from least z, then the surface words of all levels (build_patches.h). One checksum
// (XXH3-64) covers all of it. A cache: made again from what the author wrote.
#pragma once
#include <span>
#include <string>
#include <vector>
#include "plugins/terrain/build_patches.h"
#include "plugins/terrain/height_field.h"
#include "plugins/terrain/terrain.h"
#include "runtime/core/result.h"

namespace coppice {

// Of the format, and of what build_patches and color_levels make of a field: grounds of another version are made again.
inline constexpr uint32_t k_ground_version = 1;

struct PackedGround {
    HeightField field;
    TerrainMesh mesh;             // of the field
    std::vector<uint32_t> words;  // of the mesh
    uint64_t content_hash = 0;    // PackedTerrain::content_hash
};

// words: those of the field's mesh. Same ground, same bytes.
PackedTerrain pack_ground(const HeightField& field, std::span<const uint32_t> words);

// Errors: file_*, format_unknown, limit_exceeded, value_out_of_range (of what no field can have).
Result<PackedGround> read_ground(const std::string& path);

}  // namespace coppice
