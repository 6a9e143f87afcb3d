// Everything that reads what somebody else wrote, as functions of bytes: for the tests here, and for libFuzzer.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace coppice::hostile {

using Bytes = std::vector<std::byte>;

struct Reader {
    const char* name;  // of read_NAME
    bool is_text;
    // Whether the bytes were accepted. Ends the process where an error does not say what is wrong, or what was accepted is
    // not what the reader promises.
    bool (*read)(std::span<const std::byte> bytes);
    std::vector<Bytes> (*seeds)();  // files that are right
    // Sets the checksums right, as far as there is room for them, so that what lies behind them is reached. Null: none.
    void (*seal)(Bytes& bytes);
};

const std::vector<Reader>& readers();
const Reader* find_reader(const std::string& name);

bool read_gltf(std::span<const std::byte> bytes);     // .gltf or .glb
bool read_species(std::span<const std::byte> bytes);  // parsed, and grown where that is small
bool read_scene(std::span<const std::byte> bytes);    // *.eco.json
bool read_csv(std::span<const std::byte> bytes);      // forest inventories
bool read_path(std::span<const std::byte> bytes);     // camera paths
bool read_plant(std::span<const std::byte> bytes);    // packed plants
bool read_placed(std::span<const std::byte> bytes);   // placed plants
bool read_tiles(std::span<const std::byte> bytes);    // packed tiles, all blocks
bool read_world(std::span<const std::byte> bytes);    // populated scenes
bool read_terrain(std::span<const std::byte> bytes);  // the "terrain" object of a scene
bool read_pgm(std::span<const std::byte> bytes);      // height maps
bool read_heights_pfm(std::span<const std::byte> bytes);
bool read_r16(std::span<const std::byte> bytes);
bool read_ground(std::span<const std::byte> bytes);  // packed grounds
bool read_ppm(std::span<const std::byte> bytes);     // pictures
bool read_gltf_places(std::span<const std::byte> bytes);
bool read_pnm(std::span<const std::byte> bytes);
bool read_pfm(std::span<const std::byte> bytes);
bool read_png(std::span<const std::byte> bytes);  // and JPEG, by the images plugin where it is there
// readers_editor.cpp
bool read_edited_scene(std::span<const std::byte> bytes);   // *.eco.json, opened, worked on, undone
bool read_edited_plants(std::span<const std::byte> bytes);  // placed plants beside one
bool read_journal(std::span<const std::byte> bytes);        // read and recovered
bool read_script(std::span<const std::byte> bytes);         // run, but for commands that write files
// readers_flights.cpp
bool read_flight_summary(std::span<const std::byte> bytes);  // summary.json that play --out left
bool read_flight_frames(std::span<const std::byte> bytes);   // frames.csv likewise

}  // namespace coppice::hostile
