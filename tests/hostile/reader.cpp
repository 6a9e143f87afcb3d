#include "tests/hostile/reader.h"

#include "tests/hostile/seal.h"
#include "tests/hostile/seeds.h"

namespace coppice::hostile {

const std::vector<Reader>& readers() {
    static const std::vector<Reader> k_readers{
        {"gltf", false, read_gltf, gltf_seeds, nullptr},
        {"gltf_places", false, read_gltf_places, gltf_places_seeds, nullptr},
        {"species", true, read_species, species_seeds, nullptr},
        {"scene", true, read_scene, scene_seeds, nullptr},
        {"csv", true, read_csv, csv_seeds, nullptr},
        {"path", true, read_path, path_seeds, nullptr},
        {"plant", false, read_plant, plant_seeds, seal_plant},
        {"placed", false, read_placed, placed_seeds, seal_placed},
        {"tiles", false, read_tiles, tiles_seeds, seal_tiles},
        {"world", true, read_world, world_seeds, nullptr},
        {"terrain", true, read_terrain, terrain_seeds, nullptr},
        {"pgm", false, read_pgm, pgm_seeds, nullptr},
        {"heights_pfm", false, read_heights_pfm, heights_pfm_seeds, nullptr},
        {"r16", false, read_r16, r16_seeds, nullptr},
        {"ground", false, read_ground, ground_seeds, seal_ground},
        {"ppm", false, read_ppm, ppm_seeds, nullptr},
        {"pnm", false, read_pnm, pnm_seeds, nullptr},
        {"pfm", false, read_pfm, pfm_seeds, nullptr},
        {"png", false, read_png, png_seeds, nullptr},
        {"edited_scene", true, read_edited_scene, edited_scene_seeds, nullptr},
        {"edited_plants", false, read_edited_plants, edited_plants_seeds, seal_placed},
        {"journal", false, read_journal, journal_seeds, seal_journal},
        {"script", true, read_script, script_seeds, nullptr},
        {"flight_summary", true, read_flight_summary, flight_summary_seeds, nullptr},
        {"flight_frames", true, read_flight_frames, flight_frames_seeds, nullptr},
    };
    return k_readers;
}

const Reader* find_reader(const std::string& name) {
    for (const Reader& reader : readers())
        if (name == reader.name) return &reader;
    return nullptr;
}

}  // namespace coppice::hostile
