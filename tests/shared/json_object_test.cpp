#include "plugins/shared/json_object.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

TEST(JsonObject, SaysLineAndColumnOfWhatDoesNotParse) {
    auto document = JsonDocument::parse("{\n  \"a\": 1,\n  \"b\" 2\n}", "x.json");
    ASSERT_FALSE(document);
    EXPECT_EQ(document.error().id, ErrorId::syntax);
    EXPECT_EQ(document.error().place, "line 3, column 7");
    EXPECT_EQ(document.error().file, "x.json");
    EXPECT_EQ(JsonDocument::parse("?", "x").error().place, "line 1, column 1");
    EXPECT_EQ(JsonDocument::parse("", "x").error().place, "line 1, column 1");
    EXPECT_FALSE(JsonDocument::parse(std::string(100000, '['), "x"));
}

TEST(JsonObject, NamesTheUnknownKeyAndTheNearestKnown) {
    JsonDocument document = *JsonDocument::parse(R"({"densty": 1})", "x.json");
    JsonObject object(document, document.root(), "scatter");
    object.number("density", 0, 1, 0.5);
    object.number("weight", 0, 1, 0.5);
    object.close();
    auto status = document.status();
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().id, ErrorId::name_unknown);
    EXPECT_NE(status.error().fault.find("densty"), std::string::npos);
    EXPECT_NE(status.error().remedy.find("did you mean 'density'?"), std::string::npos);
}

TEST(JsonObject, KeepsTheFirstFault) {
    JsonDocument document = *JsonDocument::parse(R"({"a": "x", "b": -1, "c": 1.5})", "x.json");
    JsonObject object(document, document.root(), "");
    EXPECT_EQ(object.number("a", 2, 3), 2.0);
    EXPECT_EQ(object.number("b", 0, 3, 1.0), 1.0);
    EXPECT_EQ(object.whole("c", 1, 3), 1u);
    EXPECT_EQ(document.status().error().place, "a");
}

TEST(JsonObject, RefusesWhatNestsTooDeepToBeWalked) {
    const std::string open(1'000'000, '['), close(1'000'000, ']');
    const auto deep = JsonDocument::parse("{\"a\": " + open + close + "}", "deep.json");
    ASSERT_FALSE(deep);
    EXPECT_EQ(deep.error().id, ErrorId::limit_exceeded);
    EXPECT_EQ(deep.error().place, "byte 69");
    EXPECT_TRUE(JsonDocument::parse("{\"a\": \"" + open + "\\\"[\"}", "text.json")) << "brackets of a text";
}

TEST(JsonObject, NearestNameLeavesStrangersOut) {
    EXPECT_EQ(nearest_name("oka", {"pine", "oak"}), "oak");
    EXPECT_EQ(nearest_name("zzzzzz", {"pine", "oak"}), "");
}

}  // namespace
}  // namespace coppice
