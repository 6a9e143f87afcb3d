#include "plugins/vegetation/eco/measure_population.h"

#include <atomic>
#include <cstring>
#include <filesystem>
#include <unistd.h>
#include <gtest/gtest.h>
#include "runtime/core/file.h"
#include "runtime/core/jobs.h"
#include "runtime/core/log.h"

namespace coppice {
namespace {

std::atomic<int> g_grown = 0;

// A leaf as many metres high as the species' text has characters, and one more an individual.
Result<PlantDescription> grow_leaf(std::string_view json, const std::string& file, uint64_t variation) {
    ++g_grown;
    if (json == "poor" && variation >= 3)
        return fail(ErrorId::value_out_of_range, file, "", "individual " + std::to_string(variation), "");
    PlantDescription plant;
    PartDescription& leaf = plant.parts.emplace_back();
    leaf.leaf = true;
    const float height_m = float(json.size() + variation);
    for (vec3 at : {vec3(0), vec3(1, 0, 0), vec3(0, height_m, 0)})
        leaf.vertices.push_back({at, vec3(0, 0, 1), vec3(0.5f)});
    leaf.indices = {0, 1, 2};
    return plant;
}
constexpr ModellerInterface k_modeller{sizeof(ModellerInterface), &grow_leaf};

// The lines logged while it lives.
class Log {
  public:
    Log() {
        set_log_sink([](void* log, LogLevel level,
                        std::string_view line) { static_cast<Log*>(log)->lines.emplace_back(level, line); },
                     this);
    }
    ~Log() { set_log_sink(nullptr, nullptr); }
    std::vector<std::pair<LogLevel, std::string>> lines;
};

class MeasurePopulation : public testing::Test {
  protected:
    MeasurePopulation()
        : dir_(std::filesystem::temp_directory_path() /
               ("coppice_population_" + std::to_string(::getpid()))) {
        std::filesystem::remove_all(dir_);
        std::filesystem::create_directories(dir_);
    }
    ~MeasurePopulation() override { std::filesystem::remove_all(dir_); }

    std::string write(const std::string& name, std::string_view text) {
        std::string path = (dir_ / name).string();
        EXPECT_TRUE(write_text_file(path, text));
        return path;
    }
    std::string cache_dir() const { return (dir_ / "cache").string(); }
    std::string only_cached_file() const {
        std::vector<std::string> found;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(cache_dir()))
            if (entry.is_regular_file()) found.push_back(entry.path().string());
        EXPECT_EQ(found.size(), 1u);
        return found.empty() ? "" : found.front();
    }
    // Heights in metres; empty after an error.
    std::vector<float> heights(const PopulationSource& source, const std::string& cache) {
        auto features = measure_population(source, &k_modeller, cache);
        EXPECT_TRUE(features) << (features ? "" : to_string(features.error()));
        std::vector<float> heights;
        if (features)
            for (const PlantFeatures& one : *features) heights.push_back(one.height_m);
        return heights;
    }
    std::filesystem::path dir_;
};

TEST_F(MeasurePopulation, GrowsEachIndividualInOrder) {
    const PopulationSource five{write("a.json", "1234567"), 5};
    for (unsigned threads : {1u, 0u}) {
        set_thread_limit(threads);
        EXPECT_EQ(heights(five, ""), (std::vector<float>{7, 8, 9, 10, 11}));
    }
    EXPECT_FALSE(std::filesystem::exists(cache_dir()));
}

TEST_F(MeasurePopulation, TheCacheGrowsOnceAndFollowsWhatItIsMadeOf) {
    PopulationSource source{write("a.json", "123"), 4};
    const std::vector<float> first = heights(source, cache_dir());
    g_grown = 0;
    EXPECT_EQ(heights(source, cache_dir()), first);
    EXPECT_EQ(g_grown, 0);
    write("a.json", "12345");
    EXPECT_EQ(heights(source, cache_dir()).front(), 5.0f);
    source.individual_count = 2;
    EXPECT_EQ(heights(source, cache_dir()).size(), 2u);
    EXPECT_EQ(g_grown, 6);
}

TEST_F(MeasurePopulation, ABrokenFileCountsAsNoneAndIsReplaced) {
    const PopulationSource source{write("a.json", "123"), 3};
    const std::vector<float> right = heights(source, cache_dir());
    const std::string cached = only_cached_file(), whole = *read_text_file(cached);
    auto expect_grown_again = [&](const std::string& broken, const std::string& how) {
        ASSERT_TRUE(write_text_file(cached, broken));
        Log log;
        EXPECT_EQ(heights(source, cache_dir()), right) << how;
        ASSERT_EQ(log.lines.size(), 1u) << how;
        EXPECT_EQ(log.lines[0].first, LogLevel::note);
        EXPECT_NE(log.lines[0].second.find(cached), std::string::npos) << log.lines[0].second;
        EXPECT_EQ(*read_text_file(cached), whole) << how;
    };
    for (size_t cut = 0; cut < whole.size(); cut += 5)
        expect_grown_again(whole.substr(0, cut), "cut at " + std::to_string(cut));
    for (size_t bit = 0; bit < 8 * whole.size(); bit += 29) {
        std::string flipped = whole;
        flipped[bit / 8] = char(flipped[bit / 8] ^ (1 << bit % 8));
        expect_grown_again(flipped, "bit " + std::to_string(bit));
    }
    expect_grown_again(whole + "x", "one more byte");
}

TEST_F(MeasurePopulation, WarnsWhereTheCacheCannotBeWritten) {
    const PopulationSource source{write("a.json", "123"), 3};
    write("file", "in the way");
    Log log;
    EXPECT_EQ(heights(source, (dir_ / "file").string()).size(), 3u);
    ASSERT_FALSE(log.lines.empty());
    EXPECT_EQ(log.lines.back().first, LogLevel::warning);
}

TEST_F(MeasurePopulation, SaysWhatIsWrong) {
    const PopulationSource source{write("a.json", "123"), 3};
    auto without_plugin = measure_population(source, nullptr, "");
    ASSERT_FALSE(without_plugin);
    EXPECT_EQ(without_plugin.error().id, ErrorId::name_unknown);
    EXPECT_NE(without_plugin.error().fault.find("modeller"), std::string::npos);

    auto missing = measure_population({(dir_ / "none.json").string(), 3}, &k_modeller, "");
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().id, ErrorId::file_missing);

    const PopulationSource poor{write("poor.json", "poor"), 8};
    auto refused = measure_population(poor, &k_modeller, cache_dir());
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().file, poor.path);
    EXPECT_EQ(refused.error().fault, "individual 3");  // the first of them, on any number of threads
    EXPECT_FALSE(std::filesystem::exists(cache_dir()));
}

}  // namespace
}  // namespace coppice
