#include "plugins/vegetation/eco/quantise.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include "runtime/core/jobs.h"
#include "runtime/core/random.h"

namespace coppice {
namespace {

// A plant of one form, made taller: lengths grow with its height, areas with the square.
PlantFeatures grown_to(PlantFeatures form, float height_m) {
    const float s = height_m / form.height_m;
    for (float* length_m : {&form.crown_base_m, &form.crown_width_x_m, &form.crown_width_z_m}) *length_m *= s;
    for (float* area_m2 :
         {&form.area_along_x_m2, &form.area_along_y_m2, &form.area_along_z_m2, &form.leaf_area_m2})
        *area_m2 *= s * s;
    form.height_m = height_m;
    return form;
}

constexpr PlantFeatures k_slender{10, 2, 2, 2, 15, 4, 15, 30, 0.1f, 0.2f, 0.05f};
constexpr PlantFeatures k_broad{10, 3, 9, 9, 50, 60, 50, 150, 0.1f, 0.2f, 0.05f};
constexpr PlantFeatures k_red{10, 2, 4, 4, 25, 15, 25, 60, 0.4f, 0.1f, 0.05f};

std::vector<PlantFeatures> random_population(size_t count, uint64_t seed) {
    Random random(seed);
    std::vector<PlantFeatures> plants;
    for (size_t i = 0; i < count; ++i) {
        auto about = [&random](float mean) { return random.next_around(mean, 0.3f * mean); };
        plants.push_back({about(10), about(3), about(5), about(5), about(40), about(30), about(40), about(90),
                          about(0.1f), about(0.2f), about(0.05f)});
    }
    return plants;
}

// As the header tells it, without what makes quantise() quick.
class Oracle {
  public:
    explicit Oracle(const std::vector<PlantFeatures>& plants) : plants_(plants) {
        for (size_t f = 0; f < 10; ++f) {
            double mean = 0.0, variance = 0.0;
            for (const PlantFeatures& p : plants) mean += value(p, f) / double(plants.size());
            for (const PlantFeatures& p : plants)
                variance += std::pow(value(p, f) - mean, 2.0) / double(plants.size());
            const double least = f < 3 ? 0.05 * mean : f < 7 ? 0.1 * mean : 0.02;
            spread_[f] = std::max(std::sqrt(variance), least);
        }
    }
    double squared_distance(size_t drawn, size_t model) const {
        const double s = double(plants_[drawn].height_m) / double(plants_[model].height_m);
        double sum = 0.0;
        for (size_t f = 0; f < 10; ++f) {
            const double power = f < 3 ? 1.0 : f < 7 ? 2.0 : 0.0;
            const double off = value(plants_[drawn], f) - value(plants_[model], f) * std::pow(s, power);
            sum += (f < 7 ? 1.0 : 1.0 / 3.0) / 8.0 * std::pow(off / spread_[f], 2.0);
        }
        return sum;
    }
    double error(const std::vector<uint32_t>& medoids) const {
        double sum = 0.0;
        for (size_t i = 0; i < plants_.size(); ++i) {
            double nearest = INFINITY;
            for (uint32_t medoid : medoids) nearest = std::min(nearest, squared_distance(i, medoid));
            sum += nearest;
        }
        return std::sqrt(sum / double(plants_.size()));
    }

  private:
    static double value(const PlantFeatures& p, size_t feature) {
        const float values[] = {p.crown_base_m,    p.crown_width_x_m, p.crown_width_z_m, p.area_along_x_m2,
                                p.area_along_y_m2, p.area_along_z_m2, p.leaf_area_m2,    p.leaf_red,
                                p.leaf_green,      p.leaf_blue};
        return double(values[feature]);
    }
    const std::vector<PlantFeatures>& plants_;
    double spread_[10];
};

TEST(Quantise, FindsFormsThatAreWellApart) {
    const PlantFeatures forms[] = {k_slender, k_broad, k_red};
    Random random(1);
    std::vector<PlantFeatures> plants;
    for (size_t i = 0; i < 60; ++i) {
        plants.push_back(grown_to(forms[i * 7 % 3], random.next_in(8, 12)));
        plants.back().leaf_area_m2 *= random.next_in(0.99f, 1.01f);
    }
    const Quantised three = quantise(plants, 3);
    ASSERT_EQ(three.medoids.size(), 3u);
    for (size_t i = 0; i < 60; ++i)
        EXPECT_EQ(three.medoids[three.medoid_of[i]] * 7 % 3, i * 7 % 3) << "individual " << i;
    EXPECT_GT(three.error_by_count[1], 0.2f);
    EXPECT_LT(three.error_by_count[2], 0.02f);
}

TEST(Quantise, OneModelScaledStandsForAllOfItsForm) {
    std::vector<PlantFeatures> plants;
    for (int i = 0; i < 11; ++i) plants.push_back(grown_to(k_slender, 8.0f + 0.5f * float(i)));
    const Quantised one = quantise(plants, 1);
    EXPECT_LT(one.error_by_count[0], 1e-5f);
    for (size_t i = 0; i < plants.size(); ++i)
        EXPECT_FLOAT_EQ(one.scale_of[i] * plants[one.medoids[0]].height_m, plants[i].height_m);
}

TEST(Quantise, IsNeverScaledOutOfBounds) {
    std::vector<PlantFeatures> plants(600, k_slender);
    plants[2] = grown_to(k_slender, 50);
    plants[3] = grown_to(k_slender, 2);
    const Quantised one = quantise(plants, 1);
    ASSERT_EQ(one.medoids[0], 0u);
    EXPECT_EQ(one.scale_of[2], k_quantise_scale_most);
    EXPECT_EQ(one.scale_of[3], k_quantise_scale_least);
}

TEST(Quantise, MedoidsAreIndividualsAndStandForThemselves) {
    const std::vector<PlantFeatures> plants = random_population(50, 2);
    for (uint32_t count : {1u, 2u, 7u, 49u, 50u}) {
        const Quantised q = quantise(plants, count);
        ASSERT_EQ(q.medoids.size(), count);
        ASSERT_EQ(q.medoid_of.size(), plants.size());
        ASSERT_EQ(q.scale_of.size(), plants.size());
        for (uint32_t m = 0; m < count; ++m) {
            ASSERT_LT(q.medoids[m], plants.size());
            EXPECT_TRUE(m == 0 || q.medoids[m - 1] < q.medoids[m]);
            EXPECT_EQ(q.medoid_of[q.medoids[m]], m);
            EXPECT_EQ(q.scale_of[q.medoids[m]], 1.0f);
        }
    }
}

TEST(Quantise, DrawsEachAsTheNearestAndSaysHowFarOffThatIs) {
    const std::vector<PlantFeatures> plants = random_population(40, 3);
    const Oracle oracle(plants);
    for (uint32_t count : {1u, 3u, 10u}) {
        const Quantised q = quantise(plants, count);
        double sum = 0.0;
        for (size_t i = 0; i < plants.size(); ++i) {
            const double drawn = oracle.squared_distance(i, q.medoids[q.medoid_of[i]]);
            for (uint32_t medoid : q.medoids) EXPECT_LE(drawn, oracle.squared_distance(i, medoid) + 1e-5);
            sum += drawn;
        }
        EXPECT_NEAR(double(q.error_by_count.back()), std::sqrt(sum / double(plants.size())), 1e-4);
    }
}

TEST(Quantise, IsAsGoodAsTryingAllOrNearly) {
    size_t best_found = 0;
    for (uint64_t seed = 0; seed < 20; ++seed) {
        const std::vector<PlantFeatures> plants = random_population(14, 100 + seed);
        const Oracle oracle(plants);
        double best = INFINITY;
        for (uint32_t a = 0; a < 14; ++a)
            for (uint32_t b = a + 1; b < 14; ++b)
                for (uint32_t c = b + 1; c < 14; ++c) best = std::min(best, oracle.error({a, b, c}));
        const double found = oracle.error(quantise(plants, 3).medoids);
        EXPECT_LE(found, 1.05 * best) << "seed " << seed;
        best_found += found < best * (1.0 + 1e-6);
    }
    EXPECT_GE(best_found, 15u);
}

TEST(Quantise, ErrorFallsWithTheNumberOfModelsToNothing) {
    for (uint64_t seed = 0; seed < 4; ++seed) {
        const std::vector<PlantFeatures> plants = random_population(70, 10 + seed);
        const std::vector<float> errors = quantise(plants, 70).error_by_count;
        ASSERT_EQ(errors.size(), 70u);
        for (size_t i = 1; i < 70; ++i) EXPECT_LT(errors[i], errors[i - 1]);
        EXPECT_EQ(errors[69], 0.0f);
        EXPECT_GT(errors[0], 2.0f * errors[31]);
        // Asked for fewer, the same are found on the way.
        EXPECT_TRUE(std::ranges::equal(quantise(plants, 9).error_by_count, std::span(errors).first(9)));
    }
}

TEST(Quantise, OneIndividualIsItself) {
    const std::vector<PlantFeatures> plants{k_broad};
    const Quantised q = quantise(plants, 1);
    EXPECT_EQ(q.medoids, std::vector<uint32_t>{0});
    EXPECT_EQ(q.medoid_of, std::vector<uint32_t>{0});
    EXPECT_EQ(q.scale_of, std::vector<float>{1.0f});
    EXPECT_EQ(q.error_by_count, std::vector<float>{0.0f});
}

TEST(Quantise, EqualIndividualsGoToTheFirst) {
    const PlantFeatures bare{1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    for (const PlantFeatures& one : {k_red, bare}) {
        const std::vector<PlantFeatures> plants(8, one);
        const Quantised q = quantise(plants, 3);
        EXPECT_EQ(q.medoids, (std::vector<uint32_t>{0, 1, 2}));
        EXPECT_EQ(q.medoid_of, (std::vector<uint32_t>{0, 1, 2, 0, 0, 0, 0, 0}));
        EXPECT_EQ(q.scale_of, std::vector<float>(8, 1.0f));
        EXPECT_EQ(q.error_by_count, std::vector<float>(3, 0.0f));
    }
}

TEST(Quantise, SameOnAnyNumberOfThreads) {
    const std::vector<PlantFeatures> plants = random_population(200, 5);
    set_thread_limit(1);
    const Quantised one = quantise(plants, 12);
    set_thread_limit(0);
    const Quantised all = quantise(plants, 12);
    EXPECT_EQ(one.medoids, all.medoids);
    EXPECT_EQ(one.medoid_of, all.medoid_of);
    EXPECT_EQ(one.scale_of, all.scale_of);
    EXPECT_EQ(one.error_by_count, all.error_by_count);
}

}  // namespace
}  // namespace coppice
