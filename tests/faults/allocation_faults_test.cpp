// Allocations of memory fail once, each in its turn, while plants are cooked and placed: std::bad_alloc or an error
// comes out, all that was allocated is free again, and the next try gives what there is without failures.
#include <atomic>
#include <cstdlib>
#include <functional>
#include <gtest/gtest.h>
#include <new>
#include <utility>
#include "plugins/vegetation/cook/cook_plant.h"
#include "plugins/vegetation/eco/make_tiles.h"
#include "plugins/vegetation/plant/plant.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"
#include "tests/cook/shapes.h"

namespace {

std::atomic<int64_t> g_countdown{-1}, g_live{0};

void* allocate(size_t bytes, size_t alignment) {
    if (g_countdown.load() >= 0 && g_countdown.fetch_sub(1) == 0) throw std::bad_alloc();
    void* memory = alignment > alignof(std::max_align_t)
                       ? std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment)
                       : std::malloc(bytes ? bytes : 1);
    if (!memory) throw std::bad_alloc();
    ++g_live;
    return memory;
}

void release(void* memory) {
    if (memory) --g_live;
    std::free(memory);
}

}  // namespace

#pragma GCC visibility push(default)  // for the libraries to find
void* operator new(size_t bytes) { return allocate(bytes, 0); }
void* operator new(size_t bytes, std::align_val_t alignment) { return allocate(bytes, size_t(alignment)); }
void operator delete(void* memory) noexcept { release(memory); }
void operator delete(void* memory, size_t) noexcept { release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete(void* memory, size_t, std::align_val_t) noexcept { release(memory); }
#pragma GCC visibility pop

namespace coppice {
namespace {

// What comes out as a number; 0: an error.
using Work = std::function<uint64_t()>;

// The first allocations each, then ever fewer of them: later ones repeat what earlier ones did.
uint64_t next(uint64_t n) { return n + 1 + n / 4; }

void expect_survived(const char* what, const Work& work) {
    const uint64_t whole = work();
    ASSERT_NE(whole, 0u) << what;
    const int64_t live = g_live;
    uint64_t n = 0, failures = 0;
    for (bool struck = true; struck; n = next(n)) {
        g_countdown = int64_t(n);
        uint64_t got = 0;
        try {
            got = work();
        } catch (const std::bad_alloc&) {
        }
        struck = g_countdown < 0;
        g_countdown = -1;
        failures += struck;
        EXPECT_TRUE(got == 0 || got == whole) << what << ", allocation " << n;
        ASSERT_EQ(g_live, live) << what << ": left behind after allocation " << n;
    }
    EXPECT_GT(failures, 8u) << what;
    EXPECT_EQ(work(), whole) << what;
}

class AllocationFaults : public ::testing::Test {
  protected:
    void SetUp() override { set_thread_limit(1); }
    void TearDown() override { set_thread_limit(0); }

    static PlantDescription tuft() {
        PlantDescription tuft;
        tuft.name = "tuft";
        tuft.parts.push_back(shapes::leaf_cloud(60, 0.4f, 0.08f, 5, vec3(0, 0.5f, 0)));
        return tuft;
    }
};

TEST_F(AllocationFaults, OfACook) {
    const PlantDescription plant = tuft();
    expect_survived("cook", [&]() -> uint64_t {
        const auto bytes = cook_plant(plant, {});
        return bytes ? hash_bytes(bytes->data(), bytes->size()) : 0;
    });
}

TEST_F(AllocationFaults, OfPlacedPlants) {
    expect_survived("tiles", []() -> uint64_t {
        std::vector<Placement> placements;
        for (uint32_t i = 0; i < 3000; ++i)
            placements.push_back(
                {dvec3(0.7 * (i % 60), 0.0, 0.9 * (i / 60)), 1.0f, PlantTurn{0, 0, 0, 32767}, {0, i}});
        Scene scene;
        scene.models.resize(1);
        make_tiles(placements, scene);
        finish_tiles(scene, std::vector<Box>{{vec3(-1, 0, -1), vec3(1, 2, 1)}});
        return hash_span(std::span(std::as_const(scene.plant_models)));
    });
}

// What is looked at where it lies takes none at all.
TEST_F(AllocationFaults, APackedPlantIsLoadedWithoutAny) {
    const auto bytes = cook_plant(tuft(), {});
    ASSERT_TRUE(bytes);
    const auto packed = std::make_shared<const std::vector<std::byte>>(*bytes);
    g_countdown = 0;
    const auto plant = load_plant_from_memory(packed, "tuft");
    EXPECT_EQ(g_countdown, 0);
    g_countdown = -1;
    EXPECT_TRUE(plant);
}

}  // namespace
}  // namespace coppice
