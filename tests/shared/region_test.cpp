#include "plugins/shared/region.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

Region read(const char* json) {
    JsonDocument document = *JsonDocument::parse(json, "x.json");
    Region region = read_region(document, document.root(), "region");
    EXPECT_TRUE(document.sound()) << to_string(document.status().error());
    return region;
}

Error fault_of(const char* json) {
    JsonDocument document = *JsonDocument::parse(json, "x.json");
    read_region(document, document.root(), "region", {{"lake", {}}});
    EXPECT_FALSE(document.sound()) << json;
    return document.sound() ? Error{} : document.status().error();
}

TEST(Region, DistancesAreThoseToTheBorder) {
    EXPECT_NEAR(read(R"({"circle": {"center": [3, 4], "radius_m": 2}})").distance_m({0, 0}), 3.0, 1e-12);
    Region box = read(R"({"rectangle": {"center": [10, 0], "size_m": [4, 2]}})");
    EXPECT_NEAR(box.distance_m({10, 0.5}), -0.5, 1e-12);
    EXPECT_NEAR(box.distance_m({15, 5}), 5.0, 1e-12);
    Region turned = read(R"({"rectangle": {"center": [0, 0], "size_m": [4, 2], "turn_deg": 90}})");
    EXPECT_TRUE(turned.contains({0, 1.9}));
    EXPECT_FALSE(turned.contains({1.9, 0}));
    Region polygon = read(R"({"polygon": [[0, 0], [4, 0], [4, 4], [2, 1], [0, 4]]})");
    EXPECT_FALSE(polygon.contains({2, 2}));
    EXPECT_TRUE(polygon.contains({0.5, 2}));
    EXPECT_NEAR(polygon.distance_m({2, -3}), 3.0, 1e-12);
    Region corridor = read(R"({"corridor": {"points": [[0, 0], [10, 0], [10, 10]], "width_m": 3}})");
    EXPECT_NEAR(corridor.distance_m({5, 4}), 2.5, 1e-12);
    EXPECT_TRUE(corridor.contains({11, 8}));
}

TEST(Region, BoundsHoldTheRegion) {
    Region region = read(R"([{"circle": {"center": [-5, 0], "radius_m": 1}},
                             {"rectangle": {"center": [4, 4], "size_m": [2, 8], "turn_deg": 30}}])");
    auto [low, high] = region.bounds();
    for (double x = -12; x < 12; x += 0.1)
        for (double z = -12; z < 12; z += 0.1)
            if (region.contains({x, z})) {
                ASSERT_TRUE(x >= low.x && x <= high.x && z >= low.y && z <= high.y) << x << " " << z;
            }
    EXPECT_NEAR(low.x, -6.0, 1e-9);
}

TEST(Region, EveryFaultOnce) {
    EXPECT_EQ(fault_of("3").id, ErrorId::syntax);
    EXPECT_EQ(fault_of("[]").id, ErrorId::syntax);
    EXPECT_EQ(fault_of("[[]]").id, ErrorId::syntax);
    EXPECT_EQ(fault_of("{}").id, ErrorId::syntax);
    EXPECT_EQ(fault_of(R"("lak")").id, ErrorId::name_unknown);
    EXPECT_NE(fault_of(R"("lak")").remedy.find("'lake'"), std::string::npos);
    EXPECT_EQ(fault_of(R"({"circle": {"center": [0, 0], "radius_m": 0}})").id, ErrorId::value_out_of_range);
    EXPECT_EQ(fault_of(R"({"circle": {"center": [0, 0], "radius_m": 1, "x": 1}})").id, ErrorId::name_unknown);
    EXPECT_EQ(fault_of(R"({"polygon": [[0, 0], [1, 1]]})").id, ErrorId::value_out_of_range);
    EXPECT_EQ(fault_of(R"({"polygon": [[0, 0], [1, 1], ["a", 2]]})").id, ErrorId::value_out_of_range);
    EXPECT_EQ(fault_of(R"({"corridor": {"points": [[0, 0], [1, 1e9]], "width_m": 1}})").id,
              ErrorId::value_out_of_range);
}

}  // namespace
}  // namespace coppice
