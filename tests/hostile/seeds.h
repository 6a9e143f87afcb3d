// Files that are right, which tests and fuzzers break. Made in memory, or of the content; the same ones every time.
#pragma once
#include "tests/hostile/reader.h"

namespace coppice::hostile {

std::vector<Bytes> gltf_seeds();
std::vector<Bytes> species_seeds();
std::vector<Bytes> scene_seeds();
std::vector<Bytes> csv_seeds();
std::vector<Bytes> path_seeds();
std::vector<Bytes> plant_seeds();
std::vector<Bytes> placed_seeds();
std::vector<Bytes> tiles_seeds();
std::vector<Bytes> world_seeds();
std::vector<Bytes> terrain_seeds();
std::vector<Bytes> pgm_seeds();
std::vector<Bytes> heights_pfm_seeds();
std::vector<Bytes> r16_seeds();
std::vector<Bytes> ground_seeds();
std::vector<Bytes> ppm_seeds();
std::vector<Bytes> gltf_places_seeds();
std::vector<Bytes> pnm_seeds();
std::vector<Bytes> pfm_seeds();
std::vector<Bytes> png_seeds();
// seeds_editor.cpp
std::vector<Bytes> edited_scene_seeds();
std::vector<Bytes> edited_plants_seeds();
std::vector<Bytes> journal_seeds();
std::vector<Bytes> script_seeds();

std::vector<Bytes> flight_summary_seeds();
std::vector<Bytes> flight_frames_seeds();

}  // namespace coppice::hostile
