#include "tools/coppice/bench_queries.h"

#include <algorithm>
#include <ctime>
#include <optional>
#include <string>
#include <vector>
#include "plugins/vegetation/query/stem_index.h"
#include "runtime/core/random.h"
#include "tools/coppice/figure.h"

namespace coppice {
namespace {

constexpr uint32_t k_stems_a_side = 1000, k_queries = 200'000;
constexpr float k_spacing_m = 7.0f, k_side_m = k_spacing_m * float(k_stems_a_side);
constexpr int k_rounds = 5;

double thread_ns() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return double(now.tv_sec) * 1e9 + double(now.tv_nsec);
}

std::vector<Stem> make_stems(Random& random) {
    std::vector<Stem> stems;
    stems.reserve(size_t(k_stems_a_side) * k_stems_a_side);
    for (uint32_t z = 0; z < k_stems_a_side; ++z)
        for (uint32_t x = 0; x < k_stems_a_side; ++x) {
            const dvec3 foot(double(k_spacing_m * (float(x) + random.next_unit())),
                             double(random.next_in(0, 3)),
                             double(k_spacing_m * (float(z) + random.next_unit())));
            const float height_m = random.next_in(6.0f, 20.0f);
            const dvec3 lean(double(random.next_around(0, 0.03f) * height_m), double(height_m),
                             double(random.next_around(0, 0.03f) * height_m));
            stems.push_back({foot, foot + lean, random.next_in(0.08f, 0.3f), z * k_stems_a_side + x});
        }
    return stems;
}

struct Asked {
    double ns;           // each, in the best round
    double found_share;  // of those that found something, or how many a query found
};

// ask(i): how many were found.
template <class Ask>
Asked measure(uint32_t count, Ask&& ask) {
    Asked asked{INFINITY, 0.0};
    for (int round = 0; round < k_rounds; ++round) {
        uint64_t found = 0;
        const double begin = thread_ns();
        for (uint32_t i = 0; i < count; ++i) found += ask(i);
        asked.ns = std::min(asked.ns, (thread_ns() - begin) / double(count));
        asked.found_share = double(found) / double(count);
    }
    return asked;
}

struct Ray {
    dvec3 from;
    vec3 direction;
};

// rise: how much of a unit of way a ray goes up or down at most.
std::vector<Ray> make_rays(Random& random, float height_m, float least_rise, float most_rise) {
    std::vector<Ray> rays(k_queries);
    for (Ray& ray : rays) {
        ray.from =
            dvec3(double(random.next_in(0, k_side_m)), double(height_m), double(random.next_in(0, k_side_m)));
        const float angle = random.next_in(0.0f, 2.0f * k_pi);
        ray.direction = vec3(portable_cos(angle), random.next_in(least_rise, most_rise), portable_sin(angle));
    }
    return rays;
}

}  // namespace

Result<nlohmann::json> bench_queries() {
    Random random(1);
    const std::vector<Stem> stems = make_stems(random);
    nlohmann::json figures = nlohmann::json::array();
    auto add = [&](std::string name, double value, const char* unit, std::optional<double> reach = {},
                   Reach direction = Reach::at_least) {
        figures.push_back(to_json({std::move(name), value, unit, reach, direction}));
    };
    const double begin = thread_ns();
    StemIndex index(stems);
    add("index of 1 M stems: made in", (thread_ns() - begin) * 1e-6, "ms");
    add("index of 1 M stems: memory", double(index.size_bytes()) / double(index.size()), "B/stem");

    struct Kind {
        const char* name;
        float height_m, least_rise, most_rise, most_m;
        bool asked;
    };
    for (const Kind& kind : {Kind{"rays of 100 m at eye level", 2.5f, -0.05f, 0.05f, 100.0f, true},
                             Kind{"rays of 1,000 m at eye level", 2.5f, 0.0f, 0.01f, 1000.0f, false},
                             Kind{"rays down from 60 m", 60.0f, -3.0f, -0.5f, 200.0f, false},
                             Kind{"rays of 2 m (a bullet's step)", 2.5f, -0.05f, 0.05f, 2.0f, false}}) {
        const std::vector<Ray> rays = make_rays(random, kind.height_m, kind.least_rise, kind.most_rise);
        const Asked asked = measure(k_queries, [&](uint32_t i) -> uint64_t {
            return index.first_hit(rays[i].from, rays[i].direction, kind.most_m).any();
        });
        add(kind.name, 1e3 / asked.ns, "M/s a core", kind.asked ? std::optional(1.0) : std::nullopt);
        add(std::string(kind.name) + ": hits", asked.found_share, "share");
    }
    const std::vector<Ray> places = make_rays(random, 2.0f, 0.0f, 0.0f);
    const Asked nearest = measure(
        k_queries, [&](uint32_t i) -> uint64_t { return index.nearest(places[i].from, 20.0f).any(); });
    add("nearest stem within 20 m", nearest.ns * 1e-3, "us");
    std::vector<Stem> found;
    const Asked boxes = measure(k_queries / 10, [&](uint32_t i) -> uint64_t {
        found.clear();
        index.in_box(places[i].from - 20.0, places[i].from + 20.0, found);
        return found.size();
    });
    add("stems in a box of 40 m", boxes.ns * 1e-3, "us");
    add("stems in a box of 40 m: found", boxes.found_share, "stems");
    const Asked edits = measure(k_queries / 10, [&](uint32_t i) -> uint64_t {
        Stem moved = stems[random.next_below(uint32_t(stems.size()))];
        moved.foot_world.x += double(i & 7u);
        index.set(moved);
        return 1;
    });
    add("a stem moved", edits.ns * 1e-3, "us");
    return nlohmann::json{{"name", "queries"}, {"figures", std::move(figures)}};
}

}  // namespace coppice
