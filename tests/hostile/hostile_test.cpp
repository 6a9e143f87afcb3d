// Whatever stands in a file, its reader says what is wrong or gives what it promises. More of the same, with a memory of what
// was reached: README.md, libFuzzer.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <gtest/gtest.h>
#include "tests/hostile/mutate.h"

using namespace coppice;
using namespace coppice::hostile;

namespace {

constexpr int k_mutants = 3000, k_truncations = 150;

class Hostile : public testing::TestWithParam<Reader> {};

}  // namespace

TEST_P(Hostile, WhatIsRightIsRead) {
    const std::vector<Bytes> seeds = GetParam().seeds();
    ASSERT_FALSE(seeds.empty());
    for (size_t i = 0; i < seeds.size(); ++i)
        EXPECT_TRUE(GetParam().read(seeds[i])) << "seed " << i << ": is the test blind?";
}

// Sealing must leave what is right as it is, or nothing behind the checksums is ever reached.
TEST_P(Hostile, ChecksumsAreSetAsTheWritersSetThem) {
    if (!GetParam().seal) GTEST_SKIP() << "a format without checksums";
    for (const Bytes& seed : GetParam().seeds()) {
        Bytes sealed = seed;
        GetParam().seal(sealed);
        EXPECT_EQ(sealed, seed);
    }
}

TEST_P(Hostile, TruncatedFilesAreNoCrash) {
    size_t refused = 0;
    for (const Bytes& seed : GetParam().seeds()) {
        const size_t step = std::max<size_t>(1, seed.size() / k_truncations);
        for (size_t length = 0; length < seed.size(); length += step)
            refused += !GetParam().read(std::span(seed).first(length));
    }
    EXPECT_GT(refused, 0u);
}

TEST_P(Hostile, BrokenFilesAreNoCrash) {
    const std::vector<Bytes> seeds = GetParam().seeds();
    Random random(1);
    int refused = 0;
    for (int i = 0; i < k_mutants; ++i)
        refused += !GetParam().read(mutate(GetParam(), seeds[size_t(i) % seeds.size()], random));
    EXPECT_GT(refused, k_mutants / 20);
    EXPECT_GT(k_mutants - refused, 0)
        << "not one mutant came through: what lies behind the first check was never reached";
}

INSTANTIATE_TEST_SUITE_P(Readers, Hostile, testing::ValuesIn(readers()),
                         [](const auto& reader) { return std::string(reader.param.name); });

// Each file that ever went wrong, by what it is read as: findings/READER/what_was_wrong.
TEST(HostileFindings, StayFixed) {
    if (!std::filesystem::exists(HOSTILE_FINDINGS_DIR)) GTEST_SKIP() << "none so far";
    for (const auto& entry : std::filesystem::recursive_directory_iterator(HOSTILE_FINDINGS_DIR)) {
        if (!entry.is_regular_file()) continue;
        const Reader* reader = find_reader(entry.path().parent_path().filename().string());
        ASSERT_TRUE(reader) << entry.path();
        SCOPED_TRACE(entry.path().string());
        std::ifstream stream(entry.path(), std::ios::binary);
        const std::string text(std::istreambuf_iterator<char>(stream), {});
        reader->read(std::as_bytes(std::span(text)));
    }
}
