#include "runtime/core/watched_files.h"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <unistd.h>
#include <gtest/gtest.h>
#include "runtime/core/file.h"

namespace coppice {
namespace {

struct WatchedFilesTest : testing::Test {
    void SetUp() override {
        folder = testing::TempDir() + "watched_files_" + std::to_string(::getpid());
        std::filesystem::create_directories(folder);
        write("a", "one");
        write("b", "two");
    }
    void TearDown() override { std::filesystem::remove_all(folder); }
    std::string path(const char* name) const { return folder + "/" + name; }
    void write(const char* name, const char* text) { ASSERT_TRUE(write_text_file(path(name), text)); }
    std::string folder;
};

TEST_F(WatchedFilesTest, SayOnceThatOneOfThoseReadHasChanged) {
    WatchedFiles files;
    files.begin();
    ASSERT_TRUE(read_text_file(path("a")));
    files.end();
    ASSERT_TRUE(read_text_file(path("b")));  // not what was loaded
    EXPECT_EQ(files.size(), 1u);
    EXPECT_FALSE(files.changed());
    write("b", "three");
    EXPECT_FALSE(files.changed());
    write("a", "four more");
    EXPECT_TRUE(files.changed());
    EXPECT_FALSE(files.changed());
    // Also one of the same length.
    std::filesystem::last_write_time(path("a"),
                                     std::filesystem::last_write_time(path("a")) + std::chrono::seconds(2));
    EXPECT_TRUE(files.changed());
    std::filesystem::remove(path("a"));
    EXPECT_TRUE(files.changed());
    EXPECT_FALSE(files.changed());
    write("a", "one");
    EXPECT_TRUE(files.changed());
}

TEST_F(WatchedFilesTest, KeepWhatWasWatchedBefore) {
    WatchedFiles files;
    for (const char* name : {"a", "b"}) {
        files.begin();
        ASSERT_TRUE(read_text_file(path(name)));
        files.end();
    }
    write("a", "more than one");
    EXPECT_TRUE(files.changed());
}

// A host that watches files itself learns of those that are loaded for it, and goes on watching.
TEST_F(WatchedFilesTest, TellWhoWatchedBefore) {
    std::vector<std::string> told;
    set_file_watcher(
        [](void* context, const std::string& path) {
            static_cast<std::vector<std::string>*>(context)->push_back(path);
        },
        &told);
    WatchedFiles files;
    files.begin();
    ASSERT_TRUE(read_text_file(path("a")));
    files.end();
    ASSERT_TRUE(read_text_file(path("b")));
    set_file_watcher(nullptr, nullptr);
    EXPECT_EQ(told, (std::vector{path("a"), path("b")}));
    EXPECT_EQ(files.size(), 1u);
}

TEST_F(WatchedFilesTest, SeeWhatIsWrittenWhileItIsLoaded) {
    WatchedFiles files;
    files.begin();
    ASSERT_TRUE(read_text_file(path("a")));
    write("a", "more than one");
    files.end();
    EXPECT_TRUE(files.changed());
}

}  // namespace
}  // namespace coppice
