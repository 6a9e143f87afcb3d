#include "editor/commands/command.h"

#include <set>
#include "editor/commands/brush.h"
#include "editor/commands/exchange.h"
#include "plugins/vegetation/eco/ground_height.h"
#include "tests/editor/workplace.h"

namespace coppice {
namespace {

struct Commands : Workplace {
    std::vector<PlacedPlant> plants(const Session& session) { return session.document().root().plants.all(); }
    static double nearest_m(const std::vector<PlacedPlant>& plants) {
        double nearest = INFINITY;
        for (size_t i = 0; i < plants.size(); ++i)
            for (size_t j = 0; j < i; ++j)
                nearest = std::min(nearest, glm::length(ground_place(plants[i]) - ground_place(plants[j])));
        return nearest;
    }
};

TEST_F(Commands, PaintUnderTheBrushAtItsDensity) {
    auto session = open();
    perform(*session, "paint",
            R"({"scatter": {"plant": "fern", "density_per_m2": 4, "scale": [0.5, 0.7]},
                "stroke": [[-40, 0], [-20, 0], [0, 0], [20, 0], [40, 0], [20, 0], [0, 0]], "radius_m": 5})");
    // Twice over the same ground is as once.
    const double area_m2 = 80 * 10 + double(k_pi) * 25;
    EXPECT_NEAR(double(count(*session)), 4 * area_m2, 0.06 * 4 * area_m2);
    for (const PlacedPlant& plant : plants(*session)) {
        const dvec2 at = ground_place(plant);
        const dvec2 on_line(std::clamp(at.x, -40.0, 40.0), 0.0);
        EXPECT_LT(glm::length(at - on_line), 5.01);
        EXPECT_GE(unpack_scale(plant.scale), 0.499f);
        EXPECT_LE(unpack_scale(plant.scale), 0.701f);
        EXPECT_EQ(plant.lift, 0);
    }
}

TEST_F(Commands, PaintKeepsItsDistances) {
    auto session = open();
    const char* paint =
        R"({"scatter": {"plants": {"oak": 1, "fern": 1}, "density_per_m2": 0.4, "spacing_m": 1},
                            "stroke": [[0, 0], [5, 1], [11, 0]], "radius_m": 6})";
    perform(*session, "paint", paint);
    const size_t once = count(*session);
    EXPECT_GE(nearest_m(plants(*session)), 0.985);  // rounded to 1/128 m
    std::string again = paint;
    again.replace(again.find("\"spacing_m\": 1"), 14, "\"spacing_m\": 1, \"seed\": 5");
    session->perform("paint", nlohmann::json::parse(again)).value();
    EXPECT_GE(nearest_m(plants(*session)), 0.985);
    EXPECT_LT(count(*session), 2 * once);
}

TEST_F(Commands, PaintFollowsItsRules) {
    auto session = open();
    perform(*session, "paint",
            R"({"scatter": {"plant": "oak", "density_per_m2": 0.5, "slope_max_deg": 12, "altitude_m": [-3, 6],
                            "exclude": "pond", "region": {"rectangle": {"center": [0, 0], "size_m": [80, 30]}}},
                "stroke": [[-60, 0], [60, 0]], "radius_m": 30})");
    ASSERT_GT(count(*session), 50u);
    for (const PlacedPlant& plant : plants(*session)) {
        const dvec2 at = ground_place(plant);
        EXPECT_GT(glm::length(at - dvec2(20, 0)), 7.98);
        EXPECT_LT(std::abs(at.x), 40.01);
        EXPECT_LT(std::abs(at.y), 15.01);
        const double y = ground_height(session->terrain(), at.x, at.y);
        EXPECT_GT(y, -3.05);
        EXPECT_LT(y, 6.05);
        EXPECT_GT(ground_normal(session->terrain(), at.x, at.y).y, portable_cos(12.6f * k_pi / 180.0f));
    }
    EXPECT_EQ(refuse(*session, "paint",
                     R"({"scatter": {"plant": "oak", "count": 4}, "stroke": [[0, 0]], "radius_m": 3})")
                  .id,
              ErrorId::syntax);
}

TEST_F(Commands, PaintByAMap) {
    ASSERT_TRUE(write_text_file(folder + "/half.pgm", "P5 2 1 255 " + std::string("\xff\x00", 2)));
    auto session = open();
    const std::string rule =
        R"("scatter": {"plant": "fern", "density_per_m2": 0.5,
           "density_map": {"picture": "half.pgm", "center": [0, 0], "size_m": [80, 400]}})";
    auto left_share = [&] {
        size_t left = 0;
        for (const PlacedPlant& plant : plants(*session)) left += plant.x < 0;
        return double(left) / double(count(*session));
    };
    perform(*session, "paint", ("{" + rule + R"(, "stroke": [[-40, 0], [40, 0]], "radius_m": 10})").c_str());
    EXPECT_GT(count(*session), 250u);
    EXPECT_NEAR(left_share(), 0.875, 0.05);  // of a slope between the two pixels' middles
    session->undo();
    perform(*session, "fill", ("{" + rule + R"(, "polygon": [[-40, -20], [40, -20], [40, 20], [-40, 20]]})").c_str());
    EXPECT_NEAR(left_share(), 0.875, 0.05);
    const size_t filled = count(*session);
    // As a rule, and from a rule to plants.
    std::string wide = rule;
    wide.insert(wide.rfind('}'), R"(, "region": {"rectangle": {"center": [0, 0], "size_m": [80, 40]}})");
    perform(*session, "add_rule", ("{" + wide + "}").c_str());
    perform(*session, "bake_rule", R"({"index": 2})");
    EXPECT_NEAR(double(count(*session)), 2.0 * double(filled), 0.1 * double(filled));
    EXPECT_NEAR(left_share(), 0.875, 0.05);
    const Error fault = refuse(*session, "add_rule",
                               R"({"scatter": {"plant": "fern", "count": 3, "density_map": {"picture": "no.pgm"}}})");
    EXPECT_NE(to_string(fault).find("density_map.picture"), std::string::npos) << to_string(fault);
}

TEST_F(Commands, PaintAtADistanceToOthers) {
    auto session = open();
    perform(*session, "place", R"({"population": "oak", "at": [0, 0]})");
    perform(*session, "add_rule",
            R"({"scatter": {"plant": "oak", "count": 1, "region": {"circle": {"center": [30, 0], "radius_m": 0.02}}}})");
    perform(*session, "paint",
            R"({"scatter": {"plant": "fern", "density_per_m2": 1, "distance": {"from": "oak", "least_m": 2, "most_m": 6}},
                "stroke": [[-20, 0], [60, 0]], "radius_m": 10})");
    size_t at_placed = 0, at_rule = 0;
    for (const PlacedPlant& plant : plants(*session)) {
        if (session->document().kinds()[plant.kind] != "fern") continue;
        const double placed_m = glm::length(ground_place(plant)), rule_m = glm::length(ground_place(plant) - dvec2(30, 0));
        at_placed += placed_m < 6.0;
        at_rule += rule_m < 6.03;
        EXPECT_GE(std::min(placed_m, rule_m + 0.03), 2.0);
        EXPECT_LE(std::min(placed_m, rule_m), 6.03);
    }
    EXPECT_NEAR(double(at_placed), 100.0, 35.0);  // pi (36 - 4)
    EXPECT_NEAR(double(at_rule), 100.0, 35.0);
    // A rule placed one by one measures from the rules before it, and from what is placed.
    perform(*session, "add_rule",
            R"({"scatter": {"plant": "birch", "density_per_m2": 1, "region": {"circle": {"center": [15, 0], "radius_m": 40}},
                            "distance": {"from": ["oak"], "most_m": 3}}})");
    const auto& json = session->document().root().text->json;
    perform(*session, "bake_rule", ("{\"index\": " + std::to_string(json["placements"].size() - 1) + "}").c_str());
    EXPECT_NEAR(double(count(*session, "birch")), 2.0 * 28.3, 25.0);
    perform(*session, "rename_population", R"({"name": "oak", "to": "quercus"})");
    perform(*session, "add_rule",
            R"({"scatter": {"plant": "fern", "count": 1, "distance": {"from": ["quercus"], "most_m": 9}}})");
    perform(*session, "rename_population", R"({"name": "quercus", "to": "oak"})");
    EXPECT_EQ(session->document().root().text->json["placements"].back()["scatter"]["distance"]["from"][0], "oak");
}

// A hand's stroke, piece by piece, is what a script paints at once.
TEST_F(Commands, PaintsTheSameAtOnceAndInPieces) {
    auto a = open(false), b = open(false);
    const char* text =
        R"({"scatter": {"plants": {"oak": 1, "fern": 2}, "density_per_m2": 0.5, "spacing_m": 0.7},
                           "stroke": [[0, 0], [4, 1], [9, 0], [3, -2]], "radius_m": 3})";
    perform(*a, "paint", text);

    auto document = JsonDocument::parse(text, "");
    ASSERT_TRUE(document);
    JsonObject arguments(*document, document->root(), "");
    const CommandContext context = b->context();
    const Target target{context.document.root_path(), &context.document.root(), context.terrain};
    auto names = names_of(context.document, *target.file, target.path);
    ASSERT_TRUE(names);
    const Region under_brush{{RegionShape{}}};
    PaintStroke stroke(read_brush_rule(arguments, *names, target.terrain, &under_brush), 3.0);
    for (const dvec2 point : {dvec2(0, 0), dvec2(4, 1), dvec2(9, 0), dvec2(3, -2)}) {
        auto more = stroke.extend(point, target.file->plants);
        ASSERT_TRUE(more);
        b->extend(edit_of(target, {}, *more));
    }
    EXPECT_TRUE(b->is_extending());
    b->finish("paint");
    EXPECT_GT(count(*a), 20u);
    EXPECT_EQ(all_bytes(a->document()), all_bytes(b->document()));
    b->undo();
    EXPECT_EQ(count(*b), 0u) << "a stroke is one step";
}

TEST_F(Commands, EraseWhatIsUnderTheBrush) {
    auto session = open();
    perform(
        *session, "paint",
        R"({"scatter": {"plants": {"oak": 1, "fern": 3}, "density_per_m2": 2}, "stroke": [[0, 0]], "radius_m": 10})");
    const size_t oaks = count(*session, "oak");
    perform(*session, "erase", R"({"stroke": [[0, 0], [3, 0]], "radius_m": 4, "populations": ["fern"]})");
    EXPECT_EQ(count(*session, "oak"), oaks);
    for (const PlacedPlant& plant : plants(*session))
        EXPECT_TRUE(session->document().kinds()[plant.kind] == "oak" ||
                    glm::length(ground_place(plant)) >= 4.0);
    const size_t before = count(*session);
    perform(*session, "erase", R"({"stroke": [[0, 0]], "radius_m": 11, "share": 0.5})");
    EXPECT_NEAR(double(count(*session)), 0.5 * double(before), 0.1 * double(before));
    perform(*session, "erase", R"({"stroke": [[0, 0]], "radius_m": 11})");
    EXPECT_EQ(count(*session), 0u);
}

TEST_F(Commands, FillPolygons) {
    auto session = open();
    perform(*session, "fill",
            R"({"polygon": [[0, 0], [40, 0], [0, 40]], "scatter": {"plant": "fern", "density_per_m2": 1}})");
    EXPECT_NEAR(double(count(*session)), 800.0, 80.0);
    for (const PlacedPlant& plant : plants(*session)) {
        const dvec2 at = ground_place(plant);
        EXPECT_TRUE(at.x > -0.01 && at.y > -0.01 && at.x + at.y < 40.02);
    }
    perform(
        *session, "fill",
        R"({"polygon": [[-50, 0], [-10, 0], [-10, 40], [-50, 40]], "scatter": {"plant": "oak", "count": 25, "spacing_m": 3}})");
    EXPECT_EQ(count(*session, "oak"), 25u);
}

TEST_F(Commands, PlaceMoveTurnAndScaleOne) {
    auto session = open();
    perform(
        *session, "place",
        R"({"population": "oak", "at": [3, 4], "turn_deg": 30, "scale": 1.5, "variation": 2, "lift_m": 0.5})");
    perform(*session, "place", R"({"population": "fern", "at": [3.5, 4]})");
    perform(*session, "move", R"({"near": [3, 4], "populations": ["oak"], "to": [10, 4]})");
    perform(*session, "turn", R"({"near": [10, 4], "by_deg": 60})");
    perform(*session, "scale", R"({"near": [10, 4], "by": 2})");
    ASSERT_EQ(count(*session), 2u);
    for (const PlacedPlant& plant : plants(*session)) {
        if (session->document().kinds()[plant.kind] != "oak") continue;
        EXPECT_EQ(ground_place(plant), dvec2(10, 4));
        EXPECT_EQ(unpack_scale(plant.scale), 3.0f);
        EXPECT_EQ(plant.lift, 32);
        EXPECT_EQ(plant.variation, 2);
        const mat3 turn = rotation_matrix(unpack_placed_turn(plant.turn));
        EXPECT_NEAR(turn[0].z, -1.0f, 0.01f) << "turned by a quarter to the left";
    }
    perform(*session, "delete", R"({"near": [10, 4]})");
    EXPECT_EQ(count(*session, "oak"), 0u);
    EXPECT_EQ(*session->perform("delete", {{"near", {200, 200}}}), nullptr);
    EXPECT_EQ(
        refuse(*session, "place", R"({"population": "okk", "at": [0, 0]})").remedy.find("did you mean 'oak'"),
        0u);
}

// Deussen et al. 1998: as a stand thins itself, the mean plant's mass follows the -3/2 power of the density.
TEST_F(Commands, CompeteUntilOnlyThoseStandThatHaveRoom) {
    auto session = open();
    perform(*session, "fill", R"({"polygon": [[-60, -60], [60, -60], [60, 60], [-60, 60]],
                                  "scatter": {"plant": "fern", "density_per_m2": 0.8, "scale": [0.05, 0.15]}})");
    std::vector<double> log_density, log_mass;
    for (int stage = 0; stage < 8; ++stage) {
        perform(*session, "compete", R"({"crown_radius_m": 4, "steps": 5, "growth": 0.06, "scale_most": 3})");
        double mass = 0.0;
        for (const PlacedPlant& plant : plants(*session)) {
            const double scale = double(unpack_scale(plant.scale));
            mass += scale * scale * scale / double(count(*session));
        }
        log_density.push_back(std::log(double(count(*session))));
        log_mass.push_back(std::log(mass));
    }
    EXPECT_LT(log_density.back(), log_density.front() - 1.0) << "it did not thin out";
    double x = 0, y = 0, xx = 0, xy = 0;
    const double n = double(log_mass.size());
    for (size_t i = 0; i < log_mass.size(); ++i) {
        x += log_density[i] / n;
        y += log_mass[i] / n;
    }
    for (size_t i = 0; i < log_mass.size(); ++i) {
        xx += (log_density[i] - x) * (log_density[i] - x);
        xy += (log_density[i] - x) * (log_mass[i] - y);
    }
    EXPECT_NEAR(xy / xx, -1.5, 0.15);
    // Nobody's circle is in another's.
    const auto left = plants(*session);
    for (size_t i = 0; i < left.size(); ++i)
        for (size_t j = 0; j < i; ++j)
            EXPECT_GE(glm::length(ground_place(left[i]) - ground_place(left[j])),
                      0.998 * 4 * double(unpack_scale(left[i].scale) + unpack_scale(left[j].scale)));
}

TEST_F(Commands, CompetitionIsWonByTheLarger) {
    auto session = open();
    perform(*session, "place", R"({"population": "oak", "at": [0, 0], "scale": 0.5})");
    perform(*session, "place", R"({"population": "fern", "at": [1, 0], "scale": 1})");
    perform(*session, "place", R"({"population": "birch", "at": [1, 0.2], "scale": 3})");
    perform(*session, "compete", R"({"crown_radius_m": {"oak": 2, "fern": 0.5}, "steps": 0})");
    EXPECT_EQ(count(*session, "oak"), 1u);
    EXPECT_EQ(count(*session, "fern"), 0u);
    EXPECT_EQ(count(*session, "birch"), 1u) << "it took no part";
}

TEST_F(Commands, ChangePopulations) {
    auto session = open();
    perform(*session, "place", R"({"population": "oak", "at": [0, 0]})");
    perform(*session, "add_population",
            R"({"name": "pine", "source": "pine.json", "variations": 2, "importance": 1.5})");
    EXPECT_EQ(refuse(*session, "add_population", R"({"name": "pine", "source": "pine.json"})").id,
              ErrorId::value_out_of_range);
    perform(*session, "rename_population", R"({"name": "oak", "to": "quercus"})");
    const auto& json = session->document().root().text->json;
    EXPECT_EQ(json["placements"][0]["scatter"]["plant"], "quercus");
    EXPECT_EQ(json["plants"].begin().key(), "quercus") << "it keeps its place";
    EXPECT_EQ(count(*session, "quercus"), 1u);
    EXPECT_EQ(refuse(*session, "remove_population", R"({"name": "quercus"})").id,
              ErrorId::value_out_of_range);
    perform(*session, "remove_rule", R"({"index": 0})");
    perform(*session, "remove_population", R"({"name": "quercus"})");
    EXPECT_EQ(count(*session), 0u);
    session->undo();
    EXPECT_EQ(count(*session, "quercus"), 1u);
}

TEST_F(Commands, KeepRulesAsRulesUntilTheyArePlaced) {
    auto session = open();
    perform(*session, "add_rule", R"({"scatter": {"plant": "fern", "count": 30, "region": "pond"}})");
    EXPECT_EQ(count(*session), 0u);
    perform(*session, "set_rule",
            R"({"index": 1, "scatter": {"plant": "fern", "count": 50, "region": "pond"}})");
    EXPECT_EQ(refuse(*session, "set_rule",
                     R"({"index": 7, "scatter": {"plant": "fern", "count": 50, "region": "pond"}})")
                  .id,
              ErrorId::value_out_of_range);
    EXPECT_EQ(
        refuse(*session, "add_rule", R"({"scatter": {"plant": "fern", "count": 50, "region": "lake"}})").id,
        ErrorId::name_unknown);
    perform(*session, "bake_rule", R"({"index": 1})");
    EXPECT_EQ(count(*session, "fern"), 50u);
    EXPECT_EQ(session->document().root().text->json["placements"].size(), 2u)
        << "the other rule, and what is placed";
    for (const PlacedPlant& plant : plants(*session))
        EXPECT_LT(glm::length(ground_place(plant) - dvec2(20, 0)), 8.02);
    perform(*session, "set_region", R"({"name": "pond", "region": null})");
    EXPECT_FALSE(session->document().root().text->json.contains("regions"));
}

TEST_F(Commands, NestTilesInTiles) {
    auto session = open();
    perform(*session, "place", R"({"population": "oak", "at": [100, 50]})");
    perform(*session, "place", R"({"population": "oak", "at": [0, 0]})");
    perform(*session, "nest", R"({"near": [100, 50], "scene": "tiles/grove.eco.json", "at": [90, 50]})");
    EXPECT_EQ(count(*session), 1u);
    const EcoFile* grove = session->document().find(folder + "/tiles/grove.eco.json");
    ASSERT_NE(grove, nullptr);
    ASSERT_EQ(grove->plants.size(), 1u);
    EXPECT_EQ(ground_place(grove->plants.all()[0]), dvec2(10, 0));
    EXPECT_EQ(grove->text->json["plants"]["oak"]["source"], "../oak.json");
    perform(*session, "place", R"({"file": "tiles/grove.eco.json", "population": "fern", "at": [1, 1]})");
    perform(*session, "create_tile",
            R"({"file": "tiles/grove.eco.json", "scene": "inner.eco.json", "at": [5, 5], "turn_deg": 30})");
    EXPECT_NE(session->document().find(folder + "/tiles/inner.eco.json"), nullptr);
    perform(*session, "duplicate_tile", R"({"index": 0, "at": [-90, 0], "scale": 1.2})");
    perform(*session, "move_tile", R"({"index": 1, "at": [-80, 0]})");
    EXPECT_EQ(session->document().root().text->json["references"][1]["at"][0], -80.0);
    EXPECT_EQ(refuse(*session, "add_tile",
                     R"({"file": "tiles/inner.eco.json", "scene": "../scene.eco.json", "at": [0, 0]})")
                  .fault,
              "it would come to stand in itself");
    ASSERT_TRUE(session->save());
    session.reset();
    session = open();
    EXPECT_EQ(session->document().files().size(), 3u);
    EXPECT_EQ(session->document().find(folder + "/tiles/grove.eco.json")->plants.size(), 2u);
    perform(*session, "remove_tile", R"({"index": 1})");
    EXPECT_EQ(session->document().root().text->json["references"].size(), 1u);
}

TEST_F(Commands, ExportWhatTheyImport) {
    auto session = open();
    perform(
        *session, "paint",
        R"({"scatter": {"plants": {"oak": 1, "fern": 3}, "density_per_m2": 1, "scale": [0.5, 2], "tilt_deg": 10}, "stroke": [[0, 0]], "radius_m": 6})");
    const std::vector<PlacedPlant> before = plants(*session);
    ASSERT_TRUE(
        write_text_file(folder + "/out.csv", placed_as_csv(session->document(), session->document().root())));
    ASSERT_TRUE(
        write_text_file(folder + "/out.gltf",
                        placed_as_gltf(session->document(), session->document().root(), session->terrain())));
    perform(*session, "delete", "{}");
    EXPECT_EQ(count(*session), 0u);
    perform(*session, "import_gltf", R"({"gltf": "out.gltf"})");
    std::vector<PlacedPlant> after = plants(*session);
    ASSERT_EQ(after.size(), before.size());
    for (size_t i = 0; i < after.size(); ++i) {
        EXPECT_EQ(after[i].x, before[i].x);
        EXPECT_EQ(after[i].z, before[i].z);
        EXPECT_EQ(after[i].kind, before[i].kind);
        EXPECT_EQ(after[i].variation, before[i].variation);
        EXPECT_EQ(after[i].scale, before[i].scale);
        EXPECT_EQ(after[i].turn, before[i].turn);
        EXPECT_LE(std::abs(after[i].lift), 1);
    }
    const std::string gltf = read("out.gltf");
    EXPECT_NE(gltf.find("EXT_mesh_gpu_instancing"), std::string::npos);
    // The same as a .glb, and far away.
    perform(*session, "move", R"({"by": [3000000.5, -5000000.25]})");
    const std::vector<PlacedPlant> far = plants(*session);
    ASSERT_TRUE(write_text_file(folder + "/far.glb", placed_as_gltf(session->document(), session->document().root(),
                                                                    session->terrain(), true)));
    perform(*session, "delete", "{}");
    perform(*session, "import_gltf", R"({"gltf": "far.glb"})");
    after = plants(*session);
    ASSERT_EQ(after.size(), far.size());
    for (size_t i = 0; i < after.size(); ++i) {
        EXPECT_EQ(std::pair(after[i].x, after[i].z), std::pair(far[i].x, far[i].z));
        EXPECT_EQ(after[i].turn, far[i].turn);
        EXPECT_EQ(after[i].scale, far[i].scale);
    }
    perform(*session, "delete", "{}");
    // Heights set scales, so ferns, whose height is not known, need their own.
    std::string csv = read("out.csv");
    EXPECT_TRUE(csv.starts_with("x,y,species,height,scale,turn_deg\n"));
    perform(*session, "import_csv", R"({"csv": "out.csv"})");
    after = plants(*session);
    ASSERT_EQ(after.size(), before.size());
    for (size_t i = 0; i < after.size(); ++i) {
        EXPECT_EQ(after[i].x, before[i].x);
        if (session->document().kinds()[after[i].kind] != "oak") continue;
        EXPECT_NEAR(unpack_scale(after[i].scale), unpack_scale(before[i].scale), 2e-3f);
    }
}

TEST_F(Commands, ImportNodesOfOtherPrograms) {
    ASSERT_TRUE(
        write_text_file(folder + "/in.gltf", R"({"asset": {"version": "2.0"}, "meshes": [{"name": "QURO", "primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"componentType": 5126, "count": 3, "type": "VEC3"}],
        "nodes": [{"name": "stand", "translation": [10, 0, 0], "rotation": [0, 0.70710678, 0, 0.70710678], "scale": [2, 2, 2], "children": [1, 2, 3]},
                  {"name": "fern.012", "translation": [5, 0, 0]}, {"mesh": 0}, {"name": "camera"}]})"));
    auto session = open();
    perform(*session, "import_gltf", R"({"gltf": "in.gltf", "species": {"QURO": "oak"}})");
    ASSERT_EQ(count(*session), 2u);
    for (const PlacedPlant& plant : plants(*session)) {
        EXPECT_EQ(unpack_scale(plant.scale), 2.0f);
        const bool fern = session->document().kinds()[plant.kind] == "fern";
        EXPECT_LT(glm::length(ground_place(plant) - (fern ? dvec2(10, -10) : dvec2(10, 0))), 0.01);
    }
    for (const char* broken :
         {R"({"nodes": [{"children": [0]}]})", R"({"nodes": [{"name": "oak", "rotation": [0, 0, 0, 0]}]})",
          R"({"nodes": [{"name": "oak", "translation": [1e300, 0, 0]}]})", R"({"nodes": [{"name": "tree"}]})",
          R"({"nodes": [{"children": [1, 1]}, {"name": "oak"}]})", R"({"nodes": 3})", "[", "glTF123",
          R"({"asset": {"version": "2.0"}, "nodes": [{"children": [0], "name": "oak"}]})",
          R"({"asset": {"version": "2.0"}, "nodes": [{"name": "oak", "rotation": [0, 0, 0, 0]}]})",
          R"({"asset": {"version": "2.0"}, "nodes": [{"name": "oak", "translation": [1e9, 0, 0]}]})",
          R"({"asset": {"version": "2.0"}, "nodes": [{"name": "tree"}]})"}) {
        ASSERT_TRUE(write_text_file(folder + "/in.gltf", broken));
        refuse(*session, "import_gltf", R"({"gltf": "in.gltf"})");
    }
}

TEST_F(Commands, SayWhatTheyDoNotUnderstand) {
    auto session = open();
    EXPECT_EQ(refuse(*session, "pain", "{}").remedy.find("did you mean 'paint'"), 0u);
    EXPECT_EQ(refuse(*session, "place", R"({"population": "oak"})").place, "at");
    EXPECT_EQ(
        refuse(*session, "place", R"({"population": "oak", "at": [0, 0], "scal": 2})").remedy.substr(0, 20),
        "did you mean 'scale'");
    EXPECT_EQ(refuse(*session, "place", R"({"population": "oak", "at": [0, 1e9]})").id,
              ErrorId::value_out_of_range);
    EXPECT_EQ(refuse(*session, "place", R"({"file": "no.eco.json", "population": "oak", "at": [0, 0]})").id,
              ErrorId::name_unknown);
    EXPECT_EQ(
        refuse(
            *session, "paint",
            R"({"scatter": {"plant": "oak", "density_per_m2": 1e5}, "stroke": [[0, 0]], "radius_m": 9000})")
            .id,
        ErrorId::limit_exceeded);
    for (const Command& command : all_commands()) {
        for (const char* arguments : {"[]", "3", "null", R"({"unheard_of": 1})"}) {
            auto edit = session->perform(command.name, nlohmann::json::parse(arguments));
            EXPECT_FALSE(edit && *edit) << command.name << " " << arguments;
        }
    }
}

}  // namespace
}  // namespace coppice
