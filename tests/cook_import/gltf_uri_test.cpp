#include "plugins/vegetation/cook/import/gltf_uri.h"
#include <gtest/gtest.h>

namespace coppice {
namespace {

TEST(GltfUri, StaysInTheFolder) {
    auto resolve = [](const char* uri) { return resolve_uri(uri, "plants", "p.gltf", "images[0]"); };
    EXPECT_EQ(resolve("a.png").value(), "plants/a.png");
    EXPECT_EQ(resolve("my%20leaf.png").value(), "plants/my leaf.png");
    EXPECT_EQ(resolve("textures/../a.png").value(), "plants/textures/../a.png");
    for (const char* uri : {"../x", "%2e%2e/x", "a/../../x", "/etc/passwd", "file:///etc/passwd",
                            "http://a/b", "..\\x", "", "%0", "%zz", "a%00b"}) {
        auto result = resolve(uri);
        ASSERT_FALSE(result) << uri;
        EXPECT_EQ(result.error().id, ErrorId::value_out_of_range);
        EXPECT_EQ(result.error().place, "images[0]");
    }
}

TEST(GltfUri, DecodesBase64) {
    auto bytes = decode_data_uri("data:application/octet-stream;base64,AAECAw==", "p.gltf", "buffers[0]");
    ASSERT_TRUE(bytes);
    ASSERT_EQ(bytes->size(), 4u);
    for (int i = 0; i < 4; ++i) EXPECT_EQ(int((*bytes)[size_t(i)]), i);
    EXPECT_FALSE(decode_data_uri("data:;base64,A*==", "p.gltf", "buffers[0]"));
    EXPECT_FALSE(decode_data_uri("data:text/plain,abc", "p.gltf", "buffers[0]"));
}

}  // namespace
}  // namespace coppice
