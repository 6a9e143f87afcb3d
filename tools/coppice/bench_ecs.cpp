#include "tools/coppice/bench_ecs.h"

#include <chrono>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <vector>
#include "runtime/core/random.h"
#include "runtime/ecs/query.h"
#include "runtime/ecs/world.h"
#include "tools/coppice/figure.h"
#include "tools/coppice/statistics.h"

namespace coppice {
namespace {
struct BenchPosition {
    static constexpr const char* k_component_name = "bench_position";
    float x, y, z;
};
struct BenchVelocity {
    static constexpr const char* k_component_name = "bench_velocity";
    float x, y, z;
};
struct BenchAge {
    static constexpr const char* k_component_name = "bench_age";
    float age_s;
    uint32_t step_count;
};

constexpr uint32_t k_tile_size = 1000;
constexpr float k_step_s = 1.0f / 60;
constexpr size_t k_access_count = 1'000'000;

// The same contents and the same work, once in plain arrays and once in the world.
void fill(BenchPosition* positions, BenchVelocity* velocities, BenchAge* ages, uint32_t tile) {
    for (uint32_t row = 0; row < k_tile_size; ++row) {
        positions[row] = {float(row), float(tile), 0};
        velocities[row] = {1, 2, float(row)};
        ages[row] = {0, tile};
    }
}

inline void update(BenchPosition& position, const BenchVelocity& velocity, BenchAge& age) {
    position.x += velocity.x * k_step_s;
    position.y += velocity.y * k_step_s;
    position.z += velocity.z * k_step_s;
    age.age_s += k_step_s;
    ++age.step_count;
}

// Keeps the memory of destroyed tiles for the next ones, as the world does.
class PlainArrays {
  public:
    explicit PlainArrays(uint32_t tile_count) : tiles_(tile_count) {}
    void create(uint32_t tile) {
        Tile& made = tiles_[tile];
        if (!spare_.empty()) {
            made = std::move(spare_.back());
            spare_.pop_back();
        } else {
            made.positions = std::make_unique_for_overwrite<BenchPosition[]>(k_tile_size);
            made.velocities = std::make_unique_for_overwrite<BenchVelocity[]>(k_tile_size);
            made.ages = std::make_unique_for_overwrite<BenchAge[]>(k_tile_size);
        }
        fill(made.positions.get(), made.velocities.get(), made.ages.get(), tile);
    }
    void destroy(uint32_t tile) { spare_.push_back(std::move(tiles_[tile])); }
    void update_all() {
        for (Tile& tile : tiles_)
            for (uint32_t row = 0; row < k_tile_size; ++row)
                update(tile.positions[row], tile.velocities[row], tile.ages[row]);
    }
    float read(uint32_t number) const {
        return tiles_[number / k_tile_size].positions[number % k_tile_size].x;
    }

  private:
    struct Tile {
        std::unique_ptr<BenchPosition[]> positions;
        std::unique_ptr<BenchVelocity[]> velocities;
        std::unique_ptr<BenchAge[]> ages;
    };
    std::vector<Tile> tiles_;
    std::vector<Tile> spare_;
};

class Entities {
  public:
    explicit Entities(uint32_t tile_count)
        : world_({.pool_limit_bytes = size_t(tile_count) * k_tile_size * 40}), tiles_(tile_count) {}
    void create(uint32_t tile) {
        auto [id, positions, velocities, ages] =
            world_.create_chunk<BenchPosition, BenchVelocity, BenchAge>(k_tile_size);
        fill(positions.data(), velocities.data(), ages.data(), tile);
        tiles_[tile] = id;
    }
    void destroy(uint32_t tile) { world_.destroy_chunk(tiles_[tile]); }
    void update_all() { world_.query<BenchPosition, const BenchVelocity, BenchAge>().each(update); }
    float read(Entity entity) const { return world_.get<BenchPosition>(entity)->x; }
    Entity entity(uint32_t number) const {
        return world_.chunk(tiles_[number / k_tile_size]).entity(number % k_tile_size);
    }
    size_t memory_bytes() const { return world_.memory_bytes(); }

  private:
    World world_;
    std::vector<ChunkId> tiles_;
};

template <class Work>
double time_ns(Work&& work) {
    auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count();
}

// Both take turns, so that a noisy neighbour hits both; the first round warms up and does not count.
struct Paired {
    std::vector<double> plain_ns, ours_ns, ratios;

    template <class Plain, class Ours>
    Paired(int round_count, double divisor, Plain&& plain, Ours&& ours) {
        for (int round = -1; round < round_count; ++round) {
            double p = time_ns(plain) / divisor;
            double o = time_ns(ours) / divisor;
            if (round < 0) continue;
            plain_ns.push_back(p);
            ours_ns.push_back(o);
            ratios.push_back(o / p);
        }
    }
};

// With the plain arrays' value behind it, of which nothing is asked.
void add_figure(nlohmann::json& figures, const std::string& name, double value, const char* unit,
                std::optional<double> reach, std::optional<double> plain) {
    figures.push_back(to_json({name, value, unit, reach, Reach::at_most}));
    if (plain) figures.push_back(to_json({name + ", plain arrays", *plain, unit, {}}));
}

void measure(nlohmann::json& figures, uint32_t tile_count, int round_count, const std::string& size) {
    const uint32_t count = tile_count * k_tile_size;
    PlainArrays plain(tile_count);
    Entities ours(tile_count);
    auto create_and_destroy_all = [&](auto& store) {
        for (uint32_t tile = 0; tile < tile_count; ++tile) store.create(tile);
        for (uint32_t tile = 0; tile < tile_count; ++tile) store.destroy(tile);
    };
    Paired life(
        round_count, count, [&] { create_and_destroy_all(plain); }, [&] { create_and_destroy_all(ours); });
    add_figure(figures, size + ": create, destroy", median(life.ours_ns), "ns/entity", 6,
               median(life.plain_ns));

    for (uint32_t tile = 0; tile < tile_count; ++tile) {
        plain.create(tile);
        ours.create(tile);
    }
    // In a world that stays full.
    Random random(1);
    std::vector<uint32_t> order(tile_count);
    for (uint32_t& tile : order) tile = random.next_below(tile_count);
    auto stream = [&](auto& store) {
        for (uint32_t tile : order) {
            store.destroy(tile);
            store.create(tile);
        }
    };
    Paired streaming(
        round_count, count, [&] { stream(plain); }, [&] { stream(ours); });
    add_figure(figures, size + ": stream tiles", median(streaming.ours_ns), "ns/entity", 6,
               median(streaming.plain_ns));

    Paired updates(
        round_count, count, [&] { plain.update_all(); }, [&] { ours.update_all(); });
    add_figure(figures, size + ": update", median(updates.ours_ns), "ns/entity", {},
               median(updates.plain_ns));
    add_figure(figures, size + ": update / plain arrays", median(updates.ratios), "ratio", 1.2, {});

    std::vector<uint32_t> numbers(k_access_count);
    std::vector<Entity> entities(k_access_count);
    for (size_t i = 0; i < k_access_count; ++i) {
        numbers[i] = random.next_below(count);
        entities[i] = ours.entity(numbers[i]);
    }
    double plain_sum = 0, our_sum = 0;
    Paired access(
        round_count, double(k_access_count),
        [&] {
            for (uint32_t number : numbers) plain_sum += double(plain.read(number));
        },
        [&] {
            for (Entity entity : entities) our_sum += double(ours.read(entity));
        });
    add_figure(figures, size + ": random access", median(access.ours_ns), "ns/entity", 40,
               median(access.plain_ns));
    add_figure(figures, size + ": memory", double(ours.memory_bytes()) / count, "B/entity", 44,
               double(sizeof(BenchPosition) + sizeof(BenchVelocity) + sizeof(BenchAge)));
    // Both did the same work; that also keeps the compiler from dropping it.
    add_figure(figures, size + ": sums that differ", double(plain_sum != our_sum), "", 0, {});
}
}  // namespace

Result<nlohmann::json> bench_ecs() {
    nlohmann::json figures = nlohmann::json::array();
    try {
        measure(figures, 1'000, 21, "1 M");
        measure(figures, 10'000, 7, "10 M");
    } catch (const std::bad_alloc&) {
        return fail(ErrorId::limit_exceeded, "", "bench ecs", "not enough memory for 10 M entities",
                    "free about 0.7 GB");
    }
    return nlohmann::json{{"name", "ecs"}, {"figures", std::move(figures)}};
}

}  // namespace coppice
