#include "tools/coppice/bench_cook.h"

#include <algorithm>
#include <string>
#include <vector>
#include "plugins/vegetation/cook/clean_mesh.h"
#include "plugins/vegetation/cook/cook_file.h"
#include "plugins/vegetation/cook/space_curve.h"
#include "runtime/core/jobs.h"
#include "runtime/plugin/registry.h"
#include "tools/coppice/figure.h"
#include "tools/coppice/machine.h"
#include "tools/coppice/statistics.h"
#include "tools/coppice/stopwatch.h"

namespace coppice {
namespace {

constexpr int k_sampling_rounds = 7, k_cook_rounds = 3;

// Back to what it was, whatever happens.
class ThreadLimit {
  public:
    explicit ThreadLimit(unsigned threads) : before_(thread_limit()) { set_thread_limit(threads); }
    ~ThreadLimit() { set_thread_limit(before_); }
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;

  private:
    unsigned before_;
};

std::vector<vec3> triangle_centers(const PartDescription& part) {
    std::vector<vec3> centers(part.indices.size() / 3);
    for (size_t t = 0; t < centers.size(); ++t) {
        vec3 sum(0.0f);
        for (size_t k = 0; k < 3; ++k) sum += part.vertices[part.indices[3 * t + k]].position_plant;
        centers[t] = sum * (1.0f / 3.0f);
    }
    return centers;
}

// As the cook does it for one part: along the curve, in progressive order, two points a triangle.
double time_sampling_ms(const PartDescription& part, const std::vector<vec3>& centers) {
    Stopwatch clock;
    const std::vector<uint32_t> curve = order_along_curve(centers);
    std::vector<uint32_t> order = make_prefix_order(uint32_t(curve.size()), PrefixOrder::progressive, 1);
    for (uint32_t& place : order) place = curve[place];
    const SampledPoints sampled = sample_points(part, curve, order, {});
    return sampled.points.empty() ? 0.0 : clock.ms();
}

Status add_sampling(const PlantDescription& plant, std::vector<Figure>& figures) {
    auto largest = std::max_element(plant.parts.begin(), plant.parts.end(),
                                    [](auto& a, auto& b) { return a.indices.size() < b.indices.size(); });
    CleanCounts counts;
    COPPICE_TRY(const PartDescription part, clean_mesh(*largest, plant.name, largest->name, counts));
    const std::vector<vec3> centers = triangle_centers(part);
    std::vector<double> round_ms;
    for (int round = 0; round < k_sampling_rounds; ++round)
        round_ms.push_back(time_sampling_ms(part, centers));
    const double triangles = double(centers.size());
    figures.push_back({"sampling: " + plant.name + ", " + part.name, triangles, "triangles", {}});
    figures.push_back({"sampling", triangles * 1e-3 / median(round_ms), "M tri/s", 1.0});
    return {};
}

Status add_cook(const PlantDescription& plant, const std::string& name, std::vector<Figure>& figures) {
    std::vector<double> round_s;
    for (int round = 0; round < k_cook_rounds; ++round) {
        Stopwatch clock;
        COPPICE_CHECK(cook_plant(plant, {}));
        round_s.push_back(clock.ms() * 1e-3);
    }
    std::vector<std::byte> bytes[2];
    for (unsigned threads : {1u, 2u}) {
        ThreadLimit limit(threads);
        COPPICE_TRY(bytes[threads - 1], cook_plant(plant, {}));
    }
    double triangles = 0.0;
    for (const PartDescription& part : plant.parts) triangles += double(part.indices.size() / 3);
    figures.push_back({name + ": triangles", triangles, "", {}});
    figures.push_back({name + ": cook", median(round_s), "s", {}});
    figures.push_back({name + ": same on 1 and 2 threads", bytes[0] == bytes[1] ? 1.0 : 0.0, "", 1.0});
    return {};
}

}  // namespace

Result<nlohmann::json> bench_cook(const BenchSettings& settings) {
    Registry registry;
    COPPICE_CHECK(registry.load("modeller"));
    const auto* modeller = registry.find<ModellerInterface>(k_modeller_interface, k_modeller_version);
    std::vector<Figure> figures;
    for (const std::string name : {"oak", "pine"}) {
        COPPICE_TRY(const PlantDescription plant,
                    read_plant(settings.content + "/species/" + name + ".json", 0, modeller, nullptr));
        if (figures.empty()) COPPICE_CHECK(add_sampling(plant, figures));
        COPPICE_CHECK(add_cook(plant, name, figures));
    }
    nlohmann::json list = nlohmann::json::array();
    for (const Figure& figure : figures) list.push_back(to_json(figure));
    const Machine machine = describe_machine();
    return nlohmann::json{{"name", "cook"},
                          {"machine", machine.processor},
                          {"threads", machine.threads},
                          {"figures", std::move(list)}};
}

}  // namespace coppice
