// How many points a part of a plant asks for at a density, and at which density it asks for how many: c = T A gain
// importance, with T = (pixels a metre / d')^2 at scale 1, A the projected area in the mean over directions, and the gain
// at the fill the part has there. It is what lod/choose_part.h asks for, of lines where it draws points in their place.
#pragma once
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

// Beyond these a cloud's points could not say how large they are (make_cloud.h); a plant's own still can.
inline constexpr double k_least_importance = 1.0 / 128.0, k_most_importance = 128.0;

class PointDemand {
  public:
    // Keeps a pointer to the part. model_importance: multiplies the part's.
    explicit PointDemand(const PackedPart& part, float model_importance = 1.0f);

    const PackedPart& part() const { return *part_; }
    double area_m2() const { return area_m2_; }              // A; 0: nothing is ever drawn
    uint32_t stored_count() const { return stored_count_; }  // points; 0: triangles only
    double importance() const { return importance_; }
    double gain(double density) const;
    HeightGain height_gain(double density) const;
    double count(double density) const { return density * area_m2_ * gain(density) * importance_; }
    // The least density that asks for `count` points; never falls while count grows. Requires points or lines.
    double density(double count) const;

  private:
    float fill(double density) const;
    double fill_power(double fill) const { return lines_ ? fill * fill : fill; }

    const PackedPart* part_;
    double area_m2_ = 0.0, importance_ = 1.0;
    uint32_t stored_count_ = 0;
    bool lines_;
    // Points: fill = T / unit. Lines, a length against the root of an area: fill^2 = T / unit.
    double unit_ = 1.0;
    // Most that is asked for up to each level of gain, over unit * A.
    std::array<double, k_gain_levels> reach_{};
};

}  // namespace coppice
