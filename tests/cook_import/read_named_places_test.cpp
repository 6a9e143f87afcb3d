// Nodes and instances of glTF files as places for plants.
#include "plugins/vegetation/cook/import/read_named_places.h"

#include <gtest/gtest.h>
#include "tests/cook_import/tiny_gltf.h"

namespace coppice {
namespace {

Result<std::vector<NamedPlaces>> read(const TinyGltf& gltf) {
    return read_named_places_memory(gltf.glb(), "stand.glb", "", 1 << 20);
}

constexpr int k_byte = 5120, k_short = 5122, k_float = 5126;
const std::string k_many = R"("extensions":{"EXT_mesh_gpu_instancing":{"attributes":{)";

// Turns a direction, as vegetation does.
dvec3 turned(vec4 q, dvec3 p) {
    const dvec3 axis(q.x, q.y, q.z), t = 2.0 * glm::cross(axis, p);
    return p + double(q.w) * t + glm::cross(axis, t);
}

TEST(NamedPlaces, InstancesStandInTheirNode) {
    TinyGltf gltf;
    add_triangle(gltf);
    const int places = gltf.vectors({{1, 2, 3}, {4, 5, 6.25f}}), scales = gltf.vectors({{2, 2, 2}, {1, 8, 1}});
    const float turns[8] = {0, 0, 0, 1, 0, 0.70710678f, 0, 0.70710678f};
    const int rotations = gltf.accessor(gltf.view(turns, sizeof turns), k_float, "VEC4", 2);
    // A quarter to the left, at a place that floats cannot hold beside the instances'.
    gltf.node(R"("name":"oak.002","mesh":0,"translation":[4000000,0,-8],"rotation":[0,0.70710678,0,0.70710678],)" + k_many +
              "\"TRANSLATION\":" + std::to_string(places) + ",\"ROTATION\":" + std::to_string(rotations) +
              ",\"SCALE\":" + std::to_string(scales) + "}}}");
    const auto named = read(gltf);
    ASSERT_TRUE(named) << to_string(named.error());
    ASSERT_EQ(named->size(), 1u);
    const NamedPlaces& oaks = named->front();
    EXPECT_EQ(oaks.names.front(), "oak.002");
    ASSERT_EQ(oaks.places.size(), 2u);
    EXPECT_LT(glm::length(oaks.places[0].at - dvec3(4000003, 2, -9)), 1e-5);
    EXPECT_LT(glm::length(oaks.places[1].at - dvec3(4000006.25, 5, -12)), 1e-5);
    EXPECT_NEAR(oaks.places[0].scale, 2.0, 1e-6);
    EXPECT_NEAR(oaks.places[1].scale, 2.0, 1e-6);  // 1 * 8 * 1
    EXPECT_LT(glm::length(turned(oaks.places[0].turn, dvec3(1, 0, 0)) - dvec3(0, 0, -1)), 1e-6);
    EXPECT_LT(glm::length(turned(oaks.places[1].turn, dvec3(1, 0, 0)) - dvec3(-1, 0, 0)), 1e-6);
}

// Rotations may be normalised integers, and any accessor sparse.
TEST(NamedPlaces, AccessorsAreOfEveryKind) {
    TinyGltf gltf;
    add_triangle(gltf);
    const int16_t shorts[8] = {0, 23170, 0, 23170, 0, 0, 0, 32767};
    const int8_t bytes[8] = {0, 90, 0, 90, 0, 0, 0, 127};
    const int of_shorts = gltf.accessor(gltf.view(shorts, sizeof shorts), k_short, "VEC4", 2, "\"normalized\":true");
    const int of_bytes = gltf.accessor(gltf.view(bytes, sizeof bytes), k_byte, "VEC4", 2, "\"normalized\":true");
    const uint16_t where[2] = {1, 0};
    const float what[3] = {7, 8, 9};
    const int index_view = gltf.view(where, 2), value_view = gltf.view(what, sizeof what);
    const int sparse = gltf.accessor(gltf.view(std::vector<float>(6, 0.0f).data(), 24), k_float, "VEC3", 2,
                                     R"("sparse":{"count":1,"indices":{"bufferView":)" + std::to_string(index_view) +
                                         R"(,"componentType":5123},"values":{"bufferView":)" + std::to_string(value_view) + "}}");
    for (int rotations : {of_shorts, of_bytes})
        gltf.node(R"("name":"oak","mesh":0,)" + k_many + "\"TRANSLATION\":" + std::to_string(sparse) +
                  ",\"ROTATION\":" + std::to_string(rotations) + "}}}");
    const auto named = read(gltf);
    ASSERT_TRUE(named) << to_string(named.error());
    ASSERT_EQ(named->size(), 2u);
    for (const NamedPlaces& many : *named) {
        ASSERT_EQ(many.places.size(), 2u);
        EXPECT_LT(glm::length(many.places[0].at), 1e-6);
        EXPECT_LT(glm::length(many.places[1].at - dvec3(7, 8, 9)), 1e-6);
        EXPECT_LT(glm::length(turned(many.places[0].turn, dvec3(1, 0, 0)) - dvec3(0, 0, -1)), 1e-4);
        EXPECT_LT(glm::length(turned(many.places[1].turn, dvec3(1, 0, 0)) - dvec3(1, 0, 0)), 1e-4);
    }
}

TEST(NamedPlaces, NodesMeshesAndMatrices) {
    TinyGltf gltf;
    gltf.node(R"("name":"group","scale":[2,2,2],"children":[1,2,3])");
    gltf.node(R"("name":"fern","translation":[1,0,0])");
    gltf.node(R"("matrix":[0,0,-3,0,0,3,0,0,3,0,0,0,5,6,7,1],"name":"oak")");
    gltf.node(R"("translation":[1,0,0])");  // called nothing
    const auto named = read(gltf);
    ASSERT_TRUE(named) << to_string(named.error());
    ASSERT_EQ(named->size(), 2u);
    EXPECT_EQ((*named)[0].names, std::vector<std::string>{"fern"});
    EXPECT_LT(glm::length((*named)[0].places[0].at - dvec3(2, 0, 0)), 1e-6);
    const NamedPlace& oak = (*named)[1].places[0];
    EXPECT_LT(glm::length(oak.at - dvec3(10, 12, 14)), 1e-5);
    EXPECT_NEAR(oak.scale, 6.0, 1e-5);
    EXPECT_LT(glm::length(turned(oak.turn, dvec3(1, 0, 0)) - dvec3(0, 0, -1)), 1e-6);
}

TEST(NamedPlaces, FaultsAreNamed) {
    auto with = [](const std::string& attributes, const std::string& more = "") {
        TinyGltf gltf;
        add_triangle(gltf);
        gltf.vectors({{1, 2, 3}, {4, 5, 6}});  // accessor 2
        gltf.vectors({{1, 1, 1}});             // 3
        gltf.vectors({{1, 1, 1}, {1, 0, 1}});  // 4
        const float bad[3] = {1, NAN, 0};
        gltf.accessor(gltf.view(bad, sizeof bad), k_float, "VEC3", 1);        // 5
        gltf.accessor(gltf.view(bad, sizeof bad), k_float, "VEC3", 1000000);  // 6
        gltf.node(R"("name":"oak","mesh":0,)" + more + k_many + attributes + "}}}");
        return read(gltf);
    };
    ASSERT_TRUE(with("\"TRANSLATION\":2"));
    for (const char* attributes : {"\"TRANSLATION\":2,\"SCALE\":3", "\"TRANSLATION\":2,\"SCALE\":4", "\"TRANSLATION\":5",
                                   "\"TRANSLATION\":6", "\"TRANSLATION\":99", "\"ROTATION\":2", ""}) {
        const auto named = with(attributes);
        ASSERT_FALSE(named) << attributes;
        EXPECT_EQ(named.error().file, "stand.glb");
        EXPECT_FALSE(named.error().place.empty()) << attributes;
    }
    EXPECT_FALSE(with("\"TRANSLATION\":2", "\"scale\":[0,1,1],"));
    EXPECT_EQ(read_named_places("nowhere.glb").error().id, ErrorId::file_missing);
}

}  // namespace
}  // namespace coppice
