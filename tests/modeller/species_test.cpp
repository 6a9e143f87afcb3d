// Each fault once: the message must name the file, the place, what was found and what would be right.
#include "plugins/modeller/species.h"

#include <gtest/gtest.h>

namespace coppice::modeller {
namespace {

Error error_of(const std::string& json) {
    auto species = parse_species(json, "plant.json");
    if (species) {
        ADD_FAILURE() << "accepted: " << json;
        return {};
    }
    EXPECT_EQ(species.error().file, "plant.json");
    EXPECT_FALSE(species.error().fault.empty());
    EXPECT_FALSE(species.error().remedy.empty());
    return species.error();
}

TEST(Species, the_shortest_tree_takes_every_default) {
    auto species = parse_species(R"({"form": "tree", "levels": [{}, {}]})", "plant.json");
    ASSERT_TRUE(species) << to_string(species.error());
    EXPECT_EQ(species->form, PlantForm::tree);
    ASSERT_EQ(species->tree.levels.size(), 2u);
    EXPECT_EQ(species->tree.levels[0].count, 1u);
    EXPECT_FLOAT_EQ(species->tree.levels[0].length.center, 1.0f);
    EXPECT_EQ(species->tree.levels[1].count, 20u);
    EXPECT_EQ(species->seed, 1u);
}

TEST(Species, degrees_become_radians) {
    auto species =
        parse_species(R"({"form": "tree", "levels": [{"curve_deg": 90, "down_angle_deg": -45}]})", "p");
    ASSERT_TRUE(species) << to_string(species.error());
    EXPECT_NEAR(species->tree.levels[0].curve_rad, 0.5f * k_pi, 1e-5f);
    EXPECT_NEAR(species->tree.levels[0].down_angle.center, -0.25f * k_pi, 1e-5f);
}

TEST(Species, malformed_json_names_the_line) {
    Error error = error_of("{\n  \"form\": \"tree\",\n  \"levels\": [}\n");
    EXPECT_EQ(error.id, ErrorId::syntax);
    EXPECT_EQ(error.place, "line 3");
    EXPECT_EQ(error_of("").id, ErrorId::syntax);
    EXPECT_EQ(error_of("[1, 2]").id, ErrorId::syntax);
    EXPECT_EQ(error_of("nul").id, ErrorId::syntax);
}

TEST(Species, an_unknown_key_names_the_nearest_known_one) {
    Error error = error_of(R"({"form": "tree", "levels": [{}, {"down_angel_deg": 3}]})");
    EXPECT_EQ(error.id, ErrorId::name_unknown);
    EXPECT_EQ(error.place, "levels[1].down_angel_deg");
    EXPECT_NE(error.remedy.find("\"down_angle_deg\""), std::string::npos) << error.remedy;
    EXPECT_EQ(error_of(R"({"form": "grass", "leaves": {}})").place, "leaves");
}

TEST(Species, unknown_words_list_the_known_ones) {
    Error error = error_of(R"({"form": "cactus"})");
    EXPECT_EQ(error.id, ErrorId::name_unknown);
    EXPECT_EQ(error.place, "form");
    EXPECT_NE(error.remedy.find("palm"), std::string::npos);
    EXPECT_EQ(error_of(R"({"form": "tree", "levels": [{}], "shape": "round"})").place, "shape");
    EXPECT_EQ(error_of(R"({"form": "tree", "levels": [{}], "leaves": {"shape": 3}})").place, "leaves.shape");
}

TEST(Species, numbers_out_of_range_are_refused_with_their_place) {
    struct Case {
        const char *json, *place;
        ErrorId id;
    };
    const Case cases[] = {
        {R"({})", "form", ErrorId::value_out_of_range},
        {R"({"form": "tree"})", "levels", ErrorId::value_out_of_range},
        {R"({"form": "tree", "levels": []})", "levels", ErrorId::value_out_of_range},
        {R"({"form": "tree", "levels": [{},{},{},{},{},{}]})", "levels", ErrorId::limit_exceeded},
        {R"({"form": "tree", "levels": [7]})", "levels[0]", ErrorId::syntax},
        {R"({"form": "tree", "levels": [{}], "height_m": -2})", "height_m", ErrorId::value_out_of_range},
        {R"({"form": "tree", "levels": [{}], "height_m": "tall"})", "height_m", ErrorId::value_out_of_range},
        {R"({"form": "tree", "levels": [{}], "height_m": null})", "height_m", ErrorId::value_out_of_range},
        {R"({"form": "tree", "levels": [{}], "height_m": 1e999})", "", ErrorId::value_out_of_range},
        {R"({"form": "tree", "levels": [{}], "height_m": 3, "height_variation_m": 3})", "height_variation_m",
         ErrorId::value_out_of_range},
        {R"({"form": "tree", "levels": [{"sides": 2}]})", "levels[0].sides", ErrorId::value_out_of_range},
        {R"({"form": "tree", "levels": [{"sides": 4.5}]})", "levels[0].sides", ErrorId::value_out_of_range},
        {R"({"form": "tree", "levels": [{"count": -1}]})", "levels[0].count", ErrorId::value_out_of_range},
        {R"({"form": "tree", "levels": [{"count": 99999999999999999999}]})", "levels[0].count",
         ErrorId::limit_exceeded},
        {R"({"form": "tree", "levels": [{"segments": 4000000000}]})", "levels[0].segments",
         ErrorId::limit_exceeded},
        {R"({"form": "tree", "levels": [{}], "seed": -1})", "seed", ErrorId::value_out_of_range},
        {R"({"form": "tree", "levels": [{}], "name": 4})", "name", ErrorId::value_out_of_range},
        {R"({"form": "tree", "levels": [{}], "bark": {"color_linear": [1, 2, 0]}})", "bark.color_linear",
         ErrorId::value_out_of_range},
        {R"({"form": "tree", "levels": [{}], "bark": {"color_linear": [1, 0]}})", "bark.color_linear",
         ErrorId::value_out_of_range},
        {R"({"form": "tree", "levels": [{}], "bark": [0]})", "bark", ErrorId::syntax},
        {R"({"form": "flower", "head": {"petals": {"length_m": 0}}})", "head.petals.length_m",
         ErrorId::value_out_of_range},
        {R"({"form": "palm", "fronds": {"leaflets": 100000000}})", "fronds.leaflets",
         ErrorId::limit_exceeded},
        {R"({"form": "grass", "dry": 1.5})", "dry", ErrorId::value_out_of_range},
    };
    for (const Case& each : cases) {
        Error error = error_of(each.json);
        EXPECT_EQ(error.place, each.place) << each.json;
        EXPECT_EQ(error.id, each.id) << each.json << " " << to_string(error);
    }
}

TEST(Species, absurd_numbers_of_triangles_are_refused_before_anything_is_built) {
    // Each count alone is allowed; together they would fill any memory.
    const char* cases[] = {
        R"({"form": "tree", "levels": [{"count": 100000}, {"count": 100000}, {"count": 100000}, {"count": 100000}]})",
        R"({"form": "tree", "levels": [{"segments": 200, "segment_splits": 4}]})",
        R"({"form": "tree", "levels": [{}, {"count": 100000}], "leaves": {"count": 100000}})",
        R"({"form": "palm", "fronds": {"count": 10000, "leaflets": 10000, "leaflet_segments": 50}})",
        R"({"form": "grass", "blades": 100000, "segments": 50, "stalks": 10000, "height_m": 1})",
        R"({"form": "flower", "stems": 10000, "head": {"florets": 100000}})",
    };
    int refused = 0;
    for (const char* json : cases) {
        auto species = parse_species(json, "plant.json");
        if (species) {
            EXPECT_LE(triangle_bound(*species), k_triangle_limit) << json;
        } else {
            EXPECT_EQ(species.error().id, ErrorId::limit_exceeded) << json;
            ++refused;
        }
    }
    EXPECT_EQ(refused, 5);  // all but the grass, which is large and legal
}

TEST(Species, broken_text_never_crashes) {
    const std::string good = R"({"form":"tree","levels":[{"count":1},{"count":3}],"leaves":{"shape":"oak"}})";
    for (size_t cut = 0; cut < good.size(); ++cut) {
        EXPECT_FALSE(parse_species(good.substr(0, cut), "plant.json")) << cut;
        std::string flipped = good;
        flipped[cut] = char(flipped[cut] ^ 0x15);
        auto species = parse_species(flipped, "plant.json");
        if (!species) {
            EXPECT_FALSE(species.error().remedy.empty());
        }
    }
    EXPECT_FALSE(parse_species(std::string(100000, '['), "plant.json"));
    EXPECT_FALSE(parse_species("{\"\xff\xfe\": 1}", "plant.json"));
}

}  // namespace
}  // namespace coppice::modeller
