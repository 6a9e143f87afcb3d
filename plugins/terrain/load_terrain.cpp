#include "plugins/terrain/load_terrain.h"

#include <filesystem>
#include <fmt/format.h>
#include "plugins/shared/json_object.h"
#include "plugins/shared/noise.h"
#include "plugins/terrain/field_terrain.h"
#include "plugins/terrain/grow_heights.h"
#include "plugins/terrain/read_heights.h"
#include "runtime/core/hash.h"

namespace coppice {
namespace {

bool check_cells(JsonObject& object, float size_m, float cell_m) {
    double cells = double(size_m) / double(cell_m) + k_patch_cells;
    if (cells * cells <= k_terrain_cell_limit) return true;
    object.report(
        ErrorId::limit_exceeded, "cell_m", fmt::format("{:g} m over {:g} m", cell_m, size_m),
        fmt::format("at most {} cells in all: a longer cell_m or a smaller size_m", k_terrain_cell_limit));
    return false;
}

HeightField read_flat(JsonObject flat) {
    GrowHeightsSettings settings;
    settings.size_m = flat.real("size_m", 1.0f, 100000.0f, 1000.0f);
    settings.cell_m = flat.real("cell_m", 0.05f, 1000.0f, 4.0f);
    float height_m = flat.real("height_m", -10000.0f, 10000.0f, 0.0f);
    flat.close();
    if (!check_cells(flat, settings.size_m, settings.cell_m) || !flat.document().sound()) return {};
    HeightField field;
    uint32_t cells = cells_along(settings.size_m, settings.cell_m);
    field.columns = field.rows = cells + 1;
    field.cell_m = settings.size_m / float(cells);
    field.heights_m.assign(size_t(field.columns) * field.rows, height_m);
    return field;
}

// What makes one place of the ground unlike all others has no counterpart on the other side of a border.
void check_periodic(JsonObject& object, const GrowHeightsSettings& s) {
    for (const char* key : {"rim_m", "valley", "level"})
        if (object.has(key))
            object.report(ErrorId::value_out_of_range, key, "periodic ground cannot have it",
                          "leave it out, or leave out \"periodic\"");
    double waves = double(s.size_m) / double(s.wavelength_m);
    if (std::ldexp(waves, int(s.octaves)) > k_longest_noise_period)
        object.report(
            ErrorId::value_out_of_range, "wavelength_m",
            fmt::format("{:g} m, halved {} times, is too short to repeat", s.wavelength_m, s.octaves),
            "fewer octaves or a longer wavelength_m");
    if (waves < 1.0)
        object.report(
            ErrorId::value_out_of_range, "wavelength_m",
            fmt::format("{:g} m is longer than the ground, {:g} m, which repeats", s.wavelength_m, s.size_m),
            "at most size_m");
}

HeightField read_procedural(JsonObject object) {
    GrowHeightsSettings s;
    s.size_m = object.real("size_m", 1.0f, 100000.0f, s.size_m);
    s.cell_m = object.real("cell_m", 0.05f, 1000.0f, s.cell_m);
    s.seed = uint32_t(object.whole("seed", 0, 0xffffffffu, 1));
    s.amplitude_m = object.real("amplitude_m", 0.0f, 5000.0f, s.amplitude_m);
    s.wavelength_m = object.real("wavelength_m", 0.1f, 100000.0f, s.wavelength_m);
    s.octaves = uint32_t(object.whole("octaves", 1, 16, s.octaves));
    s.roughness = object.real("roughness", 0.0f, 1.0f, s.roughness);
    s.ridges = object.real("ridges", 0.0f, 1.0f, s.ridges);
    s.rim_m = object.real("rim_m", -5000.0f, 5000.0f, 0.0f);
    s.periodic = object.truth("periodic", false);
    if (object.has("valley")) {
        JsonObject valley = object.object("valley");
        s.valley_width_m = valley.real("width_m", 1.0f, 100000.0f, s.valley_width_m);
        s.valley_depth_m = valley.real("depth_m", -5000.0f, 5000.0f, 0.0f);
        for (const char* end : {"from", "to"}) {
            auto at = valley.numbers(end, 2, -1e6, 1e6);
            s.valley.emplace_back(at[0], at[1]);
        }
        valley.close();
    }
    if (object.has("level")) {
        JsonObject level = object.object("level");
        auto center = level.numbers("center", 2, -1e6, 1e6);
        s.level_center = dvec2(center[0], center[1]);
        s.level_radius_m = level.real("radius_m", 0.1f, 100000.0f);
        level.close();
    }
    if (s.periodic) check_periodic(object, s);
    object.close();
    if (!check_cells(object, s.size_m, s.cell_m) || !object.document().sound()) return {};
    return grow_heights(s);
}

GroundSettings read_ground_settings(JsonObject object) {
    GroundSettings ground;
    ground.meadow = object.color("meadow", 1.0f, ground.meadow);
    ground.dry = object.color("dry", 1.0f, ground.dry);
    ground.soil = object.color("soil", 1.0f, ground.soil);
    ground.rock = object.color("rock", 1.0f, ground.rock);
    ground.dry_share = object.real("dry_share", 0.0f, 1.0f, ground.dry_share);
    ground.soil_share = object.real("soil_share", 0.0f, 1.0f, ground.soil_share);
    ground.rock_slope_deg = object.real("rock_slope_deg", 0.0f, 90.0f, ground.rock_slope_deg);
    ground.variation = object.real("variation", 0.0f, 1.0f, ground.variation);
    ground.patch_m = object.real("patch_m", 0.5f, 100000.0f, ground.patch_m);
    ground.seed = uint32_t(object.whole("seed", 0, 0xffffffffu, ground.seed));
    if (object.has("paint"))
        for (JsonObject& entry : object.objects("paint")) {
            GroundPaint paint;
            if (const nlohmann::json* region = entry.find("region"))
                paint.region = read_region(entry.document(), *region, entry.place_of("region"));
            else
                entry.report(ErrorId::syntax, "region", "missing", "write the shape to paint");
            paint.color_linear = entry.color("color", 1.0f, paint.color_linear);
            paint.edge_m = entry.real("edge_m", 0.01f, 10000.0f, paint.edge_m);
            paint.strength = entry.real("strength", 0.0f, 1.0f, 1.0f);
            entry.close();
            ground.paint.push_back(std::move(paint));
        }
    object.close();
    return ground;
}

Result<HeightField> read_file(JsonObject object, const std::string& base_dir) {
    HeightFileSettings settings;
    std::string name = object.text("file");
    settings.cell_m = object.real("cell_m", 0.05f, 1000.0f, 4.0f);
    settings.lowest_m = object.real("lowest_m", -20000.0f, 20000.0f, 0.0f);
    settings.highest_m = object.real("highest_m", -20000.0f, 20000.0f, 100.0f);
    if (object.has("samples")) {
        auto samples = object.numbers("samples", 2, 2, k_terrain_side_limit);
        settings.raw_columns = uint32_t(samples[0]);
        settings.raw_rows = uint32_t(samples[1]);
    }
    object.close();
    COPPICE_CHECK(object.document().status());
    return read_heights((std::filesystem::path(base_dir) / name).lexically_normal().string(), settings);
}

// Paint on periodic ground stays inside, with all of its edge.
Status check_paint(const GroundSettings& ground, const HeightField& field, dvec2 center,
                   const std::string& file) {
    const dvec2 half_size = dvec2(field.columns - 1, field.rows - 1) * (0.5 * double(field.cell_m));
    for (size_t i = 0; i < ground.paint.size(); ++i) {
        const GroundPaint& paint = ground.paint[i];
        const auto [low, high] = paint.region.bounds();
        const double edge_m = k_paint_reach * double(paint.edge_m);
        if (glm::any(glm::lessThan(low - edge_m, center - half_size)) ||
            glm::any(glm::greaterThan(high + edge_m, center + half_size)))
            return fail(
                ErrorId::value_out_of_range, file, fmt::format("terrain.ground.paint[{}].region", i),
                fmt::format("reaches over the border of periodic ground of {:g} m", 2.0 * half_size.x),
                "paint that ends inside it, with its edge_m");
    }
    return {};
}

Result<std::shared_ptr<Terrain>> load_packed(JsonObject object, const std::string& base_dir,
                                             dvec3 origin_world) {
    const std::string name = object.text("file");
    const std::string content = object.text("content");
    object.close();
    COPPICE_CHECK(object.document().status());
    const std::string path = (std::filesystem::path(base_dir) / name).lexically_normal().string();
    COPPICE_TRY(PackedGround packed, read_ground(path));
    if (hash_to_hex(packed.content_hash) != content)
        return fail(ErrorId::file_corrupt, path, "head", "not the ground the scene was populated with",
                    "populate the scene again");
    return std::make_shared<FieldTerrain>(std::move(packed), origin_world);
}

}  // namespace

Result<std::shared_ptr<Terrain>> load_terrain(std::string_view json, const std::string& base_dir,
                                              const std::string& file) {
    COPPICE_TRY(JsonDocument document, JsonDocument::parse(json, file));
    JsonObject object(document, document.root(), "terrain");
    auto center =
        object.numbers("center", 3, -k_farthest_m, k_farthest_m, std::vector<double>{0.0, 0.0, 0.0});
    const dvec3 origin_world(center[0], center[1], center[2]);
    const size_t kind = object.one_of({"flat", "heights", "procedural", "packed"});
    const bool packed = kind == 3;
    GroundSettings ground;
    if (!packed && object.has("ground")) ground = read_ground_settings(object.object("ground"));
    object.close();
    COPPICE_CHECK(document.status());
    if (packed) return load_packed(object.object("packed"), base_dir, origin_world);

    HeightField field;
    if (kind == 1) {
        COPPICE_TRY(field, read_file(object.object("heights"), base_dir));
    } else {
        field = kind == 0 ? read_flat(object.object("flat")) : read_procedural(object.object("procedural"));
        COPPICE_CHECK(document.status());
    }
    if (field.periodic) {
        COPPICE_CHECK(check_paint(ground, field, dvec2(center[0], center[2]), file));
    }
    return std::make_shared<FieldTerrain>(std::move(field), std::move(ground), origin_world);
}

}  // namespace coppice
