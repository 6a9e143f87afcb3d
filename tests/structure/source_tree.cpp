#include "tests/structure/source_tree.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

std::vector<SourceFile> read_sources(const std::string& folder) {
    const std::filesystem::path root = COPPICE_SOURCE_DIR;
    const std::set<std::string> kinds{".h", ".cpp", ".comp", ".glsl", ".txt", ".cmake"};
    std::vector<SourceFile> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
        if (!entry.is_regular_file() || !kinds.contains(entry.path().extension().string())) continue;
        std::ifstream stream(entry.path(), std::ios::binary);
        files.push_back({std::filesystem::relative(entry.path(), root).generic_string(),
                         std::string(std::istreambuf_iterator<char>(stream), {})});
    }
    std::sort(files.begin(), files.end(), [](auto& a, auto& b) { return a.path < b.path; });
    return files;
}

std::vector<Include> find_includes(const std::string& folder) {
    std::vector<Include> includes;
    for (const SourceFile& file : read_sources(folder)) {
        std::istringstream stream(file.text);
        std::string line;
        for (int number = 1; std::getline(stream, line); ++number) {
            const size_t hash = line.find_first_not_of(" \t");
            if (hash == std::string::npos || line.compare(hash, 8, "#include") != 0) continue;
            const size_t open = line.find_first_of("\"<", hash + 8);
            if (open == std::string::npos) continue;
            const size_t close = line.find(line[open] == '<' ? '>' : '"', open + 1);
            if (close != std::string::npos)
                includes.push_back({file.path, line.substr(open + 1, close - open - 1), number});
        }
    }
    return includes;
}
