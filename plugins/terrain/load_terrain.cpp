#include "plugins/terrain/load_terrain.h"

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <fmt/format.h>
#include "plugins/terrain/build_patches.h"
#include "plugins/terrain/color_ground.h"
#include "plugins/terrain/grow_heights.h"
#include "plugins/shared/json_object.h"
#include "plugins/shared/noise.h"
#include "plugins/terrain/read_heights.h"

namespace coppice {
namespace {

class LoadedTerrain final : public Terrain {
  public:
    // light: as Terrain::light, or empty where nothing shades the ground yet.
    LoadedTerrain(HeightField field, const GroundSettings& settings, std::vector<float> light,
                  dvec3 origin_world)
        : field_(std::move(field)), origin_world_(origin_world), mesh_(build_patches(field_)) {
        ground_.normals = make_normals(field_);
        ground_.colors_linear = color_ground(field_, ground_.normals, settings, origin_world_);
        ground_.light = std::move(light);
        ground_.light.resize(field_.heights_m.size(), 1.0f);
        for (const TerrainPatch& patch : mesh_.patches) bounds_local_.include(patch.bounds_local);
    }

    dvec3 origin_world() const override { return origin_world_; }
    Box bounds_local() const override { return bounds_local_; }
    float height_at(float x_local, float z_local) const override {
        return field_.height_at(x_local, z_local);
    }
    vec3 normal_at(float x_local, float z_local) const override {
        auto [column, row, u, v] = field_.place_at(x_local, z_local);
        const vec3* normal = &ground_.normals[size_t(row) * field_.columns + column];
        vec3 north = normal[0] + (normal[1] - normal[0]) * u;
        vec3 south = normal[field_.columns] + (normal[field_.columns + 1] - normal[field_.columns]) * u;
        return normalize_or(north + (south - north) * v, vec3(0, 1, 0));
    }
    std::span<const TerrainPatch> patches() const override { return mesh_.patches; }
    std::span<const TerrainLevel> levels() const override { return mesh_.levels; }
    std::span<const PackedVertex> vertices() const override {
        std::lock_guard lock(mutex_);
        if (!colored_) color_vertices(field_, ground_, mesh_);
        colored_ = true;
        return mesh_.vertices;
    }
    void shade(float x_local, float z_local, float radius_m, float amount) override;
    TerrainLayout layout() const override {
        return {vec2(field_.x_of(0), field_.z_of(0)), field_.cell_m, field_.columns - 1, field_.rows - 1};
    }
    std::span<const float> least_heights() const override { return mesh_.least_heights; }
    std::span<const float> light() const override { return ground_.light; }

  private:
    HeightField field_;
    dvec3 origin_world_;
    GroundSurface ground_;
    Box bounds_local_;
    mutable std::mutex mutex_;
    mutable TerrainMesh mesh_;  // its surface words are made when first asked for, after all shading
    mutable bool colored_ = false;
};

void LoadedTerrain::shade(float x_local, float z_local, float radius_m, float amount) {
    if (!(radius_m > 0.0f) || !std::isfinite(x_local) || !std::isfinite(z_local)) return;
    constexpr float k_darkest = 0.18f;  // under any number of crowns
    amount = amount > 0.0f ? std::min(amount, 1.0f) : 0.0f;
    // What is smaller than a cell darkens the nearest samples in proportion to its area.
    float reach_m = std::min(std::max(radius_m, field_.cell_m * 1.25f), 1000.0f);
    amount *= std::min(1.0f, (radius_m / reach_m) * (radius_m / reach_m));
    float column_mid = x_local / field_.cell_m + float(field_.columns - 1) * 0.5f;
    float row_mid = z_local / field_.cell_m + float(field_.rows - 1) * 0.5f;
    float reach = reach_m / field_.cell_m;
    auto first = [](float at) { return at > 0.0f ? int64_t(std::min(at, 1e6f)) + 1 : int64_t(0); };
    auto last = [](float at, uint32_t count) {
        return at < 0.0f ? -1 : int64_t(std::min(at, float(count - 1)));
    };
    int64_t column_first = first(column_mid - reach), column_last = last(column_mid + reach, field_.columns);
    int64_t row_first = first(row_mid - reach), row_last = last(row_mid + reach, field_.rows);
    if (field_.periodic) {  // the shade goes on beyond the border
        auto middle = [](float at, uint32_t count) {
            at = std::fmod(at, float(count - 1));
            return at < 0.0f ? at + float(count - 1) : at;
        };
        column_mid = middle(column_mid, field_.columns);
        row_mid = middle(row_mid, field_.rows);
        reach = std::min(reach, 0.49f * float(std::min(field_.columns, field_.rows) - 1));
        column_first = int64_t(std::floor(column_mid - reach)) + 1;
        column_last = int64_t(std::floor(column_mid + reach));
        row_first = int64_t(std::floor(row_mid - reach)) + 1;
        row_last = int64_t(std::floor(row_mid + reach));
    }
    std::lock_guard lock(mutex_);
    for (int64_t row = row_first; row <= row_last; ++row)
        for (int64_t column = column_first; column <= column_last; ++column) {
            float dx = float(column) - column_mid, dz = float(row) - row_mid;
            float away = std::sqrt(dx * dx + dz * dz) / reach;
            float& light = ground_.light[field_.wrapped_sample(column, row)];
            light = std::max(k_darkest, light * (1.0f - amount * (1.0f - smooth_step(0.35f, 1.0f, away))));
        }
    if (column_first <= 0 || row_first <= 0 || column_last + 1 >= field_.columns ||
        row_last + 1 >= field_.rows)
        repeat_border(field_, ground_.light);
    colored_ = false;
}

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

GroundSettings read_ground(JsonObject object) {
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

Result<std::vector<float>> read_light(const std::string& path, const HeightField& field) {
    COPPICE_TRY(HeightField light, read_heights(path, {}));
    if (light.columns != field.columns || light.rows != field.rows)
        return fail(ErrorId::value_out_of_range, path, "header",
                    fmt::format("{} x {} samples of light", light.columns, light.rows),
                    fmt::format("the ground's {} x {}", field.columns, field.rows));
    if (std::any_of(light.heights_m.begin(), light.heights_m.end(),
                    [](float v) { return !(v >= 0.0f && v <= 1.0f); }))
        return fail(ErrorId::value_out_of_range, path, "", "light that is not in [0, 1]",
                    "1: nothing shades it");
    return std::move(light.heights_m);
}

}  // namespace

Result<std::shared_ptr<Terrain>> load_terrain(std::string_view json, const std::string& base_dir,
                                              const std::string& file) {
    COPPICE_TRY(JsonDocument document, JsonDocument::parse(json, file));
    JsonObject object(document, document.root(), "terrain");
    auto center =
        object.numbers("center", 3, -k_farthest_m, k_farthest_m, std::vector<double>{0.0, 0.0, 0.0});
    GroundSettings ground;
    if (object.has("ground")) ground = read_ground(object.object("ground"));
    const std::string light_file = object.text("light", "");
    size_t kind = object.one_of({"flat", "heights", "procedural"});
    object.close();
    COPPICE_CHECK(document.status());

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
    std::vector<float> light;
    if (!light_file.empty()) {
        COPPICE_TRY(
            light,
            read_light((std::filesystem::path(base_dir) / light_file).lexically_normal().string(), field));
    }
    return std::make_shared<LoadedTerrain>(std::move(field), ground, std::move(light),
                                           dvec3(center[0], center[1], center[2]));
}

}  // namespace coppice
