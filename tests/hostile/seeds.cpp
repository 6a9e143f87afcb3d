// Small files that are right, of every kind.
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <unistd.h>
#include "plugins/terrain/build_patches.h"
#include "plugins/terrain/ground_file.h"
#include "plugins/vegetation/eco/placed_plants.h"
#include "plugins/vegetation/eco/populated_scene.h"
#include "plugins/vegetation/plant/pack.h"
#include "tests/cook_import/tiny_gltf.h"
#include "tests/eco/made_tiles.h"
#include "tests/hostile/seeds.h"

namespace coppice::hostile {
namespace {

Bytes as_bytes(std::string_view text) {
    Bytes bytes(text.size());
    std::memcpy(bytes.data(), text.data(), text.size());
    return bytes;
}

Bytes read_file(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return as_bytes(std::string(std::istreambuf_iterator<char>(stream), {}));
}

std::vector<Bytes> content_files(const char* folder, std::initializer_list<const char*> names) {
    std::vector<Bytes> files;
    for (const char* name : names)
        files.push_back(read_file(std::filesystem::path(COPPICE_CONTENT_DIR) / folder / name));
    return files;
}

PlantBlocks made_plant() {
    PlantBlocks blocks;
    blocks.name = "made";
    blocks.bounds_plant.include(vec3(0));
    blocks.bounds_plant.include(vec3(1, 2, 3));
    for (uint32_t i = 0; i < 6; ++i) blocks.triangle_vertices.push_back({float(i), 1, 2, i});
    for (uint32_t i = 0; i < 3; ++i) {
        blocks.points.push_back({0, float(i), 2, i});
        blocks.point_owners.push_back(i % 2);
    }
    for (uint32_t i = 0; i < 4; ++i) blocks.line_vertices.push_back({0, 1, float(i), 0x3f800000});
    PackedPart part{};
    copy_name("leaf", part.name, sizeof part.name);
    part.importance = 1.5f;
    part.coverage_gain.fill(1.0f);
    part.triangle_count = 2;
    part.point_count = 3;
    part.area_m2 = 2.0f;
    blocks.parts.push_back(part);
    part.kind = PackedPartKind::lines;
    part.triangle_count = part.point_count = 0;
    part.first_triangle = 2;
    part.first_point = 3;
    part.line_count = 2;
    blocks.parts.push_back(part);
    // Each of the leaf part's triangles has a cell with a point of its own.
    for (uint32_t c = 0; c < 2; ++c) {
        PackedPart cell = blocks.parts[0];
        cell.first_triangle = c;
        cell.triangle_count = cell.point_count = 1;
        cell.first_point = uint32_t(blocks.points.size());
        cell.first_line = 2;
        blocks.cells.push_back(cell);
        blocks.points.push_back({0, 1, float(c), 5});
        blocks.point_owners.push_back(0);
    }
    // Four leaves and the two collapses that leave two.
    blocks.crowns.push_back({0, 0, 4, 2});
    for (const uint32_t birth : {0u, 0u, 0u, 1u, 0u, 2u}) blocks.leaves.push_back({{}, 5, birth});
    return blocks;
}

}  // namespace

std::vector<Bytes> gltf_seeds() {
    TinyGltf plain, rich;
    add_triangle(plain);
    plain.node(R"("mesh":0,"translation":[1,2,3],"rotation":[0,0.7,0,0.7],"scale":[1,2,1])");
    const int positions = rich.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}),
              uvs = rich.uvs({{0, 0}, {1, 0}, {0, 1}, {1, 1}}), indices = rich.indices({0, 1, 2, 2, 1, 3}),
              places = rich.vectors({{0, 0, 0}, {5, 0, 0}});
    rich.material(
        R"("name":"leaf","alphaMode":"MASK","doubleSided":true,"pbrMetallicRoughness":{"baseColorFactor":[0.2,0.5,0.1,1]})");
    rich.mesh("\"POSITION\":" + std::to_string(positions) + ",\"TEXCOORD_0\":" + std::to_string(uvs),
              "\"material\":0,\"mode\":4,\"indices\":" + std::to_string(indices));
    rich.node(
        R"("mesh":0,"children":[1],"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":)" +
        std::to_string(places) +
        R"(}}},"extras":{"coppice":{"kind":"points","importance":2.0,"leaf":true}})");
    rich.node(R"("matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,1,0,1],"mesh":0)");
    return {plain.glb(), rich.glb(),
            as_bytes(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"mesh":0}],"meshes":[{"name":"twig","primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0],
"sparse":{"count":1,"indices":{"bufferView":1,"componentType":5123},"values":{"bufferView":0}}},
{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
"buffers":[{"byteLength":42,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIA"}]})")};
}

std::vector<Bytes> gltf_places_seeds() {
    TinyGltf gltf;
    add_triangle(gltf);
    const int16_t turns[8] = {0, 23170, 0, 23170, 0, 0, 0, 32767};
    const int rotations = gltf.accessor(gltf.view(turns, sizeof turns), 5122, "VEC4", 2, "\"normalized\":true");
    const int places = gltf.vectors({{1, 2, 3}, {4, 5, 6}}), scales = gltf.vectors({{1, 1, 1}, {2, 2, 2}});
    gltf.node(R"("name":"oak.003","mesh":0,"translation":[65536,0,0],"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":)" +
              std::to_string(places) + ",\"ROTATION\":" + std::to_string(rotations) + ",\"SCALE\":" + std::to_string(scales) + "}}}");
    return {gltf.glb(), as_bytes(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"name":"stand","scale":[2,2,2],"children":[1,2]},{"name":"oak","translation":[5,0,0],"rotation":[0,0.7071068,0,0.7071068]},
{"name":"oak_2","matrix":[0,0,-3,0,0,3,0,0,3,0,0,0,5,6,7,1]}]})")};
}

std::vector<Bytes> species_seeds() {
    return content_files("species", {"grass.json", "daisy.json", "fern.json", "shrub.json"});
}

std::vector<Bytes> scene_seeds() {
    return {
        as_bytes(
            R"({"name":"seed","plants":{"oak":{"source":"oak.json","variations":2,"importance":1.5,"height_m":14},"fern":{"source":"fern.glb"}},
"regions":{"path":{"corridor":{"points":[[0,50],[4,10],[0,-50]],"width_m":3}},"meadow":[{"circle":{"center":[0,20],"radius_m":30}},{"polygon":[[0,0],[40,0],[20,30]]}]},
"terrain":{"flat":{"size_m":128,"cell_m":8,"height_m":1}},
"placements":[{"plant":"oak","at":[3,-8],"turn_deg":90,"tilt_deg":2,"tilt_towards_deg":45,"scale":1.2,"variation":0},
{"scatter":{"plants":{"oak":3,"fern":1},"region":"meadow","exclude":["path",{"rectangle":{"center":[9,9],"size_m":[4,2],"turn_deg":30}}],"edge_m":5,"density_per_m2":0.05,"spacing_m":2,"scale":[0.8,1.2],"tilt_deg":3,"align_to_ground":0.2,"slope_max_deg":35,"altitude_m":[-10,40],"density_noise":{"wavelength_m":30,"from":0.45,"to":3,"softness":0.05,"octaves":3,"seed":1},"seed":1}},
{"scatter":{"plant":"oak","grid":{"spacing_m":7,"jitter_m":2.45,"columns":4,"rows":3},"height_m":[10,16]}},
{"scatter":{"plant":"fern","count":20,"region":{"circle":{"center":[0,0],"radius_m":40}},"distance":[{"from":["oak"],"least_m":0.5},{"from":"oak","most_m":30}]}}],
"sun":{"azimuth_deg":135,"elevation_deg":40,"color":[3,2.75,2.35]},"sky":{"zenith":[0.2,0.38,0.75],"horizon":[0.62,0.74,0.88],"ground":[0.1,0.1,0.06]},
"haze":{"color":[0.62,0.72,0.84],"density_per_m":0.0006},"exposure":1.0,
"camera_path":[{"time_s":0,"at":[0,45],"above_m":1.7,"look_at":[0,0],"look_above_m":1.7},{"time_s":10,"at":[0,30,0],"yaw_deg":0,"pitch_deg":-12,"fov_deg":60,"near_m":0.1}],
"sample_distance_px":1.0})"),
        as_bytes(R"({"plants":{"a":{"source":"a.json"}},"placements":[{"plant":"a","at":[1,2,3]}]})")};
}

std::vector<Bytes> csv_seeds() {
    return {as_bytes("x,y,species,height,diameter\n1,2,oak,12.5,0.3\n-3.25,4e2,QURO,,\n"),
            as_bytes("species;\"x\";y;note\r\n\"oak\";1;2;\"a \"\"b\"\"\"\r\noak;3;4;\r\n")};
}

std::vector<Bytes> path_seeds() {
    std::vector<Bytes> seeds = content_files("paths", {"pines.json", "woodland.json"});
    seeds.push_back(as_bytes(
        R"({"keys":[{"time_s":0,"at":[0,1,2],"yaw_deg":10,"pitch_deg":-5},{"time_s":1.5,"at":[3,4],"look_at":[0,0]}]})"));
    return seeds;
}

std::vector<Bytes> plant_seeds() { return {pack_plant(made_plant())}; }

std::vector<Bytes> placed_seeds() {
    PlacedPlants placed{{"oak", "fern"}, {}};
    for (uint16_t i = 0; i < 6; ++i)
        placed.plants.push_back({i * 128, -i * 64, uint16_t(i % 2), i, 0x1ff7fdffu, pack_scale(1.0f), 3});
    return {as_bytes(write_placed(placed)), as_bytes(write_placed({}))};
}

std::vector<Bytes> tiles_seeds() {
    const MadeTiles made = make_tile_tree(2, 0, 6, 3);
    const std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("hostile_seed_" + std::to_string(::getpid()) + ".tiles");
    const Status written = write_tile_pack(path.string(), made.nodes, made.scene, made.plants, 7);
    Bytes bytes = written ? read_file(path) : Bytes();
    std::filesystem::remove(path);
    return {std::move(bytes)};
}

std::vector<Bytes> world_seeds() {
    PopulatedScene world;
    world.scene.name = "a \"world\"";
    world.scene.models = {{"oak 0", "plants/oak.plant", 0, 1.0f}, {"fern", "plants/fern.plant", 0, 1.5f}};
    world.model_content_hashes = {100, 101};
    world.packs = {{"tiles.tiles", 17, 30, 1234567890123u}};
    world.terrain_json = R"({"flat":{"size_m":100,"height_m":0.1}})";
    world.scene.camera_path = {{0.0, Camera{}}, {1.5, Camera{}}};
    return {as_bytes(write_populated_scene(world))};
}

std::vector<Bytes> terrain_seeds() {
    return {
        as_bytes(R"({"flat":{"size_m":64,"cell_m":4,"height_m":0.5},"center":[1,2,3]})"),
        as_bytes(
            R"({"procedural":{"size_m":128,"cell_m":4,"seed":1,"amplitude_m":8,"wavelength_m":60,"octaves":3,"roughness":0.45,"ridges":0.3,"rim_m":3,
"valley":{"from":[0,64],"to":[0,-64],"width_m":20,"depth_m":6},"level":{"center":[0,20],"radius_m":25}},
"ground":{"meadow":[0.09,0.12,0.04],"dry":[0.165,0.15,0.065],"soil":[0.16,0.11,0.07],"rock":[0.23,0.215,0.19],"dry_share":0.3,"soil_share":0.12,"rock_slope_deg":38,"variation":0.35,"patch_m":45,"seed":1,
"paint":[{"region":{"circle":{"center":[0,20],"radius_m":5}},"color":[0.2,0.15,0.1],"edge_m":1,"strength":1}]}})")};
}

std::vector<Bytes> pgm_seeds() {
    return {as_bytes("P5\n# heights\n3 2\n255\nabcdef"),
            as_bytes("P5 2 2 65535\n" + std::string("\0\1\2\3\4\5\6\7", 8))};
}

std::vector<Bytes> heights_pfm_seeds() {
    const float heights[] = {0.0f, 1.5f, -2.0f, 3.25f};
    return {
        as_bytes("Pf\n2 2\n-1.0\n" + std::string(reinterpret_cast<const char*>(heights), sizeof heights))};
}

std::vector<Bytes> r16_seeds() { return {as_bytes(std::string("\0\1\2\3\4\5\6\7", 8))}; }

std::vector<Bytes> ground_seeds() {
    HeightField field;
    field.columns = 4;
    field.rows = 3;
    field.heights_m = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    return {pack_ground(field, std::vector<uint32_t>(build_patches(field).word_count)).bytes};
}

std::vector<Bytes> ppm_seeds() { return {as_bytes("P6\n# a picture\n2 2\n255\nabcdefghijkl")}; }

std::vector<Bytes> pnm_seeds() {
    return {as_bytes("P5\n# a map\n2 2\n255\nabcd"), as_bytes("P5 2 1 60000 abcd"), as_bytes("P6 1 1 255 abc")};
}

std::vector<Bytes> pfm_seeds() {
    const float pixels[12] = {0.0f, 1.0f, 2.0f};
    return {as_bytes("PF\n2 2\n-1.0\n" + std::string(reinterpret_cast<const char*>(pixels), sizeof pixels))};
}

// 2 x 2 pixels, colour and alpha.
std::vector<Bytes> png_seeds() {
    static constexpr unsigned char k_png[] = {
        137, 80, 78, 71,  13,  10, 26,  10,  0,   0,   0,   13,  73,  72,  68,  82,  0,   0,  0,  2,  0,
        0,   0,  2,  8,   6,   0,  0,   0,   114, 182, 13,  36,  0,   0,   0,   26,  73,  68, 65, 84, 120,
        156, 99, 96, 96,  100, 98, 102, 97,  101, 99,  103, 224, 226, 230, 225, 229, 227, 23, 16, 4,  0,
        3,   30, 0,  137, 243, 59, 101, 243, 0,   0,   0,   0,   73,  69,  78,  68,  174, 66, 96, 130};
    return {as_bytes(std::string_view(reinterpret_cast<const char*>(k_png), sizeof k_png))};
}

std::vector<Bytes> flight_summary_seeds() {
    return {as_bytes(
        R"({"scene":{"name":"meadow","file":"meadow.eco.json"},"settings":{"width":64,"height":48,"repeats":5},"machine":{"processor":"a processor","threads":2}})")};
}

std::vector<Bytes> flight_frames_seeds() {
    std::string table = "frame,repeat,FrameTime,vertices,allocations\n";
    for (int repeat = 0; repeat < 5; ++repeat)
        for (int frame = 0; frame < 2; ++frame)
            table += std::to_string(frame) + "," + std::to_string(repeat) + ",1" + std::to_string(repeat) + ".5,1000,3\n";
    return {as_bytes(table)};
}

}  // namespace coppice::hostile
