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
