// Cards cut to geometry: area, colour, sharing, wrapping.
#include <gtest/gtest.h>
#include <set>
#include "tests/cook_import/tiny_gltf.h"

namespace coppice {
namespace {

// A card of 1 x 1 m whose uvs go from low to high, `count` times in a row.
Result<PlantDescription> import_cards(vec2 low, vec2 high, int count, const std::string& sampler = "",
                                      const ImportSettings& with = {}, const std::string& texture_more = "") {
    TinyGltf gltf;
    std::vector<vec3> positions;
    std::vector<vec2> uvs;
    std::vector<uint32_t> indices;
    for (int i = 0; i < count; ++i) {
        uint32_t first = uint32_t(positions.size());
        float z = float(i) * 0.25f;
        for (vec3 p : {vec3(0, 0, z), vec3(1, 0, z), vec3(1, 1, z), vec3(0, 1, z)}) positions.push_back(p);
        for (vec2 uv : {vec2(low.x, high.y), vec2(high.x, high.y), vec2(high.x, low.y), vec2(low.x, low.y)})
            uvs.push_back(uv);
        for (uint32_t index : {0u, 1u, 2u, 0u, 2u, 3u}) indices.push_back(first + index);
    }
    std::vector<vec3> normals(positions.size(), vec3(0, 0, 1));
    std::string attributes = "\"POSITION\":" + std::to_string(gltf.positions(positions));
    attributes += ",\"NORMAL\":" + std::to_string(gltf.vectors(normals));
    attributes += ",\"TEXCOORD_0\":" + std::to_string(gltf.uvs(uvs));
    int index_accessor = gltf.indices(indices);
    gltf.mesh(attributes, "\"material\":0,\"indices\":" + std::to_string(index_accessor));
    gltf.node("\"mesh\":0");
    gltf.material(
        "\"name\":\"leaf\",\"alphaMode\":\"MASK\",\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":"
        "0" +
        texture_more + "}}");
    uint32_t nothing = 0;
    int image = gltf.view(&nothing, 4);
    gltf.root("\"images\":[{\"mimeType\":\"image/png\",\"bufferView\":" + std::to_string(image) + "}]");
    gltf.root("\"samplers\":[{" + sampler + "}]");
    gltf.root("\"textures\":[{\"source\":0,\"sampler\":0}]");
    ImportSettings settings = with;
    settings.images = test_images();
    return gltf.import(settings);
}

double paint_disc(uint32_t size, float radius) {
    double opaque = 0;
    set_test_picture(size, size, [&](uint32_t x, uint32_t y, uint8_t* rgba) {
        float dx = float(x) + 0.5f - float(size) * 0.5f, dy = float(y) + 0.5f - float(size) * 0.5f;
        bool inside = dx * dx + dy * dy < radius * radius;
        opaque += inside;
        rgba[0] = inside ? 10 : 255;  // what lies outside must not be seen
        rgba[1] = inside ? 200 : 0;
        rgba[2] = inside ? 30 : 255;
        rgba[3] = inside ? 255 : 0;
    });
    return opaque / (double(size) * size);
}

// A lobed leaf with a hole and a stalk.
double paint_leaf(uint32_t size) {
    double opaque = 0;
    set_test_picture(size, size, [&](uint32_t x, uint32_t y, uint8_t* rgba) {
        float u = (float(x) + 0.5f) / float(size) * 2.0f - 1.0f,
              v = (float(y) + 0.5f) / float(size) * 2.0f - 1.0f;
        float angle = portable_atan2(v, u), radius = std::sqrt(u * u + v * v);
        bool inside = radius < 0.6f + 0.25f * portable_cos(5.0f * angle);
        if ((u - 0.2f) * (u - 0.2f) + v * v < 0.01f) inside = false;
        if (std::fabs(u) < 0.02f && v > 0.0f) inside = true;
        opaque += inside;
        rgba[0] = inside ? uint8_t(40 + 100 * (y & 1)) : 255;
        rgba[1] = inside ? uint8_t(100 + 50 * (x * 2 > size)) : 255;
        rgba[2] = inside ? 20 : 255;
        rgba[3] = inside ? 255 : 0;
    });
    return opaque / (double(size) * size);
}

TEST(AlphaCut, DiscKeepsItsAreaInFewTriangles) {
    double share = paint_disc(256, 100.0f);
    auto plant = import_cards({0, 0}, {1, 1}, 1);
    ASSERT_TRUE(plant) << to_string(plant.error());
    const PartDescription& part = plant->parts.at(0);
    EXPECT_NEAR(area_of(part) / share, 1.0, 0.02);
    EXPECT_GE(part.indices.size() / 3, 4u);
    EXPECT_LE(part.indices.size() / 3, 16u);
    for (const auto& vertex : part.vertices) {  // the outline stays near the circle
        float r = glm::length(vec2(vertex.position_plant) - vec2(0.5f));
        EXPECT_NEAR(r, 100.0f / 256.0f, 0.06f);
    }
}

TEST(AlphaCut, LeafKeepsItsAreaAndColor) {
    double share = paint_leaf(200);
    auto plant = import_cards({0, 0}, {1, 1}, 1);
    ASSERT_TRUE(plant) << to_string(plant.error());
    EXPECT_NEAR(area_of(plant->parts.at(0)) / share, 1.0, 0.02);
    vec3 mean = mean_color_of(plant->parts[0]);
    float red = (srgb_to_linear(40 / 255.0f) + srgb_to_linear(140 / 255.0f)) * 0.5f;
    EXPECT_NEAR(mean.x, red, red * 0.03f);
    EXPECT_NEAR(mean.z, srgb_to_linear(20 / 255.0f), 0.001f);  // the white around it does not bleed in
    EXPECT_TRUE(plant->parts[0].leaf);
}

TEST(AlphaCut, RoughOutlinesKeepTheirAreaToo) {
    double share = paint_leaf(200);
    ImportSettings settings;
    settings.alpha_cut.triangle_target = 12;
    auto plant = import_cards({0, 0}, {1, 1}, 1, "", settings);
    ASSERT_TRUE(plant) << to_string(plant.error());
    EXPECT_NEAR(area_of(plant->parts.at(0)) / share, 1.0, 0.02);
    EXPECT_LE(plant->parts[0].indices.size() / 3, 20u);
}

TEST(AlphaCut, PieceOfATextureIsCutToThatPiece) {
    double share = paint_disc(256, 100.0f);
    auto plant = import_cards({0.5f, 0}, {1, 1}, 1);  // the right half of the disc, stretched over the card
    ASSERT_TRUE(plant) << to_string(plant.error());
    EXPECT_NEAR(area_of(plant->parts.at(0)) / share, 1.0, 0.02);
}

TEST(AlphaCut, CardsAreElements) {
    paint_disc(128, 50.0f);
    auto plant = import_cards({0, 0}, {1, 1}, 7);
    ASSERT_TRUE(plant) << to_string(plant.error());
    const PartDescription& part = plant->parts.at(0);
    ASSERT_EQ(part.element_first_triangle.size(), 8u);
    EXPECT_EQ(part.element_first_triangle.back(), part.indices.size() / 3);
    for (size_t e = 0; e < 7; ++e)
        for (uint32_t t = part.element_first_triangle[e]; t < part.element_first_triangle[e + 1]; ++t)
            EXPECT_FLOAT_EQ(part.vertices[part.indices[t * 3]].position_plant.z, float(e) * 0.25f);
}

TEST(AlphaCut, WrapModesRepeatMirrorAndClamp) {
    // Opaque: the left half.
    set_test_picture(64, 64,
                     [](uint32_t x, uint32_t, uint8_t* rgba) { rgba[1] = 255, rgba[3] = x < 32 ? 255 : 0; });
    auto share = [](const char* sampler, float low, float high) {
        auto plant = import_cards({low, 0}, {high, 1}, 1, sampler);
        return plant ? area_of(plant->parts.at(0)) : -1.0;
    };
    // A quarter past the right border: repeat shows opaque, mirror and clamp show nothing.
    EXPECT_NEAR(share("", 0.5f, 1.5f), 0.5, 0.01);
    EXPECT_NEAR(share("\"wrapS\":33648", 0.5f, 2.0f), 1.0 / 3.0, 0.01);
    EXPECT_NEAR(share("\"wrapS\":33071", -1.0f, 1.0f), 0.75, 0.01);
    EXPECT_NEAR(share("\"wrapS\":33071", 0.0f, 2.0f), 0.25, 0.01);
    EXPECT_NEAR(share("", -3.0f, -1.0f), 0.5, 0.01);
}

TEST(AlphaCut, TextureTransformChoosesThePiece) {
    set_test_picture(64, 64,
                     [](uint32_t x, uint32_t, uint8_t* rgba) { rgba[1] = 255, rgba[3] = x < 32 ? 255 : 0; });
    auto plant =
        import_cards({0, 0}, {1, 1}, 1, "", {},
                     ",\"extensions\":{\"KHR_texture_transform\":{\"offset\":[0.25,0],\"scale\":[0.5,1]}}");
    ASSERT_TRUE(plant) << to_string(plant.error());
    EXPECT_NEAR(area_of(plant->parts.at(0)), 0.5, 0.01);
}

TEST(AlphaCut, TrianglesKeepTheirFront) {
    paint_disc(64, 25.0f);
    for (bool mirrored : {false, true}) {
        auto plant = mirrored ? import_cards({1, 0}, {0, 1}, 1) : import_cards({0, 0}, {1, 1}, 1);
        ASSERT_TRUE(plant) << to_string(plant.error());
        const PartDescription& part = plant->parts.at(0);
        for (size_t i = 0; i < part.indices.size(); i += 3) {
            vec3 a = part.vertices[part.indices[i]].position_plant,
                 b = part.vertices[part.indices[i + 1]].position_plant,
                 c = part.vertices[part.indices[i + 2]].position_plant;
            EXPECT_GT(glm::cross(b - a, c - a).z, 0.0f);
        }
    }
}

TEST(AlphaCut, RegularHatchingKeepsItsShareWithinBounds) {
    // Squares that touch at their corners, finer than any outline could follow.
    set_test_picture(256, 256, [](uint32_t x, uint32_t y, uint8_t* rgba) {
        rgba[1] = 255, rgba[3] = (x / 3 + y / 3) % 2 ? 255 : 0;
    });
    auto plant = import_cards({0, 0}, {1, 1}, 1);
    ASSERT_TRUE(plant) << to_string(plant.error());
    EXPECT_NEAR(area_of(plant->parts.at(0)), 0.5, 0.01);
    EXPECT_LT(plant->parts[0].indices.size() / 3, 20'000u);
}

TEST(AlphaCut, SpecklesDoNotExplodeAndKeepTheirShare) {
    double opaque = 0;
    set_test_picture(64, 64, [&](uint32_t x, uint32_t y, uint8_t* rgba) {
        bool on = (x * 2654435761u + y * 40503u * 77u) % 11 < 5;
        opaque += on;
        rgba[1] = 255, rgba[3] = on ? 255 : 0;
    });
    auto plant = import_cards({0, 0}, {1, 1}, 1);
    ASSERT_TRUE(plant) << to_string(plant.error());
    EXPECT_NEAR(area_of(plant->parts.at(0)) / (opaque / 4096.0), 1.0, 0.1);
    EXPECT_LT(plant->parts[0].indices.size() / 3, 20'000u);
}

}  // namespace
}  // namespace coppice
