// Counts and times of one frame.
#pragma once
#include <cstdint>

namespace coppice {

struct FrameReport {
    uint32_t tiles = 0;           // leaves of their hierarchy
    uint32_t tiles_touched = 0;   // looked at on the way down
    uint32_t tiles_expanded = 0;  // whose plants were looked at
    uint32_t clouds = 0;          // tiles that one cloud of points stood for
    uint32_t tiles_missing = 0;   // clouds that stood for what was not in memory yet
    uint32_t tiles_hidden = 0;    // in view, but behind the ground; with all below them
    uint64_t plants = 0;
    uint32_t plants_visible = 0;
    uint32_t plants_expanded = 0;                   // of the tiles that were looked into
    uint32_t plants_hidden = 0;                     // of expanded tiles, in view but behind the ground
    float sample_distance_px = 0.0f;                // d' as drawn
    uint64_t vertex_budget = 0;                     // that d' was found for; 0: none
    uint64_t cloud_plants = 0;                      // that clouds stood for
    uint64_t triangles = 0, lines = 0, points = 0;  // drawn, of plants
    uint64_t leaves = 0;                            // of crowns at a level of detail, likewise
    uint64_t terrain_triangles = 0;
    uint64_t vertices = 0;         // points + 2 lines + 3 triangles + 4 leaves, of plants
    uint64_t full_triangles = 0;   // of the visible plants, had all been drawn
    uint64_t scene_triangles = 0;  // of the whole scene
    // Of shadow maps: texels a side, 0: there are none; how many were drawn; the plants in those, and what was drawn of them and of
    // clouds.
    uint32_t shadow_side_texels = 0, shadow_maps = 0, shadow_plants = 0;
    uint64_t shadow_triangles = 0, shadow_lines = 0, shadow_points = 0, shadow_leaves = 0;
    uint64_t work_entries = 0;     // of the work list
    uint64_t dropped_entries = 0;  // did not fit into the work list; its capacity grows for the next frame
    uint64_t dropped_triangles =
        0;                       // large ones beyond the list's capacity in the last finished frame; it grows
    uint32_t rested_frames = 0;  // the picture is the mean of so many frames before this one, and this one
    double stream_ms = 0.0, cull_ms = 0.0, lod_ms = 0.0, write_ms = 0.0;  // CPU
    uint64_t gpu_bytes = 0;                                               // buffers held
    // Of a world that is read while it is flown over.
    uint32_t streamed_clouds = 0, streamed_plant_tiles = 0;  // in memory
    uint64_t stream_bytes_read = 0;                          // since the start, as stored
    uint64_t stream_resident_bytes = 0;                      // of its budget
    uint32_t stream_errors = 0;                              // blocks that could not be read, since the start
};

}  // namespace coppice
