// Every way a file can be wrong: an error with its place, never a crash.
#include <gtest/gtest.h>
#include <cmath>
#include "tests/cook_import/tiny_gltf.h"

namespace coppice {
namespace {

Error error_of(const Result<PlantDescription>& result) {
    EXPECT_FALSE(result);
    return result ? Error{} : result.error();
}
void expect_error(const TinyGltf& gltf, ErrorId id, const std::string& place) {
    Error error = error_of(gltf.import());
    EXPECT_EQ(error.id, id) << to_string(error);
    EXPECT_EQ(error.place, place) << to_string(error);
    EXPECT_EQ(error.file, "tiny.glb");
    EXPECT_FALSE(error.fault.empty());
    EXPECT_FALSE(error.remedy.empty());
}

TEST(ImportErrors, MissingFile) {
    EXPECT_EQ(error_of(import_gltf("no/such/plant.glb", {})).id, ErrorId::file_missing);
}

TEST(ImportErrors, TruncatedAnywhere) {
    TinyGltf gltf;
    add_triangle(gltf);
    gltf.node("\"mesh\":0");
    auto bytes = gltf.glb();
    ASSERT_TRUE(gltf.import());
    for (size_t size = 0; size < bytes.size(); ++size) {
        auto result = import_gltf_memory(std::span(bytes).first(size), "tiny.glb", "", {});
        EXPECT_FALSE(result) << size;
    }
}

TEST(ImportErrors, DamagedAnywhere) {
    TinyGltf gltf;
    add_triangle(gltf);
    gltf.node("\"mesh\":0");
    auto bytes = gltf.glb();
    size_t imported = 0;
    for (size_t i = 0; i < bytes.size(); ++i)
        for (int value : {0, 0x20, 0x39, 0x7f, 0xff}) {
            auto broken = bytes;
            broken[i] = std::byte(value);
            auto result = import_gltf_memory(broken, "tiny.glb", "", {});
            imported += result.has_value();
            if (!result) continue;
            for (const auto& vertex : result->parts.at(0).vertices)
                EXPECT_TRUE(is_finite(vertex.position_plant));
        }
    EXPECT_GT(imported, 0u);
}

TEST(ImportErrors, IndexOutOfRange) {
    TinyGltf gltf;
    int positions = gltf.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), indices = gltf.indices({0, 1, 3});
    gltf.mesh("\"POSITION\":" + std::to_string(positions), "\"indices\":" + std::to_string(indices));
    gltf.node("\"mesh\":0");
    expect_error(gltf, ErrorId::value_out_of_range, "meshes[0].primitives[0].indices");
}

TEST(ImportErrors, AccessorBeyondItsView) {
    TinyGltf gltf;
    float values[9] = {};
    gltf.accessor(gltf.view(values, sizeof values), 5126, "VEC3", 4);
    gltf.mesh("\"POSITION\":0");
    gltf.node("\"mesh\":0");
    expect_error(gltf, ErrorId::value_out_of_range, "accessors[0]");
}

TEST(ImportErrors, AbsurdCounts) {
    TinyGltf gltf;
    float values[9] = {};
    gltf.accessor(gltf.view(values, sizeof values), 5126, "VEC3", 268435456);
    gltf.mesh("\"POSITION\":0");
    gltf.node("\"mesh\":0");
    expect_error(gltf, ErrorId::limit_exceeded, "meshes[0].primitives[0]");
}

TEST(ImportErrors, NotANumber) {
    TinyGltf gltf;
    int positions = gltf.positions({{0, 0, 0}, {1, NAN, 0}, {0, 1, 0}});
    gltf.mesh("\"POSITION\":" + std::to_string(positions));
    gltf.node("\"mesh\":0");
    expect_error(gltf, ErrorId::value_out_of_range, "accessors[0]");
}

TEST(ImportErrors, OverflowingTransform) {
    TinyGltf gltf;
    add_triangle(gltf);
    gltf.node("\"children\":[1],\"scale\":[1e30,1e30,1e30]");
    gltf.node("\"mesh\":0,\"scale\":[1e30,1e30,1e30]");
    expect_error(gltf, ErrorId::value_out_of_range, "nodes[1]");
}

TEST(ImportErrors, CycleIsNamed) {
    TinyGltf gltf;
    add_triangle(gltf);
    gltf.node("\"children\":[1]");
    gltf.node("\"children\":[2],\"mesh\":0");
    gltf.node("\"children\":[0]");
    Error error = error_of(gltf.import());
    EXPECT_EQ(error.id, ErrorId::value_out_of_range);
    EXPECT_NE(error.fault.find("nodes[0] -> nodes[1] -> nodes[2] -> nodes[0]"), std::string::npos)
        << error.fault;
}

TEST(ImportErrors, TwoParents) {
    TinyGltf gltf;
    add_triangle(gltf);
    gltf.node("\"children\":[2]");
    gltf.node("\"children\":[2]");
    gltf.node("\"mesh\":0");
    expect_error(gltf, ErrorId::value_out_of_range, "nodes[2]");
}

TEST(ImportErrors, FilesOutsideTheFolder) {
    for (const char* uri : {"../x.bin", "%2e%2e/x.bin", "/etc/passwd"}) {
        std::string json = R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":")";
        json += uri;
        json += R"("}]})";
        Error error = error_of(import_gltf_memory(std::as_bytes(std::span(json)), "plant.gltf", "", {}));
        EXPECT_EQ(error.id, ErrorId::value_out_of_range);
        EXPECT_EQ(error.place, "buffers[0].uri");
    }
}

TEST(ImportErrors, UnknownRequiredExtension) {
    TinyGltf gltf;
    add_triangle(gltf);
    gltf.node("\"mesh\":0");
    gltf.root("\"extensionsRequired\":[\"ACME_leaves\"]");
    expect_error(gltf, ErrorId::format_unknown, "extensionsRequired[0]");
}

TEST(ImportErrors, Draco) {
    TinyGltf gltf;
    add_triangle(gltf,
                 "\"extensions\":{\"KHR_draco_mesh_compression\":{\"bufferView\":0,\"attributes\":{}}}");
    gltf.node("\"mesh\":0");
    expect_error(gltf, ErrorId::format_unknown, "meshes[0].primitives[0]");
}

TEST(ImportErrors, NothingToSee) {
    TinyGltf empty;
    EXPECT_NE(error_of(empty.import()).fault.find("no triangles"), std::string::npos);
    TinyGltf points;
    add_triangle(points, "\"mode\":0");
    points.node("\"mesh\":0");
    EXPECT_NE(error_of(points.import()).fault.find("no triangles"), std::string::npos);
}

TEST(ImportErrors, WrongTypesOfJson) {
    for (const char* json :
         {"", "{", "[]", "3", "{}", "{\"asset\":3}", "{\"asset\":{\"version\":\"1.0\"}}",
          "{\"asset\":{\"version\":\"2.0\"},\"nodes\":3}", "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[3]}",
          "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":-1}]}",
          "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":0}]}",
          "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}]}",
          "{\"asset\":{\"version\":\"2.0\"},\"accessors\":[{\"count\":1e300}]}"}) {
        std::string text = json;
        EXPECT_FALSE(import_gltf_memory(std::as_bytes(std::span(text)), "plant.gltf", "", {})) << json;
    }
    std::string deep(100000, '[');
    EXPECT_EQ(error_of(import_gltf_memory(std::as_bytes(std::span(deep)), "plant.gltf", "", {})).id,
              ErrorId::limit_exceeded);
}

TEST(ImportErrors, ExtrasThatCannotBeMeant) {
    for (const char* extras : {"{\"kind\":\"blob\"}", "{\"importance\":-1}", "{\"leaf\":3}"}) {
        TinyGltf gltf;
        add_triangle(gltf);
        gltf.node(std::string("\"mesh\":0,\"extras\":{\"coppice\":") + extras + "}");
        Error error = error_of(gltf.import());
        EXPECT_EQ(error.place.substr(0, 23), "nodes[0].extras.coppice") << to_string(error);
    }
}

TEST(ImportErrors, FurtherThanAnyPlant) {
    TinyGltf far, too_far;
    add_triangle(far);
    far.node("\"mesh\":0,\"scale\":[1e5,1e5,1e5]");
    EXPECT_TRUE(far.import());
    add_triangle(too_far);
    too_far.node("\"mesh\":0,\"scale\":[1.001e5,1,1]");
    expect_error(too_far, ErrorId::value_out_of_range, "meshes[0].primitives[0]");
}

// Nothing in the file backs such vertices: a kilobyte could ask for gigabytes, a million times.
TEST(ImportErrors, ManyVerticesOutOfNothing) {
    TinyGltf gltf;
    int zeros = gltf.accessor(-1, 5126, "VEC3", 22'000'000), indices = gltf.indices({0, 1, 2});
    gltf.mesh("\"POSITION\":" + std::to_string(zeros) + ",\"NORMAL\":" + std::to_string(zeros),
              "\"indices\":" + std::to_string(indices));
    int places = gltf.accessor(-1, 5126, "VEC3", 1'000'000);
    gltf.node("\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":" +
              std::to_string(places) + "}}}");
    expect_error(gltf, ErrorId::limit_exceeded, "accessors[0]");
}

TEST(ImportErrors, TooManyVertices) {
    TinyGltf gltf;
    add_triangle(gltf);
    for (int i = 0; i < 5; ++i) gltf.node("\"mesh\":0");
    ImportSettings settings;
    settings.vertex_limit = 14;
    Error error = error_of(gltf.import(settings));
    EXPECT_EQ(error.id, ErrorId::limit_exceeded);
    EXPECT_EQ(error.place, "meshes[0].primitives[0]");
    settings.vertex_limit = 15;
    EXPECT_TRUE(gltf.import(settings));
    settings.vertex_limit = 2;
    EXPECT_EQ(error_of(gltf.import(settings)).fault, "3 vertices");
}

// The primitives of one mesh are read together, before the first of them is placed.
TEST(ImportErrors, ManyPrimitivesOfOneArray) {
    TinyGltf gltf;
    std::string position = std::to_string(gltf.positions({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    gltf.mesh("\"POSITION\":" + position + "}},{\"attributes\":{\"POSITION\":" + position);
    gltf.node("\"mesh\":0");
    ImportSettings settings;
    settings.triangle_limit = 1;
    Error error = error_of(gltf.import(settings));
    EXPECT_EQ(error.id, ErrorId::limit_exceeded);
    EXPECT_EQ(error.place, "meshes[0].primitives[1]");
}

TEST(ImportErrors, TooManyTriangles) {
    TinyGltf gltf;
    add_triangle(gltf);
    for (int i = 0; i < 5; ++i) gltf.node("\"mesh\":0");
    ImportSettings settings;
    settings.triangle_limit = 4;
    EXPECT_EQ(error_of(gltf.import(settings)).id, ErrorId::limit_exceeded);
}

}  // namespace
}  // namespace coppice
