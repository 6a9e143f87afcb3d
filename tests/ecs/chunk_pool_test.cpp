#include <cstdint>
#include <cstring>
#include <vector>
#include <gtest/gtest.h>
#include "runtime/core/random.h"
#include "runtime/ecs/chunk_pool.h"

namespace coppice {
namespace {

TEST(ChunkPool, PiecesAreAlignedAndDoNotOverlap) {
    ChunkPool pool(1 << 20);
    struct Piece {
        unsigned char* memory;
        size_t size_bytes;
        unsigned char mark;
    };
    std::vector<Piece> pieces;
    Random random(7);
    for (int step = 0; step < 4000; ++step) {
        if (pieces.empty() || random.next_below(5) < 3) {
            size_t size = random.next_below(random.next_below(10) ? 3000 : 100000);
            auto* memory = static_cast<unsigned char*>(pool.allocate(size));
            ASSERT_EQ(reinterpret_cast<uintptr_t>(memory) % 64, 0u);
            auto mark = static_cast<unsigned char>(step);
            std::memset(memory, mark, size);
            pieces.push_back({memory, size, mark});
        } else {
            size_t place = random.next_below(uint32_t(pieces.size()));
            Piece piece = pieces[place];
            for (size_t i = 0; i < piece.size_bytes; ++i) ASSERT_EQ(piece.memory[i], piece.mark);
            pool.release(piece.memory, piece.size_bytes);
            pieces[place] = pieces.back();
            pieces.pop_back();
        }
        ASSERT_LE(pool.kept_bytes(), size_t(1) << 20);
    }
    for (Piece piece : pieces) pool.release(piece.memory, piece.size_bytes);
    EXPECT_EQ(pool.used_bytes(), 0u);
    pool.trim();
    EXPECT_EQ(pool.kept_bytes(), 0u);
}

TEST(ChunkPool, GivesTheSameMemoryAgainAndWastesAtMostAnEighth) {
    ChunkPool pool(1 << 20);
    void* memory = pool.allocate(32000);
    EXPECT_LE(pool.used_bytes(), 32000u * 9 / 8);
    EXPECT_GE(pool.used_bytes(), 32000u);
    pool.release(memory, 32000);
    EXPECT_EQ(pool.allocate(32001), memory);
    pool.release(memory, 32001);
    for (size_t size = 513; size < 5'000'000; size += size / 7) {
        size_t before = pool.used_bytes();
        void* piece = pool.allocate(size);
        EXPECT_GE(pool.used_bytes() - before, size);
        EXPECT_LE(pool.used_bytes() - before, size + size / 8 + 64);
        pool.release(piece, size);
    }
}

}  // namespace
}  // namespace coppice
