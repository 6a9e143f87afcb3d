// The project's own sources as text, for tests about how the house is built.
#pragma once
#include <string>
#include <vector>

struct SourceFile {
    std::string path;  // from the repository's root, "runtime/core/math.h"
    std::string text;
};

struct Include {
    std::string from, to;  // paths from the root
    int line;
};

// All C++ and shader sources and CMake files under a folder of the repository, sorted by path.
std::vector<SourceFile> read_sources(const std::string& folder);

// The includes in quotes of all C++ files and shaders under a folder, as they are written.
std::vector<Include> find_includes(const std::string& folder);
