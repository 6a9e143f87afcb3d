#include "runtime/core/open_file.h"

#include <gtest/gtest.h>
#include <array>
#include <filesystem>
#include <sys/stat.h>
#include <unistd.h>
#include "runtime/core/file.h"

namespace coppice {
namespace {

class OpenedFile : public testing::Test {
  protected:
    OpenedFile() : path_(testing::TempDir() + "coppice_open_file_test_" + std::to_string(::getpid())) {
        EXPECT_TRUE(write_text_file(path_, "0123456789"));
    }
    ~OpenedFile() override { std::filesystem::remove(path_); }
    std::string path_;
};

Result<std::string> read(const OpenFile& file, uint64_t offset_bytes, size_t size_bytes) {
    std::string text(size_bytes, '?');
    COPPICE_CHECK(file.read(offset_bytes, std::as_writable_bytes(std::span(text))));
    return text;
}

TEST_F(OpenedFile, ReadsAtAnyPlace) {
    auto file = OpenFile::open(path_);
    ASSERT_TRUE(file);
    EXPECT_EQ(file->size_bytes(), 10u);
    EXPECT_EQ(*read(*file, 7, 3), "789");
    EXPECT_EQ(*read(*file, 0, 10), "0123456789");
    EXPECT_EQ(*read(*file, 10, 0), "");
    const OpenFile moved = std::move(*file);
    EXPECT_EQ(*read(moved, 1, 1), "1");
}

TEST_F(OpenedFile, SaysWhereItEnds) {
    auto file = OpenFile::open(path_);
    ASSERT_TRUE(file);
    for (uint64_t offset : {uint64_t(8), uint64_t(11), uint64_t(1) << 32, UINT64_MAX}) {
        auto beyond = read(*file, offset, 3);
        ASSERT_FALSE(beyond);
        EXPECT_EQ(beyond.error().id, ErrorId::file_truncated);
        EXPECT_EQ(beyond.error().file, path_);
        EXPECT_EQ(beyond.error().place, "byte " + std::to_string(offset));
    }
    ASSERT_EQ(::truncate(path_.c_str(), 5), 0);
    EXPECT_EQ(*read(*file, 2, 3), "234");
    EXPECT_EQ(read(*file, 4, 3).error().id, ErrorId::file_truncated);
}

TEST_F(OpenedFile, IsARegularFile) {
    EXPECT_EQ(OpenFile::open(path_ + "_no").error().id, ErrorId::file_missing);
    EXPECT_EQ(OpenFile::open(testing::TempDir()).error().id, ErrorId::file_missing);
    const std::string pipe = path_ + "_pipe";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    EXPECT_EQ(OpenFile::open(pipe).error().id, ErrorId::file_missing);
    std::filesystem::remove(pipe);
}

}  // namespace
}  // namespace coppice
