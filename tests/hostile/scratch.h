// Files with hostile bytes in them, for readers of files.
#pragma once
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <unistd.h>

namespace coppice::hostile {

inline std::string_view as_text(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// A file with these bytes; one of each name a process.
class Scratch {
  public:
    Scratch(const std::string& name, std::string_view text) : Scratch(name, std::as_bytes(std::span(text))) {}
    Scratch(const std::string& name, std::span<const std::byte> bytes) : path_(folder() + "/" + name) {
        // A new file: some file systems wait for the disk where one is written over.
        std::filesystem::remove(path_);
        std::ofstream(path_, std::ios::binary | std::ios::trunc)
            .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    }
    const std::string& path() const { return path_; }

    static const std::string& folder() {
        static const Folder k_folder;
        return k_folder.path;
    }

  private:
    struct Folder {
        const std::string path = (in_memory() / ("hostile_" + std::to_string(::getpid()))).string();
        // Journals wait for the disk at each step.
        static std::filesystem::path in_memory() {
            std::error_code ignored;
            return std::filesystem::is_directory("/dev/shm", ignored)
                       ? "/dev/shm"
                       : std::filesystem::temp_directory_path();
        }
        Folder() { std::filesystem::create_directories(path); }
        ~Folder() {
            std::error_code ignored;
            std::filesystem::remove_all(path, ignored);
        }
    };
    std::string path_;
};

}  // namespace coppice::hostile
