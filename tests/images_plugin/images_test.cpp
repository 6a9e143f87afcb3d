// The images module as a host uses it: loaded by name, pictures there and back, hostile files refused.
#include "plugins/images/images.h"
#include <gtest/gtest.h>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <utility>
#include <unistd.h>
#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif
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

    // An uncompressed little-endian TIFF of 8-bit samples, pixel by pixel; what it announces need not be
    // there.
    static std::vector<std::byte> tiff(uint32_t width, uint32_t height, uint16_t channels,
                                       std::span<const uint8_t> samples, uint32_t tile_side = 0) {
        struct Entry {
            uint16_t tag, type;
            uint32_t count, value;
        };
        const uint32_t bytes = uint32_t(samples.size());
        std::vector<Entry> entries{{256, 4, 1, width},
                                   {257, 4, 1, height},
                                   {258, 3, channels, 0},
                                   {259, 3, 1, 1},
                                   {262, 3, 1, channels < 3 ? 1u : 2u}};
        if (!tile_side) entries.push_back({273, 4, 1, 0});
        entries.push_back({277, 3, 1, channels});
        if (!tile_side) entries.insert(entries.end(), {{278, 4, 1, height}, {279, 4, 1, bytes}});
        if (tile_side)
            entries.insert(
                entries.end(),
                {{322, 4, 1, tile_side}, {323, 4, 1, tile_side}, {324, 4, 1, 0}, {325, 4, 1, bytes}});
        const uint32_t color_channels = channels < 3 ? 1 : 3, extra = channels - color_channels;
        const uint32_t bits_at = 8 + 2 + 12 * uint32_t(entries.size() + (extra ? 1 : 0)) + 4;
        const uint32_t extra_at = bits_at + 2u * channels, samples_at = extra_at + 2 * extra;
        if (extra) entries.push_back({338, 3, extra, extra > 2 ? extra_at : 2});  // the first is alpha
        std::string file("II*\0\10\0\0\0", 8);
        auto put = [&file](auto value) { file.append(reinterpret_cast<const char*>(&value), sizeof value); };
        put(uint16_t(entries.size()));
        for (Entry entry : entries) {
            if (entry.tag == 258) entry.value = channels > 2 ? bits_at : channels == 2 ? 0x00080008u : 8u;
            if (entry.tag == 273 || entry.tag == 324) entry.value = samples_at;
            put(entry.tag), put(entry.type), put(entry.count), put(entry.value);
        }
        put(uint32_t(0));
        for (uint32_t c = 0; c < channels; ++c) put(uint16_t(8));
        for (uint32_t c = 0; c < extra; ++c) put(uint16_t(c == 0 ? 2 : 0));
        file.append(reinterpret_cast<const char*>(samples.data()), samples.size());
        auto first = reinterpret_cast<const std::byte*>(file.data());
        return {first, first + file.size()};
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
    const auto exr = read_text_file(folder_ / "a.exr");
    ASSERT_TRUE(exr) << to_string(exr.error());
    EXPECT_NE(exr->find("1970:01:01"), exr->npos) << "the file carries the time it was written";
}

TEST_F(Images, TruncatedAndDamagedFilesAreRefusedOrRead) {
    auto bytes = images_->encode_png(gradient(64, 64));
    ASSERT_TRUE(bytes);
#ifdef __SANITIZE_ADDRESS__
    // OpenImageIO 2.4 leaves libpng by longjmp past a string of its own: some 30 bytes for each cut PNG.
    __lsan::ScopedDisabler not_ours;
#endif
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

TEST_F(Images, TakesTheChannelsItNeeds) {
    auto pixels_of = [&](uint16_t channels, std::vector<uint8_t> samples) {
        auto picture = images_->read_memory(tiff(2, 1, channels, samples), "a.tif");
        EXPECT_TRUE(picture) << (picture ? "" : to_string(picture.error()));
        return picture ? picture->rgba : std::vector<uint8_t>();
    };
    using Bytes = std::vector<uint8_t>;
    EXPECT_EQ(pixels_of(1, {10, 20}), (Bytes{10, 10, 10, 255, 20, 20, 20, 255}));
    EXPECT_EQ(pixels_of(2, {10, 90, 20, 91}), (Bytes{10, 10, 10, 90, 20, 20, 20, 91}));
    EXPECT_EQ(pixels_of(3, {1, 2, 3, 4, 5, 6}), (Bytes{1, 2, 3, 255, 4, 5, 6, 255}));
    EXPECT_EQ(pixels_of(4, {1, 2, 3, 90, 4, 5, 6, 91}), (Bytes{1, 2, 3, 90, 4, 5, 6, 91}));
    EXPECT_EQ(pixels_of(6, {1, 2, 3, 90, 7, 8, 4, 5, 6, 91, 9, 10}), (Bytes{1, 2, 3, 90, 4, 5, 6, 91}));
}

TEST_F(Images, AFewBytesThatAnnounceGigabytesAreRefused) {
    const uint8_t some[16] = {};
    for (const auto& bytes : {tiff(4096, 4097, 64, some), tiff(16384, 8192, 9, some),
                              tiff(64, 64, 64, some, 16384), tiff(64, 64, 3, some, 1u << 30)}) {
        auto picture = images_->read_memory(bytes, "huge.tif");
        ASSERT_FALSE(picture);
        EXPECT_EQ(picture.error().id, ErrorId::limit_exceeded) << to_string(picture.error());
        EXPECT_EQ(picture.error().place, "header");
    }
    // As floats the same sides are four times the bytes.
    std::string path = folder_ / "huge.tif";
    ASSERT_TRUE(write_file(path, tiff(8192, 8192, 3, some)));
    EXPECT_EQ(images_->read_float(path).error().id, ErrorId::limit_exceeded);
}

TEST_F(Images, ComparesOverPixelsAndChannels) {
    // 12 values, of which two differ: by 0.3 and by -0.4.
    FloatPicture a{2, 2, std::vector<float>(12, 0.5f)}, b = a;
    b.rgb[0] += 0.3f;
    b.rgb[7] -= 0.4f;
    auto difference = images_->compare(a, b);
    ASSERT_TRUE(difference) << to_string(difference.error());
    EXPECT_NEAR(difference->mean, 0.7 / 12, 1e-7);
    EXPECT_NEAR(difference->largest, 0.4, 1e-7);
    EXPECT_NEAR(difference->rms, std::sqrt(0.25 / 12), 1e-7);
    EXPECT_NEAR(difference->psnr_db, 10 * std::log10(12 / 0.25), 1e-5);
    // Values above 1 raise the peak.
    for (FloatPicture* picture : {&a, &b}) picture->rgb[3] = 10.0f;
    EXPECT_NEAR(images_->compare(b, a)->psnr_db, 20 + 10 * std::log10(12 / 0.25), 1e-5);
}

TEST_F(Images, EqualPicturesAreInfinitelyFarFromNoise) {
    FloatPicture a{3, 1, {0, 1, 2, 3, 4, 5, 6, 7, 8}};
    auto difference = images_->compare(a, a);
    ASSERT_TRUE(difference) << to_string(difference.error());
    EXPECT_EQ(difference->mean, 0.0);
    EXPECT_EQ(difference->largest, 0.0);
    EXPECT_EQ(difference->rms, 0.0);
    EXPECT_EQ(difference->psnr_db, INFINITY);
}

TEST_F(Images, ComparesNoEmptyOrUnequalPictures) {
    const FloatPicture wide{4, 1, std::vector<float>(12)}, high{1, 4, std::vector<float>(12)}, empty,
        cut{4, 1, std::vector<float>(11)};
    const std::pair<FloatPicture, FloatPicture> pairs[] = {
        {wide, high}, {empty, empty}, {wide, cut}, {cut, wide}};
    for (const auto& [a, b] : pairs) {
        auto difference = images_->compare(a, b);
        ASSERT_FALSE(difference);
        EXPECT_EQ(difference.error().id, ErrorId::value_out_of_range);
    }
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
