// The runtime is an engine's kernel: it knows nothing of what is drawn with it.
#include <algorithm>
#include <cctype>
#include <string>
#include <gtest/gtest.h>
#include "tests/structure/source_tree.h"

TEST(Words, RuntimeNeverSpeaksOfWhatGrows) {
    const std::vector<SourceFile> files = read_sources("runtime");
    ASSERT_FALSE(files.empty());
    for (const SourceFile& file : files) {
        std::string text = file.text;
        std::transform(text.begin(), text.end(), text.begin(),
                       [](unsigned char c) { return std::tolower(c); });
        for (const char* word : {"plant", "leaf", "foliage", "vegetation"}) {
            const size_t at = text.find(word);
            EXPECT_EQ(at, std::string::npos)
                << file.path << ":"
                << std::count(text.begin(), text.begin() + long(std::min(at, text.size())), '\n') + 1
                << " says '" << word << "'";
        }
    }
}

TEST(Words, NothingIsLeftToDo) {
    for (const char* folder : {"runtime", "plugins", "tools", "editor"})
        for (const SourceFile& file : read_sources(folder))
            for (const char* word : {"TODO", "FIXME", "XXX:"})
                EXPECT_EQ(file.text.find(word), std::string::npos) << file.path << " says " << word;
}
