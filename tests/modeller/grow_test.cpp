// What a user would notice of the species that come with Coppice: counts, height, sound geometry, the same
// plant twice.
#include "plugins/modeller/grow.h"

#include <algorithm>
#include <array>
#include <gtest/gtest.h>

#include <fmt/format.h>
#include "runtime/core/file.h"
#include "runtime/core/hash.h"

namespace coppice::modeller {
namespace {

struct Expected {
    const char* file;
    uint32_t least_triangles, most_triangles;
    float least_height_m, most_height_m;
};

// Of variation 0 and of others.
constexpr Expected k_species[] = {
    {"pine.json", 15000, 16200, 11.5f, 14.6f},
    {"birch.json", 30000, 70000, 12.0f, 16.0f},
    {"oak.json", 30000, 110000, 12.0f, 17.0f},
    {"stand_tree.json", 15900, 16100, 11.9f, 12.6f},
    {"shrub.json", 8900, 9100, 1.3f, 2.4f},
    {"palm.json", 7600, 8400, 1.8f, 3.2f},
    {"fern.json", 1500, 4000, 0.3f, 0.8f},
    {"grass.json", 200, 600, 0.3f, 0.65f},
    {"turf.json", 400, 700, 0.15f, 0.35f},
    {"daisy.json", 800, 2500, 0.15f, 0.4f},
    {"sunflower.json", 4000, 5500, 1.4f, 2.2f},
    {"betula_lenta.json", 180000, 182000, 16.5f, 17.6f},
    {"taxus_baccata.json", 239000, 242000, 9.7f, 10.5f},
    {"carya_ovata.json", 507000, 510000, 22.6f, 23.6f},
};

std::string text_of(const char* file) {
    auto text = read_text_file(std::string(COPPICE_CONTENT_DIR "/species/") + file);
    EXPECT_TRUE(text) << file;
    return text ? *text : "";
}

PlantDescription plant_of(const char* file, uint64_t variation = 0) {
    auto plant = grow_plant(text_of(file), file, variation);
    EXPECT_TRUE(plant) << to_string(plant.error());
    return plant ? std::move(*plant) : PlantDescription{};
}

uint32_t triangles_of(const PlantDescription& plant) {
    size_t count = 0;
    for (const PartDescription& part : plant.parts) count += part.indices.size() / 3;
    return uint32_t(count);
}

Box bounds_of(const PlantDescription& plant) {
    Box box;
    for (const PartDescription& part : plant.parts)
        for (const DescriptionVertex& v : part.vertices) box.include(v.position_plant);
    return box;
}

uint64_t hash_of(const PlantDescription& plant) {
    static_assert(sizeof(DescriptionVertex) == 9 * sizeof(float) &&
                  sizeof(SkeletonSegment) == 13 * sizeof(float));
    uint64_t hash = hash_text(plant.name);
    for (const PartDescription& part : plant.parts) {
        hash = hash_combine(hash, hash_text(part.name, uint64_t(part.kind) * 2 + part.leaf));
        hash = hash_combine(
            hash, hash_bytes(part.vertices.data(), part.vertices.size() * sizeof(DescriptionVertex)));
        hash = hash_combine(hash, hash_span<uint32_t>(part.indices));
        hash = hash_combine(hash, hash_span<uint32_t>(part.element_first_triangle));
        hash = hash_combine(hash,
                            hash_bytes(part.skeleton.data(), part.skeleton.size() * sizeof(SkeletonSegment)));
    }
    return hash;
}

float distance_to(const SkeletonSegment& s, vec3 p) {
    vec3 d = s.end_plant - s.begin_plant;
    float t = std::clamp(glm::dot(p - s.begin_plant, d) / std::max(glm::dot(d, d), 1e-12f), 0.0f, 1.0f);
    return glm::length(p - (s.begin_plant + d * t));
}

class EverySpecies : public testing::TestWithParam<Expected> {};

TEST_P(EverySpecies, has_the_triangles_and_the_height_it_should_have) {
    const Expected& expected = GetParam();
    for (uint64_t variation = 0; variation < 6; ++variation) {
        PlantDescription plant = plant_of(expected.file, variation);
        EXPECT_GE(triangles_of(plant), expected.least_triangles) << variation;
        EXPECT_LE(triangles_of(plant), expected.most_triangles) << variation;
        Box box = bounds_of(plant);
        EXPECT_GE(box.max.y, expected.least_height_m) << variation;
        EXPECT_LE(box.max.y, expected.most_height_m) << variation;
        // It stands on the ground, at the origin, and does not grow below.
        EXPECT_LE(box.min.y, 0.01f) << variation;
        EXPECT_GE(box.min.y, -0.06f * box.max.y) << variation;
        EXPECT_LT(std::max(std::fabs(box.center().x), std::fabs(box.center().z)),
                  0.3f * std::max(box.size().x, box.size().y));
        EXPECT_FALSE(plant.name.empty());
    }
}

TEST_P(EverySpecies, grows_the_same_twice_and_differs_between_individuals) {
    const Expected& expected = GetParam();
    uint64_t first = hash_of(plant_of(expected.file, 3));
    EXPECT_EQ(first, hash_of(plant_of(expected.file, 3)));
    EXPECT_NE(first, hash_of(plant_of(expected.file, 4)));
}

TEST_P(EverySpecies, is_sound_geometry) {
    PlantDescription plant = plant_of(GetParam().file);
    for (const PartDescription& part : plant.parts) {
        SCOPED_TRACE(part.name);
        ASSERT_FALSE(part.indices.empty());
        ASSERT_EQ(part.indices.size() % 3, 0u);
        std::vector<bool> used(part.vertices.size(), false);
        for (uint32_t index : part.indices) {
            ASSERT_LT(index, part.vertices.size());
            used[index] = true;
        }
        EXPECT_LE(std::count(used.begin(), used.end(), false), ptrdiff_t(part.vertices.size() / 50));
        for (const DescriptionVertex& v : part.vertices) {
            ASSERT_TRUE(is_finite(v.position_plant));
            ASSERT_NEAR(glm::length(v.normal_plant), 1.0f, 1e-3f);
            for (int c = 0; c < 3; ++c) ASSERT_TRUE(v.color_linear[c] >= 0.0f && v.color_linear[c] <= 1.0f);
        }
        size_t against = 0;
        for (size_t i = 0; i < part.indices.size(); i += 3) {
            const DescriptionVertex &a = part.vertices[part.indices[i]],
                                    &b = part.vertices[part.indices[i + 1]],
                                    &c = part.vertices[part.indices[i + 2]];
            vec3 area = glm::cross(b.position_plant - a.position_plant, c.position_plant - a.position_plant);
            ASSERT_GT(glm::length(area), 1e-10f) << i / 3;
            against += glm::dot(area, a.normal_plant + b.normal_plant + c.normal_plant) < 0.0f;
        }
        // Normals point where the triangles face.
        EXPECT_LE(against, part.indices.size() / 3 / 50);
        if (!part.element_first_triangle.empty()) {
            EXPECT_EQ(part.element_first_triangle.front(), 0u);
            EXPECT_EQ(part.element_first_triangle.back(), part.indices.size() / 3);
            EXPECT_TRUE(
                std::is_sorted(part.element_first_triangle.begin(), part.element_first_triangle.end()));
        }
    }
}

TEST_P(EverySpecies, lines_follow_what_they_stand_for) {
    PlantDescription plant = plant_of(GetParam().file);
    for (const PartDescription& part : plant.parts) {
        SCOPED_TRACE(part.name);
        if (part.kind == PartKind::lines) {
            EXPECT_FALSE(part.skeleton.empty());
        }
        if (part.skeleton.empty()) continue;
        float thickest = 0.0f, longest = 0.0f;
        for (const SkeletonSegment& s : part.skeleton) {
            ASSERT_TRUE(is_finite(s.begin_plant) && is_finite(s.end_plant));
            ASSERT_GE(s.begin_radius_m, 0.0f);
            ASSERT_GE(s.end_radius_m, 0.0f);
            thickest = std::max({thickest, s.begin_radius_m, s.end_radius_m});
            longest = std::max(longest, glm::length(s.end_plant - s.begin_plant));
        }
        // Every stretch of surface is about a radius away from a line. A sample of the vertices is enough.
        size_t step = std::max<size_t>(1, part.vertices.size() / 150);
        for (size_t i = 0; i < part.vertices.size(); i += step) {
            float least = INFINITY;
            for (const SkeletonSegment& s : part.skeleton)
                least = std::min(least, distance_to(s, part.vertices[i].position_plant));
            ASSERT_LE(least, 1.2f * thickest + 1e-4f) << i;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Content, EverySpecies, testing::ValuesIn(k_species), [](const auto& info) {
    std::string name = info.param.file;
    return name.substr(0, name.find('.'));
});

TEST(Grow, every_compiler_gives_the_same_bytes) {
    // The hashes were made with gcc 12; clang and any number of threads must give them too. They change only
    // when growing itself is changed on purpose.
    const struct {
        const char* json;
        uint64_t hash;
    } cases[] = {
        {R"({"form": "tree", "lobes": 3, "lobe_depth": 0.1, "triangles": 9000, "bark": {"patches": 0.2, "marks": 40},
            "levels": [{"segment_splits": 0.2, "rings": 2, "taper": 1.6},
                       {"curve_deg": 30, "curve_back_deg": -40, "attraction_up": 0.5},
                       {"curve_variation_deg": -90, "rotation_deg": -80, "count": 5}],
            "leaves": {"shape": "oak", "bend": 0.4, "droop_deg": 20}})",
         0xe2e565848d7014a4},
        {R"({"form": "tree", "levels": [{}, {"whorl": 4}], "leaves": {"shape": "needles"}})",
         0x0605c49de5070dce},
        {R"({"form": "palm", "fronds": {"dry": 0.2}})", 0x220c318d868ca8e5},
        {R"({"form": "grass", "stalks": 3})", 0x6203626226b91d73},
        {R"({"form": "flower", "petiole": 0.3, "leaves": {"count": 5, "shape": "heart"}, "rosette": {"count": 4}})",
         0xee56941f31443b98},
    };
    for (const auto& each : cases) {
        auto plant = grow_plant(each.json, "plant.json", 2);
        ASSERT_TRUE(plant) << to_string(plant.error());
        EXPECT_EQ(hash_to_hex(hash_of(*plant)), hash_to_hex(each.hash))
            << each.json
            << "\nIf growing was changed on purpose: raise k_growth_version (plugins/modeller/modeller.h), "
            << "else plants of the old shape stay in the caches, and write the new hash here.";
    }
}

TEST(Grow, tree_trunks_have_no_hole) {
    // Each edge of a closed tube is met once in each direction. Parts meet at rings, so positions are
    // compared over all woody parts together.
    PlantDescription plant = plant_of("stand_tree.json");
    using Key = std::array<int64_t, 6>;
    auto quantised = [](vec3 p, int64_t* out) {
        for (int c = 0; c < 3; ++c) out[c] = int64_t(std::floor(double(p[c]) * 1e6 + 0.5));
    };
    std::vector<Key> edges, reversed;
    for (const PartDescription& part : plant.parts) {
        if (part.leaf) continue;
        for (size_t i = 0; i < part.indices.size(); i += 3) {
            for (size_t k = 0; k < 3; ++k) {
                vec3 a = part.vertices[part.indices[i + k]].position_plant;
                vec3 b = part.vertices[part.indices[i + (k + 1) % 3]].position_plant;
                Key edge, back;
                quantised(a, &edge[0]), quantised(b, &edge[3]);
                quantised(b, &back[0]), quantised(a, &back[3]);
                edges.push_back(edge);
                reversed.push_back(back);
            }
        }
    }
    std::sort(edges.begin(), edges.end());
    size_t open = 0;
    float highest_open_foot = -1.0f;
    for (const Key& back : reversed) {
        if (std::binary_search(edges.begin(), edges.end(), back)) continue;
        ++open;
        // The only open ends are branches' feet, which are inside their parents: never at the ground.
        highest_open_foot = highest_open_foot < 0.0f ? float(back[1]) * 1e-6f
                                                     : std::min(highest_open_foot, float(back[1]) * 1e-6f);
    }
    EXPECT_GT(open, 0u);
    EXPECT_GT(highest_open_foot, 1.0f);
    EXPECT_LT(double(open), 0.3 * double(edges.size()));
}

TEST(Grow, parts_of_wood_have_about_one_thickness) {
    for (const char* file : {"pine.json", "birch.json", "oak.json", "stand_tree.json"}) {
        PlantDescription plant = plant_of(file);
        float before = INFINITY;
        for (const PartDescription& part : plant.parts) {
            if (part.leaf) continue;
            float thickest = 0.0f;
            for (const SkeletonSegment& s : part.skeleton)
                thickest = std::max(thickest, 0.5f * (s.begin_radius_m + s.end_radius_m));
            EXPECT_LT(thickest, before) << file << " " << part.name;
            before = thickest;
        }
        ASSERT_EQ(plant.parts.size(), 4u) << file;
        EXPECT_EQ(plant.parts[0].name, "trunk");
        EXPECT_EQ(plant.parts[2].name, "twigs");
        EXPECT_EQ(plant.parts[2].kind, PartKind::lines);
        EXPECT_TRUE(plant.parts[3].leaf);
    }
}

TEST(Grow, leaf_colours_are_natural_and_vary) {
    for (const char* file : {"pine.json", "birch.json", "oak.json", "stand_tree.json", "shrub.json"}) {
        const PlantDescription plant = plant_of(file);
        const PartDescription& leaves = plant.parts.back();
        ASSERT_TRUE(leaves.leaf) << file;
        dvec3 sum(0), squares(0);
        for (const DescriptionVertex& v : leaves.vertices) {
            sum += dvec3(v.color_linear);
            squares += dvec3(v.color_linear) * dvec3(v.color_linear);
        }
        dvec3 mean = sum / double(leaves.vertices.size());
        dvec3 variance = squares / double(leaves.vertices.size()) - mean * mean;
        EXPECT_GT(mean.y, mean.x) << file;
        EXPECT_GT(mean.x, mean.z) << file;
        EXPECT_TRUE(mean.y > 0.06 && mean.y < 0.22) << file << " " << mean.y;
        EXPECT_GT(variance.y, 1e-4) << file;
    }
}

TEST(Grow, too_few_triangles_for_the_stems_say_so) {
    auto plant = grow_plant(R"({"form": "tree", "triangles": 50, "levels": [{}, {}]})", "plant.json", 0);
    ASSERT_FALSE(plant);
    EXPECT_EQ(plant.error().id, ErrorId::value_out_of_range);
    EXPECT_EQ(plant.error().place, "triangles");
}

TEST(Grow, the_bound_known_before_growing_is_kept) {
    for (const Expected& expected : k_species) {
        auto species = parse_species(text_of(expected.file), expected.file);
        ASSERT_TRUE(species);
        EXPECT_GE(triangle_bound(*species) + 1.0, double(triangles_of(plant_of(expected.file))))
            << expected.file;
    }
}

TEST(Grow, extremes_of_every_angle_stay_finite) {
    Random random(11);
    for (int i = 0; i < 60; ++i) {
        auto angle = [&] { return int(random.next_in(-179, 179)); };
        std::string json = fmt::format(
            R"({{"form": "tree", "seed": {}, "lobes": {}, "lobe_depth": 0.5, "flare": {}, "levels": [
                {{"taper": {}, "segments": {}, "rings": 3, "curve_deg": {}, "curve_back_deg": {}, "curve_variation_deg": {},
                  "segment_splits": 0.3, "split_angle_deg": 120, "attraction_up": {}}},
                {{"count": 9, "taper": {}, "segments": {}, "down_angle_deg": {}, "down_angle_variation_deg": {},
                  "rotation_deg": {}, "curve_variation_deg": {}, "attraction_up": {}}}],
                "leaves": {{"shape": "heart", "count": 5, "down_angle_deg": {}, "fold_deg": 80, "curve_deg": {}, "bend": 1,
                  "droop_deg": 150, "rotation_deg": {}}}}})",
            i, i % 7, i % 3, random.next_in(0, 3), 1 + i % 9, angle(), angle(), angle(), angle() / 10,
            random.next_in(0, 3), 1 + i % 4, angle(), angle(), angle(), angle(), angle() / 10, angle(),
            angle(), angle());
        auto plant = grow_plant(json, "plant.json", uint64_t(i));
        ASSERT_TRUE(plant) << to_string(plant.error()) << json;
        for (const PartDescription& part : plant->parts) {
            for (const DescriptionVertex& v : part.vertices) {
                ASSERT_TRUE(is_finite(v.position_plant)) << json;
                ASSERT_NEAR(glm::length(v.normal_plant), 1.0f, 1e-3f) << json;
            }
        }
    }
}

}  // namespace
}  // namespace coppice::modeller
