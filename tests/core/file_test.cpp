#include "runtime/core/file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>
#include <atomic>
#include <filesystem>
#include <thread>
#include <vector>

namespace coppice {
namespace {

namespace fs = std::filesystem;

class WriteFile : public testing::Test {
  protected:
    WriteFile() : folder_(fs::temp_directory_path() / ("coppice_file_test_" + std::to_string(::getpid()))) {
        fs::remove_all(folder_);
        fs::create_directories(folder_);
        old_mask_ = ::umask(027);
    }
    ~WriteFile() override {
        ::umask(old_mask_);
        fs::remove_all(folder_);
    }
    std::string path_of(const std::string& name) const { return (folder_ / name).string(); }
    static unsigned mode_of(const std::string& path) {
        struct stat status {};
        EXPECT_EQ(::stat(path.c_str(), &status), 0) << path;
        return status.st_mode & 0777u;
    }
    size_t file_count() const {
        return size_t(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
    }

    fs::path folder_;
    mode_t old_mask_;
};

TEST_F(WriteFile, ReplacesWholeFilesAndLeavesNothingBeside) {
    std::string path = path_of("a.txt");
    ASSERT_TRUE(write_text_file(path, "a long first text"));
    ASSERT_TRUE(write_text_file(path, "second"));
    EXPECT_EQ(*read_text_file(path), "second");
    ASSERT_TRUE(write_text_file(path_of("new/folder/b.txt"), ""));
    EXPECT_EQ(file_count(), 2u);
}

TEST_F(WriteFile, AFailureNamesTheFileAndLeavesNothingBehind) {
    fs::create_directories(path_of("taken"));
    auto status = write_text_file(path_of("taken"), "text");
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().id, ErrorId::write_failed);
    EXPECT_EQ(status.error().file, path_of("taken"));
    EXPECT_EQ(file_count(), 1u);
}

// Who asks for the umask must set it, and so takes it from all other threads for a moment: their new files
// then come out with other permissions.
TEST_F(WriteFile, LeavesTheUmaskToOtherThreads) {
    constexpr int k_threads = 4, k_files = 500;
    std::atomic<bool> done{false};
    unsigned seen = 0;
    std::thread witness([&] {
        std::string path = path_of("witness");
        while (!done) {
            int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
            struct stat status {};
            if (fd < 0 || ::fstat(fd, &status) != 0) break;
            seen |= status.st_mode & 0777u;
            ::close(fd);
            ::unlink(path.c_str());
        }
    });
    std::vector<std::thread> threads;
    for (int t = 0; t < k_threads; ++t)
        threads.emplace_back([&, t] {
            for (int i = 0; i < k_files; ++i)
                EXPECT_TRUE(write_text_file(path_of(std::to_string(t)), std::to_string(i)));
        });
    for (std::thread& thread : threads) thread.join();
    done = true;
    witness.join();
    EXPECT_EQ(seen, 0640u);
    for (int t = 0; t < k_threads; ++t) {
        EXPECT_EQ(mode_of(path_of(std::to_string(t))), 0640u);
        EXPECT_EQ(*read_text_file(path_of(std::to_string(t))), std::to_string(k_files - 1));
    }
    EXPECT_EQ(::umask(027), mode_t(027));
    EXPECT_EQ(file_count(), size_t(k_threads));
}

}  // namespace
}  // namespace coppice
