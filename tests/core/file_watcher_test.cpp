#include "runtime/core/file_watcher.h"

#include <filesystem>
#include <string>
#include <vector>
#include <unistd.h>
#include <gtest/gtest.h>
#include "runtime/core/file.h"
#include "runtime/core/mapped_file.h"
#include "runtime/core/open_file.h"

namespace coppice {
namespace {

void keep(void* context, const std::string& path) {
    static_cast<std::vector<std::string>*>(context)->push_back(path);
}

}  // namespace

TEST(FileWatcher, IsToldOfWhatIsOpenedAndOfNothingElse) {
    const std::string path = testing::TempDir() + "coppice_watched_" + std::to_string(::getpid());
    ASSERT_TRUE(write_text_file(path, "text"));
    std::vector<std::string> opened;
    set_file_watcher(&keep, &opened);
    EXPECT_TRUE(read_text_file(path));
    EXPECT_FALSE(MappedFile::open(path + "_none"));
    EXPECT_FALSE(MappedFile::open(testing::TempDir()));
    EXPECT_TRUE(MappedFile::open(path));
    EXPECT_TRUE(OpenFile::open(path));
    EXPECT_TRUE(write_text_file(path, ""));
    set_file_watcher(nullptr, nullptr);
    EXPECT_TRUE(MappedFile::open(path));
    EXPECT_EQ(opened, (std::vector<std::string>{path, path, path}));
    std::filesystem::remove(path);
}

}  // namespace coppice
