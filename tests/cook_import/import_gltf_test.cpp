// Every feature of glTF that a plant may come with, each in a file of a few hundred bytes.
#include <gtest/gtest.h>
#include <meshoptimizer.h>
#include "tests/cook_import/tiny_gltf.h"

namespace coppice {
namespace {

vec3 corner(const PlantDescription& plant, size_t part, size_t i) {
    return plant.parts.at(part).vertices.at(plant.parts[part].indices.at(i)).position_plant;
}
void expect_near(vec3 a, vec3 b, float tolerance = 1.0e-5f) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}
vec3 face_normal(const PlantDescription& plant) {
    return glm::normalize(
        glm::cross(corner(plant, 0, 1) - corner(plant, 0, 0), corner(plant, 0, 2) - corner(plant, 0, 0)));
}

#define IMPORT_OR_FAIL(name, ...) \
    auto name = (__VA_ARGS__);    \
    ASSERT_TRUE(name) << to_string(name.error())

TEST(ImportGltf, HierarchyOfTransforms) {
    TinyGltf gltf;
    add_triangle(gltf);
    // Parent: 90 degrees about y and 10 m up; child: 2 m along its x, twice the size.
    gltf.node("\"children\":[1],\"translation\":[0,10,0],\"rotation\":[0,0.70710678,0,0.70710678]");
    gltf.node("\"mesh\":0,\"translation\":[2,0,0],\"scale\":[2,2,2]");
    gltf.root("\"scenes\":[{\"nodes\":[0]}],\"scene\":0");
    IMPORT_OR_FAIL(plant, gltf.import());
    expect_near(corner(*plant, 0, 0), {0, 10, -2});
    expect_near(corner(*plant, 0, 1), {0, 10, -4});
    expect_near(corner(*plant, 0, 2), {0, 12, -2});
    expect_near(plant->parts[0].vertices[0].normal_plant, {1, 0, 0});
    EXPECT_EQ(plant->name, "tiny");
}

TEST(ImportGltf, MatrixAndMirrorKeepTheFront) {
    TinyGltf gltf;
    add_triangle(gltf);
    gltf.node("\"mesh\":0,\"matrix\":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 5,0,0,1]");
    IMPORT_OR_FAIL(plant, gltf.import());
    expect_near(corner(*plant, 0, 0), {5, 0, 0});
    // Mirrored in x, the face still looks to +z, and its normal agrees.
    expect_near(face_normal(*plant), {0, 0, 1});
    expect_near(plant->parts[0].vertices[0].normal_plant, {0, 0, 1});
}

TEST(ImportGltf, NormalsFollowUnevenScales) {
    TinyGltf gltf;
    int positions = gltf.positions({{0, 0, 0}, {1, 0, -1}, {0, 1, 0}});
    int normals = gltf.vectors(std::vector<vec3>(3, glm::normalize(vec3(1, 0, 1))));
    gltf.mesh("\"POSITION\":" + std::to_string(positions) + ",\"NORMAL\":" + std::to_string(normals));
    gltf.node("\"mesh\":0,\"scale\":[4,1,1]");
    IMPORT_OR_FAIL(plant, gltf.import());
    expect_near(plant->parts[0].vertices[0].normal_plant, face_normal(*plant));
}

TEST(ImportGltf, StripsAndFans) {
    for (int mode : {5, 6}) {
        TinyGltf gltf;
        // Strip: zigzag; fan: round the first. Both a square of 1 m2 facing +z.
        int positions = mode == 5 ? gltf.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}})
                                  : gltf.positions({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
        gltf.mesh("\"POSITION\":" + std::to_string(positions), "\"mode\":" + std::to_string(mode));
        gltf.node("\"mesh\":0");
        IMPORT_OR_FAIL(plant, gltf.import());
        EXPECT_EQ(plant->parts[0].indices.size(), 6u);
        EXPECT_NEAR(area_of(plant->parts[0]), 1.0, 1.0e-6);
        for (const auto& vertex : plant->parts[0].vertices) expect_near(vertex.normal_plant, {0, 0, 1});
    }
}

TEST(ImportGltf, QuantisedAndInterleaved) {
    TinyGltf gltf;
    struct Vertex {
        int16_t position[3], padding;
        int8_t normal[3], more;
    };
    Vertex vertices[3] = {{{0, 0, 0}, 0, {0, 0, 127}, 0},
                          {{32767, 0, 0}, 0, {0, 0, 127}, 0},
                          {{0, -32768, 0}, 0, {0, 0, 127}, 0}};
    int view = gltf.view(vertices, sizeof vertices, "\"byteStride\":12");
    gltf.accessor(view, 5122, "VEC3", 3, "\"normalized\":true");
    gltf.accessor(view, 5120, "VEC3", 3, "\"normalized\":true,\"byteOffset\":8");
    uint8_t order[4] = {0, 2, 1, 0};
    gltf.accessor(gltf.view(order, 3), 5121, "SCALAR", 3);
    gltf.mesh("\"POSITION\":0,\"NORMAL\":1", "\"indices\":2");
    gltf.node("\"mesh\":0,\"scale\":[3,3,3]");
    gltf.root(
        "\"extensionsRequired\":[\"KHR_mesh_quantization\"],\"extensionsUsed\":[\"KHR_mesh_quantization\"]");
    IMPORT_OR_FAIL(plant, gltf.import());
    expect_near(corner(*plant, 0, 1), {0, -3, 0});
    expect_near(corner(*plant, 0, 2), {3, 0, 0});
    expect_near(plant->parts[0].vertices[0].normal_plant, {0, 0, 1});
}

TEST(ImportGltf, SparseOnNothing) {
    TinyGltf gltf;
    uint16_t indices[2] = {1, 2};
    vec3 values[2] = {{1, 0, 0}, {0, 1, 0}};
    int index_view = gltf.view(indices, sizeof indices), value_view = gltf.view(values, sizeof values);
    gltf.accessor(-1, 5126, "VEC3", 3,
                  "\"sparse\":{\"count\":2,\"indices\":{\"bufferView\":" + std::to_string(index_view) +
                      ",\"componentType\":5123},\"values\":{\"bufferView\":" + std::to_string(value_view) +
                      "}}");
    gltf.mesh("\"POSITION\":0");
    gltf.node("\"mesh\":0");
    IMPORT_OR_FAIL(plant, gltf.import());
    EXPECT_NEAR(area_of(plant->parts[0]), 0.5, 1.0e-6);
}

TEST(ImportGltf, MeshoptCompression) {
    constexpr size_t k_count = 64;
    std::vector<vec3> positions(k_count);
    std::vector<int8_t> normals(k_count * 4);
    std::vector<float> normal_floats(k_count * 4, 0.0f);
    std::vector<uint32_t> indices;
    for (size_t i = 0; i < k_count; ++i) {
        positions[i] = vec3(float(i / 8), float(i % 8), 0.5f * float(i % 3));
        normal_floats[i * 4 + 1] = 1.0f;
    }
    for (uint32_t y = 0; y < 7; ++y)
        for (uint32_t x = 0; x < 7; ++x)
            for (uint32_t corner : {0u, 8u, 1u, 1u, 8u, 9u}) indices.push_back(y * 8 + x + corner);
    meshopt_encodeFilterOct(normals.data(), k_count, 4, 8, normal_floats.data());

    std::vector<unsigned char> packed_positions(meshopt_encodeVertexBufferBound(k_count, 12)),
        packed_normals(meshopt_encodeVertexBufferBound(k_count, 4)),
        packed_indices(meshopt_encodeIndexBufferBound(indices.size(), k_count));
    packed_positions.resize(meshopt_encodeVertexBuffer(packed_positions.data(), packed_positions.size(),
                                                       positions.data(), k_count, 12));
    packed_normals.resize(
        meshopt_encodeVertexBuffer(packed_normals.data(), packed_normals.size(), normals.data(), k_count, 4));
    packed_indices.resize(meshopt_encodeIndexBuffer(packed_indices.data(), packed_indices.size(),
                                                    indices.data(), indices.size()));

    // Views as gltfpack writes them: the view names a fallback buffer without data, its extension the packed
    // bytes.
    TinyGltf plain, packed;
    std::vector<std::byte> binary;
    auto view = [&binary](const std::vector<unsigned char>& bytes, size_t count, size_t stride,
                          const char* mode, const char* filter) {
        size_t offset = binary.size();
        auto first = reinterpret_cast<const std::byte*>(bytes.data());
        binary.insert(binary.end(), first, first + bytes.size());
        binary.resize((binary.size() + 3) / 4 * 4);
        return "{\"buffer\":1,\"byteLength\":" + std::to_string(count * stride) +
               ",\"extensions\":{\"EXT_meshopt_compression\":{\"buffer\":0,\"byteOffset\":" +
               std::to_string(offset) + ",\"byteLength\":" + std::to_string(bytes.size()) +
               ",\"byteStride\":" + std::to_string(stride) + ",\"count\":" + std::to_string(count) +
               ",\"mode\":\"" + mode + "\",\"filter\":\"" + filter + "\"}}}";
    };
    std::string views = view(packed_positions, k_count, 12, "ATTRIBUTES", "NONE") + "," +
                        view(packed_normals, k_count, 4, "ATTRIBUTES", "OCTAHEDRAL") + "," +
                        view(packed_indices, indices.size(), 4, "TRIANGLES", "NONE");
    auto document = [&](const std::string& more_views) {
        return "{\"asset\":{\"version\":\"2.0\"},\"extensionsRequired\":[\"EXT_meshopt_compression\"],"
               "\"buffers\":[{\"byteLength\":" +
               std::to_string(binary.size()) +
               "},{\"byteLength\":100000}],"
               "\"bufferViews\":[" +
               more_views +
               "],\"accessors\":["
               "{\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\",\"count\":64},"
               "{\"bufferView\":1,\"componentType\":5120,\"type\":\"VEC3\",\"count\":64,\"normalized\":true},"
               "{\"bufferView\":2,\"componentType\":5125,\"type\":\"SCALAR\",\"count\":" +
               std::to_string(indices.size()) +
               "}],"
               "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1},\"indices\":2}]}],"
               "\"nodes\":[{\"mesh\":0}]}";
    };
    IMPORT_OR_FAIL(plant, import_gltf_memory(as_glb(document(views), binary), "packed.glb", "", {}));
    const PartDescription& part = plant->parts.at(0);
    ASSERT_EQ(part.indices.size(), indices.size());
    double expected = 0.0;
    for (size_t i = 0; i < indices.size(); i += 3)
        expected += glm::length(glm::cross(positions[indices[i + 1]] - positions[indices[i]],
                                           positions[indices[i + 2]] - positions[indices[i]])) *
                    0.5;
    EXPECT_NEAR(area_of(part), expected, expected * 1.0e-6);
    for (const auto& vertex : part.vertices) expect_near(vertex.normal_plant, {0, 1, 0}, 0.02f);

    // Damaged at any byte: an error or other numbers, never a crash.
    for (size_t i = 0; i < binary.size(); i += 3) {
        auto broken = binary;
        broken[i] ^= std::byte(0xff);
        if (auto result = import_gltf_memory(as_glb(document(views), broken), "packed.glb", "", {});
            !result) {
            EXPECT_FALSE(result.error().place.empty());
        }
    }
}

TEST(ImportGltf, VertexColorsTimesFactor) {
    TinyGltf gltf;
    int positions = gltf.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    uint8_t colors[12] = {255, 0, 0, 255, 0, 255, 0, 255, 51, 51, 51, 0};
    int color = gltf.accessor(gltf.view(colors, 12), 5121, "VEC4", 3, "\"normalized\":true");
    gltf.mesh("\"POSITION\":" + std::to_string(positions) + ",\"COLOR_0\":" + std::to_string(color),
              "\"material\":0");
    gltf.node("\"mesh\":0");
    gltf.material(
        "\"name\":\"bark\",\"doubleSided\":true,\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,0.25,1,1]"
        "}");
    IMPORT_OR_FAIL(plant, gltf.import());
    const auto& part = plant->parts[0];
    EXPECT_EQ(part.name, "bark");
    EXPECT_FALSE(part.leaf);  // the name wins over doubleSided
    expect_near(part.vertices[0].color_linear, {0.5f, 0, 0});
    expect_near(part.vertices[1].color_linear, {0, 0.25f, 0});
    expect_near(part.vertices[2].color_linear, {0.1f, 0.05f, 0.2f});
}

TEST(ImportGltf, ExtrasSayWhatAPartIs) {
    TinyGltf gltf;
    int positions = gltf.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    gltf.mesh("\"POSITION\":" + std::to_string(positions), "\"material\":0",
              "\"extras\":{\"coppice\":{\"kind\":\"lines\",\"leaf\":false}}");
    gltf.node("\"mesh\":0,\"extras\":{\"coppice\":{\"importance\":2.5}}");
    gltf.node("\"mesh\":0,\"extras\":{\"coppice\":{\"kind\":\"points\"}}");
    gltf.material("\"name\":\"leaf\",\"extras\":{\"coppice\":{\"importance\":7,\"leaf\":true}}");
    IMPORT_OR_FAIL(plant, gltf.import());
    ASSERT_EQ(plant->parts.size(), 2u);
    EXPECT_EQ(plant->parts[0].kind, PartKind::lines);
    EXPECT_FLOAT_EQ(plant->parts[0].importance, 2.5f);
    EXPECT_FALSE(plant->parts[0].leaf);
    EXPECT_EQ(plant->parts[1].kind, PartKind::points);
    EXPECT_FLOAT_EQ(plant->parts[1].importance, 7.0f);
    EXPECT_EQ(plant->parts[0].name, "leaf");
    EXPECT_EQ(plant->parts[1].name, "leaf 2");
}

TEST(ImportGltf, GpuInstancesInsideAPlant) {
    TinyGltf gltf;
    add_triangle(gltf);
    int translations = gltf.vectors({{0, 0, 0}, {0, 5, 0}, {0, 9, 0}});
    gltf.node("\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":" +
              std::to_string(translations) + "}}}");
    IMPORT_OR_FAIL(plant, gltf.import());
    EXPECT_EQ(plant->parts[0].indices.size(), 9u);
    expect_near(corner(*plant, 0, 6), {0, 9, 0});
}

TEST(ImportGltf, OpaqueTexturesBecomeVertexColors) {
    // Left half dark, right half bright; 4 m wide, so it is divided.
    set_test_picture(64, 64, [](uint32_t x, uint32_t, uint8_t* rgba) {
        for (int c = 0; c < 3; ++c) rgba[c] = x < 32 ? 0 : 255;
        rgba[3] = 255;
    });
    TinyGltf gltf;
    int positions = gltf.positions({{0, 0, 0}, {4, 0, 0}, {4, 1, 0}, {0, 1, 0}});
    int uvs = gltf.uvs({{0, 1}, {1, 1}, {1, 0}, {0, 0}}), indices = gltf.indices({0, 1, 2, 0, 2, 3});
    gltf.mesh("\"POSITION\":" + std::to_string(positions) + ",\"TEXCOORD_0\":" + std::to_string(uvs),
              "\"material\":0,\"indices\":" + std::to_string(indices));
    gltf.node("\"mesh\":0");
    gltf.material("\"name\":\"bark\",\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}");
    uint32_t nothing = 0;
    gltf.root("\"images\":[{\"name\":\"bark.png\",\"bufferView\":" + std::to_string(gltf.view(&nothing, 4)) +
              "}],\"textures\":[{\"source\":0}]");
    ImportSettings settings;
    settings.images = test_images();
    IMPORT_OR_FAIL(plant, gltf.import(settings));
    const auto& part = plant->parts[0];
    EXPECT_NEAR(area_of(part), 4.0, 1.0e-4);
    EXPECT_NEAR(mean_color_of(part).x, 0.5f, 0.01f);
    EXPECT_GT(part.indices.size() / 3, 100u);
    for (const auto& vertex : part.vertices) {
        float x = vertex.position_plant.x, expected = x < 2.0f ? 0.0f : 1.0f;
        EXPECT_NEAR(vertex.color_linear.x, expected, std::fabs(x - 2.0f) > 0.5f ? 0.05f : 1.0f);
    }
    settings.added_triangle_limit = 0;
    IMPORT_OR_FAIL(coarse, gltf.import(settings));
    EXPECT_EQ(coarse->parts[0].indices.size(), 6u);
    EXPECT_NEAR(mean_color_of(coarse->parts[0]).x, 0.5f, 0.01f);

    auto without = gltf.import();
    ASSERT_FALSE(without);
    EXPECT_NE(without.error().place.find("bark.png"), std::string::npos);
    EXPECT_NE(without.error().fault.find("images plugin"), std::string::npos);
}

TEST(ImportGltf, SkinnedMeshesStandInTheirRestPose) {
    TinyGltf gltf;
    add_triangle(gltf);
    float inverse_bind[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -3, 0, 1};
    int matrices = gltf.accessor(gltf.view(inverse_bind, sizeof inverse_bind), 5126, "MAT4", 1);
    gltf.node("\"mesh\":0,\"skin\":0,\"translation\":[100,100,100]");  // ignored, as the specification says
    gltf.node("\"translation\":[1,3,0]");
    gltf.root("\"skins\":[{\"joints\":[1],\"inverseBindMatrices\":" + std::to_string(matrices) + "}]");
    IMPORT_OR_FAIL(plant, gltf.import());
    expect_near(corner(*plant, 0, 0), {1, 0, 0});
}

TEST(ImportGltf, SameBytesTwice) {
    TinyGltf gltf;
    add_triangle(gltf);
    gltf.node("\"mesh\":0");
    gltf.node("\"mesh\":0,\"translation\":[1,0,0]");
    IMPORT_OR_FAIL(one, gltf.import());
    IMPORT_OR_FAIL(two, gltf.import());
    ASSERT_EQ(one->parts[0].vertices.size(), two->parts[0].vertices.size());
    EXPECT_EQ(std::memcmp(one->parts[0].vertices.data(), two->parts[0].vertices.data(),
                          one->parts[0].vertices.size() * sizeof(DescriptionVertex)),
              0);
}

TEST(ImportGltf, DropsAndCountsUnusedVerticesBeforePlacing) {
    for (bool with_normals : {false, true}) {
        TinyGltf gltf;
        std::vector<vec3> positions(1000, vec3(7)), normals(1000, vec3(0, 0, 1));
        positions[10] = vec3(0);
        positions[500] = vec3(1, 0, 0);
        positions[999] = vec3(0, 1, 0);
        normals[500] = vec3(0, 1, 0);
        std::string attributes = "\"POSITION\":" + std::to_string(gltf.positions(positions));
        if (with_normals) attributes += ",\"NORMAL\":" + std::to_string(gltf.vectors(normals));
        gltf.mesh(attributes, "\"indices\":" + std::to_string(gltf.indices({10, 500, 999})));
        for (int i = 0; i < 50; ++i) gltf.node("\"mesh\":0");
        ImportSettings settings;
        settings.vertex_limit = 1000;  // 50 x 1000 would be too many
        auto plant = gltf.import(settings);
        ASSERT_TRUE(plant) << to_string(plant.error());
        const PartDescription& part = plant->parts.at(0);
        ASSERT_EQ(part.vertices.size(), 150u);
        EXPECT_EQ(plant->dropped_vertices, 997u);
        EXPECT_EQ(part.vertices[part.indices[4]].position_plant, vec3(1, 0, 0));
        EXPECT_EQ(part.vertices[part.indices[4]].normal_plant, with_normals ? vec3(0, 1, 0) : vec3(0, 0, 1));
        EXPECT_NEAR(area_of(part), 25.0, 1e-3);
    }
}

}  // namespace
}  // namespace coppice
