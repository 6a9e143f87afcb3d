#include "plugins/terrain/load_terrain.h"

#include <cstring>
#include <map>
#include <fmt/format.h>
#include <unistd.h>
#include <gtest/gtest.h>
#include "plugins/vegetation/plant/plant.h"
#include "runtime/core/file.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"
#include "runtime/core/random.h"

namespace coppice {
namespace {

constexpr const char* k_hills =
    R"({"procedural": {"size_m": 200, "cell_m": 1.6, "seed": 5, "amplitude_m": 12, "wavelength_m": 60, "ridges": 0.4,
        "rim_m": 9, "valley": {"from": [-90, 0], "to": [90, 10], "width_m": 50, "depth_m": 6}}})";

std::shared_ptr<Terrain> load(const std::string& json, const std::string& folder = ".") {
    auto terrain = load_terrain(json, folder, "scene.eco.json");
    EXPECT_TRUE(terrain.has_value()) << (terrain ? "" : to_string(terrain.error()));
    return terrain ? *terrain : nullptr;
}

Error fault_of(const std::string& json, const std::string& folder = ".") {
    auto terrain = load_terrain(json, folder, "scene.eco.json");
    EXPECT_FALSE(terrain.has_value()) << json;
    return terrain ? Error{} : terrain.error();
}

class TemporaryFile {
  public:
    TemporaryFile(const std::string& name, std::string_view bytes)
        : name_("terrain_test_" + std::to_string(::getpid()) + "_" + name) {
        EXPECT_TRUE(write_text_file(path(), bytes).has_value());
    }
    ~TemporaryFile() { std::remove(path().c_str()); }
    std::string path() const { return testing::TempDir() + name_; }
    std::string json(const char* more = "") const {
        return fmt::format(R"({{"heights": {{"file": "{}", "cell_m": 2{}}}}})", name_, more);
    }

  private:
    std::string name_;
};

vec3 position(const PackedVertex& v) { return {v.x_plant, v.y_plant, v.z_plant}; }

// Cells along a side of a square patch's level: its surface takes 6 a^2 vertices, its skirts 24 a behind them.
uint32_t cells_across(const TerrainLevel& level) {
    uint32_t a = 1;
    while (6 * a * a + 24 * a < level.vertex_count) ++a;
    return a;
}

// The triangles of a level, without its skirts.
std::vector<std::array<vec3, 3>> upper_triangles(const Terrain& terrain, const TerrainLevel& level) {
    std::vector<std::array<vec3, 3>> triangles;
    for (uint32_t v = level.first_vertex; v < level.first_vertex + level.vertex_count; v += 3) {
        std::array<vec3, 3> t;
        for (uint32_t c = 0; c < 3; ++c) t[c] = position(terrain.vertices()[v + c]);
        vec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
        if (normal.y < 0.46f * glm::length(normal)) continue;  // skirts fall two metres in one
        triangles.push_back(t);
    }
    return triangles;
}

TEST(LoadTerrain, WhatIsDrawnIsStoodUpon) {
    auto terrain = load(k_hills);
    Random random(1);
    size_t checked = 0;
    for (const TerrainPatch& patch : terrain->patches())
        for (const auto& t : upper_triangles(*terrain, terrain->levels()[patch.first_level])) {
            float a = random.next_unit(), b = random.next_unit() * (1.0f - a);
            vec3 at = t[0] + (t[1] - t[0]) * a + (t[2] - t[0]) * b;
            ASSERT_NEAR(terrain->height_at(at.x, at.z), at.y, 2e-4f);
            ++checked;
        }
    EXPECT_EQ(checked, 2u * 128 * 128);
}

TEST(LoadTerrain, LevelErrorsHoldAndAreReached) {
    auto terrain = load(k_hills);
    Random random(2);
    for (const TerrainPatch& patch : terrain->patches()) {
        EXPECT_EQ(patch.level_count, 6u);
        EXPECT_EQ(terrain->levels()[patch.first_level].error_m, 0.0f);
        for (uint32_t l = 1; l < patch.level_count; ++l) {
            const TerrainLevel& level = terrain->levels()[patch.first_level + l];
            float worst = 0.0f;
            for (const auto& t : upper_triangles(*terrain, level)) {
                // Along the sample grid, where the greatest difference is.
                float cell = 200.0f / 128.0f;
                vec3 low = glm::min(glm::min(t[0], t[1]), t[2]), high = glm::max(glm::max(t[0], t[1]), t[2]);
                for (float x = low.x; x <= high.x + 0.01f; x += cell)
                    for (float z = low.z; z <= high.z + 0.01f; z += cell) {
                        vec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
                        vec2 e1(t[1].x - t[0].x, t[1].z - t[0].z), e2(t[2].x - t[0].x, t[2].z - t[0].z);
                        vec2 d(x - t[0].x, z - t[0].z);
                        float det = e1.x * e2.y - e1.y * e2.x;
                        float a = (d.x * e2.y - d.y * e2.x) / det, b = (e1.x * d.y - e1.y * d.x) / det;
                        if (a < -1e-4f || b < -1e-4f || a + b > 1.0001f) continue;
                        float y = t[0].y - (n.x * d.x + n.z * d.y) / n.y;
                        worst = std::max(worst, std::fabs(y - terrain->height_at(x, z)));
                    }
            }
            float spacing = 200.0f / 128.0f * float(1 << l);
            EXPECT_NEAR(level.error_m, std::max(worst, spacing / 10.0f), 2e-3f) << "level " << l;
            EXPECT_GE(level.error_m, terrain->levels()[patch.first_level + l - 1].error_m * 0.3f);
        }
    }
}

// Wherever two patches meet, at any pair of levels, the skirt of the higher one reaches the lower one.
TEST(LoadTerrain, SkirtsCoverTheGapsBetweenLevels) {
    auto terrain = load(k_hills);
    auto patches = terrain->patches();
    uint32_t across = 4;
    ASSERT_EQ(patches.size(), across * across);
    struct Edge {
        std::map<int, std::pair<float, float>> span;  // by place along the edge: top and bottom
    };
    // Of a patch's border to the east or west: the quads that hang there stand behind those to the north and south.
    auto edge_at = [&](const TerrainLevel& level, bool east) {
        Edge edge;
        uint32_t cells = cells_across(level), first = level.first_vertex + 6 * cells * cells + 12 * cells;
        for (uint32_t cell = 0; cell < cells; ++cell) {
            const PackedVertex* quad = &terrain->vertices()[first + 6 * cell + (east ? 6 * cells : 0)];
            for (auto [top, bottom] : {std::pair(0, 1), std::pair(5, 2)}) {
                EXPECT_FLOAT_EQ(quad[top].z_plant, quad[bottom].z_plant);
                EXPECT_EQ(quad[bottom].x_plant > quad[top].x_plant, east);  // leans outwards
                edge.span[int(std::floor(quad[top].z_plant * 100.0f + 0.5f))] = {quad[top].y_plant,
                                                                                 quad[bottom].y_plant};
            }
        }
        return edge;
    };
    auto between = [](const Edge& edge, int z, bool top) {
        auto after = edge.span.lower_bound(z);
        auto pick = [top](const auto& item) { return top ? item.second.first : item.second.second; };
        if (after->first == z) return pick(*after);
        auto before = std::prev(after);
        float t = float(z - before->first) / float(after->first - before->first);
        return pick(*before) * (1.0f - t) + pick(*after) * t;
    };
    size_t gaps = 0;
    for (uint32_t p : {0u, 5u, 9u}) {
        for (uint32_t l = 0; l < 6; ++l)
            for (uint32_t k = 0; k < 6; ++k) {
                Edge west = edge_at(terrain->levels()[patches[p].first_level + l], true);
                Edge east = edge_at(terrain->levels()[patches[p + 1].first_level + k], false);
                const Edge& finer = west.span.size() > east.span.size() ? west : east;
                for (const auto& [z, ignored] : finer.span) {
                    float top_west = between(west, z, true), top_east = between(east, z, true);
                    gaps += std::fabs(top_west - top_east) > 1e-3f;
                    ASSERT_LE(between(west, z, false), top_east);
                    ASSERT_LE(between(east, z, false), top_west);
                }
            }
    }
    EXPECT_GT(gaps, 100u);  // there was something to cover
}

TEST(LoadTerrain, BoundsHoldEveryVertex) {
    auto terrain = load(k_hills);
    for (const TerrainPatch& patch : terrain->patches())
        for (uint32_t l = patch.first_level; l < patch.first_level + patch.level_count; ++l) {
            const TerrainLevel& level = terrain->levels()[l];
            for (uint32_t v = level.first_vertex; v < level.first_vertex + level.vertex_count; ++v) {
                vec3 p = position(terrain->vertices()[v]);
                ASSERT_TRUE(glm::all(glm::lessThanEqual(patch.bounds_local.min, p)) &&
                            glm::all(glm::lessThanEqual(p, patch.bounds_local.max)));
            }
        }
}

TEST(LoadTerrain, SameBytesOnAnyNumberOfThreads) {
    auto hash = [] {
        auto terrain = load(k_hills);
        auto vertices = terrain->vertices();
        return hash_bytes(vertices.data(), vertices.size_bytes());
    };
    set_thread_limit(1);
    uint64_t one = hash();
    set_thread_limit(0);
    EXPECT_EQ(one, hash());
}

vec3 mean_color(const Terrain& terrain, uint32_t level) {
    vec3 sum(0.0f);
    float count = 0.0f;
    for (const TerrainPatch& patch : terrain.patches()) {
        const TerrainLevel& at = terrain.levels()[patch.first_level + level];
        uint32_t across = 1u << (5 - level);
        for (uint32_t v = at.first_vertex; v < at.first_vertex + 6 * across * across; ++v) {
            sum += decode_surface(terrain.vertices()[v].surface).color_linear;
            count += 1.0f;
        }
    }
    return sum / count;
}

TEST(LoadTerrain, CoarserLevelsKeepTheMeanColor) {
    auto terrain = load(k_hills);
    vec3 full = mean_color(*terrain, 0), middle = mean_color(*terrain, 3);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(middle[c], full[c], 0.04f * full[c]);
    EXPECT_GT(full.y, full.z);  // a meadow is green, not blue
}

// A color of 16 bits has few reds and blues: ground of one color must not show it in spots of many hues.
TEST(LoadTerrain, GroundOfOneColorHasOneHueAndItsMean) {
    auto terrain = load(R"({"flat": {"size_m": 256, "cell_m": 2}, "ground": {"meadow": [0.062, 0.083, 0.027],
        "dry_share": 0, "soil_share": 0, "variation": 0.3}})");
    double ratio_sum = 0.0, squares = 0.0, count = 0.0;
    for (const TerrainPatch& patch : terrain->patches()) {
        const TerrainLevel& level = terrain->levels()[patch.first_level];
        for (uint32_t v = level.first_vertex; v < level.first_vertex + level.vertex_count; ++v) {
            vec3 color = decode_surface(terrain->vertices()[v].surface).color_linear;
            double ratio = double(color.x / color.y) / (0.062 / 0.083);
            ratio_sum += ratio;
            squares += (ratio - 1.0) * (ratio - 1.0);
            count += 1.0;
        }
    }
    EXPECT_NEAR(ratio_sum / count, 1.0, 0.015);
    EXPECT_LT(std::sqrt(squares / count), 0.06);  // 0.1 where each channel is rounded by itself
}

TEST(LoadTerrain, ShadingDarkensAroundOnly) {
    auto plain = load(k_hills), shaded = load(k_hills);
    shaded->shade(20.0f, -10.0f, 9.0f, 0.6f);
    const TerrainPatch* patch = plain->patches().data();
    size_t darker = 0;
    dvec3 plain_sum(0.0), shaded_sum(0.0);
    for (size_t p = 0; p < plain->patches().size(); ++p) {
        const TerrainLevel& level = plain->levels()[patch[p].first_level];
        for (uint32_t v = level.first_vertex; v < level.first_vertex + level.vertex_count; ++v) {
            vec3 at = position(plain->vertices()[v]);
            float away = glm::length(vec2(at.x - 20.0f, at.z + 10.0f));
            Surface a = decode_surface(plain->vertices()[v].surface),
                    b = decode_surface(shaded->vertices()[v].surface);
            if (away > 9.01f) {
                ASSERT_EQ(a.openness, b.openness);
                // Rounding is passed on, and either way to keep the hue; the mean stays.
                ASSERT_NEAR(a.color_linear.y, b.color_linear.y, 0.045f);
                plain_sum += dvec3(a.color_linear);
                shaded_sum += dvec3(b.color_linear);
            } else if (away < 3.0f) {
                EXPECT_LT(b.color_linear.y, a.color_linear.y);
                EXPECT_LT(b.openness, 0.6f);
                ++darker;
            }
        }
    }
    EXPECT_GT(darker, 20u);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(shaded_sum[c], plain_sum[c], 0.003 * plain_sum[c]);
    shaded->shade(NAN, 0.0f, 5.0f, 1.0f);
    shaded->shade(1e30f, -1e30f, 1e30f, 1.0f);
    EXPECT_FALSE(shaded->vertices().empty());
}

TEST(LoadTerrain, VerticesAreWrittenAsTheyAreKept) {
    auto terrain = load(k_hills);
    std::vector<PackedVertex> all(terrain->vertex_count());
    terrain->write_vertices(all);
    const auto kept = terrain->vertices();
    ASSERT_EQ(kept.size(), all.size());
    EXPECT_EQ(std::memcmp(kept.data(), all.data(), kept.size_bytes()), 0);
    for (uint32_t l = 0; l < terrain->levels().size(); ++l) {
        const TerrainLevel& level = terrain->levels()[l];
        std::vector<PackedVertex> one(level.vertex_count);
        terrain->write_level(l, one);
        ASSERT_EQ(std::memcmp(&kept[level.first_vertex], one.data(), one.size() * sizeof one[0]), 0) << l;
    }
}

TEST(LoadTerrain, AShadeMayComeAfterTheVertices) {
    auto at_once = load(k_hills), later = load(k_hills);
    at_once->shade(20.0f, -10.0f, 9.0f, 0.6f);
    EXPECT_NE(
        std::memcmp(later->vertices().data(), at_once->vertices().data(), at_once->vertices().size_bytes()),
        0);
    later->shade(20.0f, -10.0f, 9.0f, 0.6f);
    ASSERT_EQ(later->vertices().size(), at_once->vertices().size());
    EXPECT_EQ(
        std::memcmp(later->vertices().data(), at_once->vertices().data(), at_once->vertices().size_bytes()),
        0);
}

TEST(LoadTerrain, FlatIsFlatAndPaintShows) {
    auto terrain =
        load(R"({"flat": {"size_m": 128, "cell_m": 1, "height_m": 3}, "center": [100, 0, 50], "ground":
        {"paint": [{"region": {"corridor": {"points": [[100, 0], [100, 100]], "width_m": 6}}, "color": [1, 0, 0]}]}})");
    EXPECT_EQ(terrain->height_at(17.3f, -5.1f), 3.0f);
    EXPECT_EQ(terrain->height_at(1e9f, NAN), 3.0f);
    EXPECT_EQ(terrain->origin_world(), dvec3(100, 0, 50));
    size_t on_path = 0;
    for (const PackedVertex& v : terrain->vertices()) {
        vec3 color = decode_surface(v.surface).color_linear;
        if (std::fabs(v.x_plant) < 1.1f && v.y_plant == 3.0f) {
            on_path += color.x > 0.5f && color.y < 0.2f;
        } else if (std::fabs(v.x_plant) > 40.0f) {
            ASSERT_LT(color.x, 0.5f);
        }
    }
    EXPECT_GT(on_path, 100u);
}

TEST(LoadTerrain, ReadsPgm) {
    std::string pixels = "P5\n# a comment\n3 2\n65535\n";
    for (uint32_t value : {0u, 65535u, 32768u, 256u, 1u, 0u}) {
        pixels += char(value >> 8);
        pixels += char(value & 255u);
    }
    TemporaryFile file("a.pgm", pixels);
    auto terrain = load(file.json(R"(, "lowest_m": 10, "highest_m": 20)"), testing::TempDir());
    EXPECT_FLOAT_EQ(terrain->height_at(-2.0f, -1.0f), 10.0f);
    EXPECT_FLOAT_EQ(terrain->height_at(0.0f, -1.0f), 20.0f);
    EXPECT_NEAR(terrain->height_at(2.0f, -1.0f), 15.0f, 1e-3f);
    EXPECT_NEAR(terrain->height_at(-2.0f, 1.0f), 10.0f + 10.0f * 256.0f / 65535.0f, 1e-4f);
    // One cell, two triangles, cut from the corner of least x and z.
    EXPECT_NEAR(terrain->height_at(-1.0f, 0.0f), 10.0f, 1e-3f);
}

TEST(LoadTerrain, ReadsPfmOfBothByteOrders) {
    for (bool big : {false, true}) {
        std::string pixels = fmt::format("Pf\n2 2\n{}\n", big ? "1.0" : "-1.0");
        for (float value : {1.5f, 2.5f, 3.5f, 4.5f}) {
            char bytes[4];
            std::memcpy(bytes, &value, 4);
            if (big) std::reverse(bytes, bytes + 4);
            pixels.append(bytes, 4);
        }
        TemporaryFile file("b.pfm", pixels);
        auto terrain = load(file.json(), testing::TempDir());
        EXPECT_EQ(terrain->height_at(-1.0f, 1.0f), 1.5f);  // the first row is the lowest
        EXPECT_EQ(terrain->height_at(1.0f, -1.0f), 4.5f);
    }
}

TEST(LoadTerrain, ReadsRaw) {
    std::string pixels("\x00\x00\xff\xff\x00\x00\x00\x00", 8);
    TemporaryFile file("c.r16", pixels);
    EXPECT_FLOAT_EQ(load(file.json(), testing::TempDir())->height_at(1.0f, -1.0f), 100.0f);
    EXPECT_EQ(fault_of(file.json(R"(, "samples": [3, 2])"), testing::TempDir()).id, ErrorId::file_truncated);
}

TEST(LoadTerrain, FieldsThatAreNoMultipleOfThePatchAreWhole) {
    std::string pixels = "P5 41 36 255\n" + std::string(41 * 36, '\x40');
    TemporaryFile file("d.pgm", pixels);
    auto terrain = load(file.json(), testing::TempDir());
    double area = 0.0;
    for (const TerrainPatch& patch : terrain->patches())
        for (uint32_t l = 0; l < patch.level_count; ++l) {
            double level_area = 0.0;
            Box bounds;
            for (const auto& t : upper_triangles(*terrain, terrain->levels()[patch.first_level + l])) {
                level_area += 0.5 * double(glm::cross(t[1] - t[0], t[2] - t[0]).y);
                for (vec3 corner : t) bounds.include(corner);
            }
            if (l == 0) area += level_area;
            vec3 size = bounds.size();
            EXPECT_NEAR(level_area, double(size.x * size.z), 0.1);
        }
    EXPECT_NEAR(area, 80.0 * 70.0, 0.1);
}

TEST(LoadTerrain, EveryBadFileOnce) {
    struct Case {
        const char* name;
        std::string bytes;
        ErrorId id;
    };
    float not_a_number = NAN;
    std::string nan_bytes(reinterpret_cast<const char*>(&not_a_number), 4);
    for (const Case& bad : std::initializer_list<Case>{
             {"x1.pgm", "", ErrorId::format_unknown},
             {"x2.pgm", "P6 2 2 255\n............", ErrorId::format_unknown},
             {"x3.pgm", "P5 2 2", ErrorId::format_unknown},
             {"x4.pgm", "P5 2 2 65535\n1234567", ErrorId::file_truncated},
             {"x5.pgm", "P5 2 2 255", ErrorId::file_truncated},
             {"x6.pgm", "P5 1 2 255\n12", ErrorId::value_out_of_range},
             {"x7.pgm", "P5 4000000000 4000000000 255\n12", ErrorId::limit_exceeded},
             {"x8.pgm", "P5 99999999999999999999999 2 255\n12", ErrorId::format_unknown},
             {"x9.pgm", "P5 2 2 7\n\x01\x02\x03\x08", ErrorId::value_out_of_range},
             {"y1.pfm", "Pf 2 2 0\n1234123412341234", ErrorId::format_unknown},
             {"y2.pfm", "Pf 2 2 -1\n123412341234" + nan_bytes, ErrorId::value_out_of_range},
             {"y3.pfm", "Pf 2 2 -1\n12341234", ErrorId::file_truncated},
             {"z1.r16", "1234567", ErrorId::value_out_of_range},
             {"z2.r16", "", ErrorId::value_out_of_range},
         }) {
        TemporaryFile file(bad.name, bad.bytes);
        Error fault = fault_of(file.json(), testing::TempDir());
        EXPECT_EQ(fault.id, bad.id) << bad.name << ": " << to_string(fault);
        EXPECT_TRUE(fault.file.ends_with(bad.name));
        EXPECT_FALSE(fault.remedy.empty());
    }
    EXPECT_EQ(fault_of(R"({"heights": {"file": "nowhere.pgm"}})").id, ErrorId::file_missing);
}

TEST(LoadTerrain, EveryBadDescriptionOnce) {
    struct Case {
        const char* json;
        ErrorId id;
        const char* place;
    };
    for (const Case& bad : std::initializer_list<Case>{
             {"{", ErrorId::syntax, "line 1"},
             {"[]", ErrorId::syntax, "terrain"},
             {"{}", ErrorId::syntax, "terrain"},
             {R"({"flat": {}, "procedural": {}})", ErrorId::syntax, "terrain"},
             {R"({"flat": 3})", ErrorId::syntax, "terrain.flat"},
             {R"({"flat": {"size": 3}})", ErrorId::name_unknown, "terrain.flat"},
             {R"({"flat": {"cell_m": -1}})", ErrorId::value_out_of_range, "terrain.flat.cell_m"},
             {R"({"flat": {"cell_m": 1e999}})", ErrorId::syntax, ""},
             {R"({"flat": {"size_m": 100000, "cell_m": 0.1}})", ErrorId::limit_exceeded,
              "terrain.flat.cell_m"},
             {R"({"procedural": {"octaves": 0}})", ErrorId::value_out_of_range, "terrain.procedural.octaves"},
             {R"({"procedural": {"valley": {"from": [0], "to": [1, 1]}}})", ErrorId::value_out_of_range,
              "terrain.procedural.valley.from"},
             {R"({"flat": {}, "ground": {"meadow": [1, 2, 3]}})", ErrorId::value_out_of_range,
              "terrain.ground.meadow"},
             {R"({"flat": {}, "ground": {"paint": [{}]}})", ErrorId::syntax,
              "terrain.ground.paint[0].region"},
             {R"({"heights": {}})", ErrorId::syntax, "terrain.heights.file"},
             {R"({"packed": {"file": "a.ground"}})", ErrorId::syntax, "terrain.packed.content"},
             {R"({"packed": {"file": "a.ground", "content": ""}, "ground": {}})", ErrorId::name_unknown,
              "terrain"},
         }) {
        Error fault = fault_of(bad.json);
        EXPECT_EQ(fault.id, bad.id) << bad.json << ": " << to_string(fault);
        EXPECT_TRUE(fault.place.starts_with(bad.place)) << bad.json << ": " << to_string(fault);
        EXPECT_EQ(fault.file, "scene.eco.json");
    }
}

}  // namespace
}  // namespace coppice
