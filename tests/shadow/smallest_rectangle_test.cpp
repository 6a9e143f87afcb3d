#include "plugins/vegetation/shadow/smallest_rectangle.h"

#include <gtest/gtest.h>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>
#include "runtime/core/random.h"

namespace coppice {
namespace {

double area_of(const Rectangle& box) { return (box.high.x - box.low.x) * (box.high.y - box.low.y); }

double area_at(double angle, const std::vector<dvec2>& places) {
    dvec2 low(INFINITY), high(-INFINITY);
    for (const dvec2& p : places) {
        const dvec2 at(p.x * std::cos(angle) + p.y * std::sin(angle), p.y * std::cos(angle) - p.x * std::sin(angle));
        low = {std::min(low.x, at.x), std::min(low.y, at.y)};
        high = {std::max(high.x, at.x), std::max(high.y, at.y)};
    }
    return (high.x - low.x) * (high.y - low.y);
}

TEST(SmallestRectangle, HoldsAllPlacesAndNoOtherIsSmaller) {
    Random random(1);
    for (int i = 0; i < 500; ++i) {
        std::vector<dvec2> places(1 + random.next_below(40));
        for (dvec2& p : places) p = {double(random.next_in(-9, 9)), double(random.next_in(-2, 2))};
        const Rectangle box = smallest_rectangle(places, 1e-9);
        EXPECT_NEAR(glm::length(box.axis), 1.0, 1e-12);
        for (const dvec2& p : places) {
            const double x = glm::dot(box.axis, p), y = box.axis.x * p.y - box.axis.y * p.x;
            EXPECT_TRUE(x >= box.low.x - 1e-9 && x <= box.high.x + 1e-9 && y >= box.low.y - 1e-9 &&
                        y <= box.high.y + 1e-9);
        }
        for (int k = 0; k < 90; ++k) EXPECT_LE(area_of(box), area_at(k * 3.14159265 / 180.0, places) + 1e-6);
    }
}

TEST(SmallestRectangle, HasItsLeastWidthAroundOnePlaceOrALine) {
    const std::vector<dvec2> one{{3.0, 4.0}}, line{{0.0, 0.0}, {3.0, 4.0}, {1.5, 2.0}}, none{{NAN, 0.0}};
    EXPECT_NEAR(area_of(smallest_rectangle(one, 0.5)), 0.25, 1e-12);
    EXPECT_NEAR(area_of(smallest_rectangle(line, 0.5)), 2.5, 1e-12);
    EXPECT_NEAR(area_of(smallest_rectangle(none, 0.5)), 0.25, 1e-12);
}

}  // namespace
}  // namespace coppice
