// The images module as a host uses it: loaded by name, pictures there and back, hostile files refused.
#include "plugins/images/images.h"
#include <gtest/gtest.h>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <unistd.h>
#include "runtime/core/file.h"
#include "runtime/plugin/registry.h"

namespace coppice {
namespace {

class Images : public ::testing::Test {
  protected:
    static void SetUpTestSuite() {
        ::setenv("COPPICE_PLUGIN_PATH", IMAGES_MODULE_DIR, 1);
        registry_ = new Registry();
        auto loaded = registry_->load("images");
        ASSERT_TRUE(loaded) << to_string(loaded.error());
    }
    static void TearDownTestSuite() { delete registry_; }
    void SetUp() override {
        images_ = registry_->find<ImagesInterface>(k_images_interface, k_images_version);
        ASSERT_NE(images_, nullptr);
        folder_ = std::filesystem::temp_directory_path() /
                  ("coppice-images-" + std::to_string(::getpid()) + "-" +
                   std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    static Picture gradient(uint32_t width, uint32_t height) {
        Picture picture{width, height, {}};
        for (uint32_t y = 0; y < height; ++y)
            for (uint32_t x = 0; x < width; ++x)
                for (uint32_t c : {x * 7u, y * 5u, x + y, 255u}) picture.rgba.push_back(uint8_t(c));
        return picture;
    }

    static inline Registry* registry_ = nullptr;
    const ImagesInterface* images_ = nullptr;
    std::filesystem::path folder_;
};

TEST_F(Images, PngThereAndBackIsExact) {
    Picture picture = gradient(37, 21);
    auto bytes = images_->encode_png(picture);
    ASSERT_TRUE(bytes) << to_string(bytes.error());
    auto back = images_->read_memory(*bytes, "memory.png");
    ASSERT_TRUE(back) << to_string(back.error());
    EXPECT_EQ(back->width, 37u);
    EXPECT_EQ(back->height, 21u);
    EXPECT_EQ(back->rgba, picture.rgba);
    EXPECT_EQ(*images_->encode_png(picture), *bytes);  // no time stamp, no counter
    std::string path = folder_ / "a.png";
    ASSERT_TRUE(images_->write(path, picture));
    EXPECT_EQ(images_->read(path)->rgba, picture.rgba);
}

TEST_F(Images, FloatsThereAndBackAreExact) {
    FloatPicture picture{3, 2, {}};
    for (int i = 0; i < 18; ++i) picture.rgb.push_back(float(i) * 1.37f - 3.0f);
    for (const char* name : {"a.exr", "a.pfm"}) {
        std::string path = folder_ / name;
        auto written = images_->write_float(path, picture);
        ASSERT_TRUE(written) << to_string(written.error());
        auto back = images_->read_float(path);
        ASSERT_TRUE(back) << to_string(back.error());
        EXPECT_EQ(back->rgb, picture.rgb) << name;
    }
}

TEST_F(Images, TruncatedAndDamagedFilesAreRefusedOrRead) {
    auto bytes = images_->encode_png(gradient(64, 64));
    ASSERT_TRUE(bytes);
    for (size_t size = 0; size < bytes->size() / 2; size += 7) {
        auto result = images_->read_memory(std::span(*bytes).first(size), "cut.png");
        EXPECT_FALSE(result) << size;
    }
    for (size_t i = 0; i < bytes->size(); i += 5) {
        auto broken = *bytes;
        broken[i] ^= std::byte(0x55);
        if (auto result = images_->read_memory(broken, "broken.png"))
            EXPECT_EQ(result->rgba.size(), size_t(result->width) * result->height * 4);
        else
            EXPECT_EQ(result.error().file, "broken.png");
    }
}

TEST_F(Images, HugeSidesAreRefusedBeforeDecoding) {
    auto bytes = images_->encode_png(gradient(8, 8));
    ASSERT_TRUE(bytes);
    std::string ppm = "P6\n16385 16384\n255\n";
    auto result = images_->read_memory(std::as_bytes(std::span(ppm)), "huge.ppm");
    ASSERT_FALSE(result);
    std::string unknown = "this is no picture";
    auto text = images_->read_memory(std::as_bytes(std::span(unknown)), "text.png");
    ASSERT_FALSE(text);
    EXPECT_EQ(text.error().id, ErrorId::format_unknown);
    EXPECT_EQ(images_->read(folder_ / "missing.png").error().id, ErrorId::file_missing);
}

TEST_F(Images, FailedWriteLeavesTheOldFile) {
    std::string path = folder_ / "keep.png";
    ASSERT_TRUE(images_->write(path, gradient(4, 4)));
    auto before = read_text_file(path);
    Picture wrong = gradient(4, 4);
    wrong.rgba.pop_back();
    auto status = images_->write(path, wrong);
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().id, ErrorId::value_out_of_range);
    EXPECT_EQ(*read_text_file(path), *before);
    EXPECT_EQ(images_->write(folder_ / "a.xyz", gradient(4, 4)).error().id, ErrorId::usage);
}

}  // namespace
}  // namespace coppice
