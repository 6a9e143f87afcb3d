#include "plugins/vegetation/cook/openness.h"

#include <algorithm>
#include "plugins/vegetation/cook/triangle_areas.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

constexpr int k_direction_count = 24;
constexpr float k_least = 0.15f;
constexpr float k_ground_share =
    0.2f;  // of light lost at the foot of the plant: the ground next to it is in shade
constexpr float k_extinction = 0.5f;  // projected over one-sided area for leaves of any orientation

// Over the upper hemisphere, weighted by the cosine to the zenith.
std::array<vec3, k_direction_count> sky_directions() {
    std::array<vec3, k_direction_count> directions;
    for (int i = 0; i < k_direction_count; ++i) {
        float square = (float(i) + 0.5f) / float(k_direction_count), around = float(i) * 2.39996323f;
        float r = std::sqrt(square);
        directions[size_t(i)] =
            vec3(r * portable_cos(around), std::sqrt(1.0f - square), r * portable_sin(around));
    }
    return directions;
}

}  // namespace

OpennessGrid::OpennessGrid(std::span<const PartDescription> parts, const std::vector<bool>& parts_closed) {
    Box box;
    for (const PartDescription& part : parts)
        for (const DescriptionVertex& v : part.vertices) box.include(v.position_plant);
    if (box.empty()) {
        open_.assign(1, 1.0f);
        return;
    }
    vec3 size = box.size();
    cell_m_ = std::max({size.x, size.y, size.z, 1e-6f}) / float(k_side_limit - 3);
    origin_ = box.min - vec3(0.5f * cell_m_);  // one empty cell around
    for (int axis = 0; axis < 3; ++axis)
        side_[size_t(axis)] = std::clamp(int(size[axis] / cell_m_) + 3, 1, k_side_limit);
    ground_plant_ = box.min.y;
    height_m_ = std::max(size.y, 1e-6f);

    auto cell_of = [&](vec3 p, int axis) {
        return std::clamp(int((p[axis] - origin_[axis]) / cell_m_ + 0.5f), 0, side_[size_t(axis)] - 1);
    };
    auto index_of = [&](int x, int y, int z) {
        return (size_t(z) * size_t(side_[1]) + size_t(y)) * size_t(side_[0]) + size_t(x);
    };
    std::vector<double> area(size_t(side_[0]) * size_t(side_[1]) * size_t(side_[2]), 0.0);
    for (size_t p = 0; p < parts.size(); ++p) {
        const PartDescription& part = parts[p];
        std::vector<double> areas = triangle_areas(part);
        for (size_t t = 0; t < areas.size(); ++t) {
            vec3 a = part.vertices[part.indices[3 * t]].position_plant;
            vec3 u = part.vertices[part.indices[3 * t + 1]].position_plant - a;
            vec3 v = part.vertices[part.indices[3 * t + 2]].position_plant - a;
            float longest = std::sqrt(std::max({glm::dot(u, u), glm::dot(v, v), glm::dot(v - u, v - u)}));
            // A triangle longer than a cell is laid out in n^2 equal pieces.
            int n = std::clamp(int(longest / cell_m_) + 1, 1, 2 * k_side_limit);
            double piece = areas[t] * (parts_closed[p] ? 0.5 : 1.0) / (double(n) * double(n));
            for (int i = 0; i < n; ++i) {
                for (int j = 0; j < 2 * (n - i) - 1; ++j) {
                    float along = (float(i) + (j % 2 ? 2.0f / 3 : 1.0f / 3)) / float(n);
                    float across = (float(j / 2) + (j % 2 ? 2.0f / 3 : 1.0f / 3)) / float(n);
                    vec3 at = a + u * along + v * across;
                    area[index_of(cell_of(at, 0), cell_of(at, 1), cell_of(at, 2))] += piece;
                }
            }
        }
    }
    // Optical depth of one step through a cell.
    std::vector<float> depth(area.size());
    double to_depth = double(k_extinction) / (double(cell_m_) * double(cell_m_));
    for (size_t i = 0; i < area.size(); ++i) depth[i] = float(area[i] * to_depth);

    const auto directions = sky_directions();
    open_.assign(area.size(), 1.0f);
    parallel_for(size_t(side_[2]), 1, [&](size_t first, size_t last) {
        for (int z = int(first); z < int(last); ++z) {
            for (int y = 0; y < side_[1]; ++y) {
                for (int x = 0; x < side_[0]; ++x) {
                    float seen = 0.0f;
                    for (vec3 d : directions) {
                        // A leaf is not in its own shade: of the cell itself half a step counts, at half
                        // weight.
                        float passed = 0.25f * depth[index_of(x, y, z)];
                        for (int step = 1;; ++step) {
                            int cx = int(float(x) + d.x * float(step) + 0.5f + 64.0f) - 64;
                            int cy = int(float(y) + d.y * float(step) + 0.5f + 64.0f) - 64;
                            int cz = int(float(z) + d.z * float(step) + 0.5f + 64.0f) - 64;
                            if (cx < 0 || cy < 0 || cz < 0 || cx >= side_[0] || cy >= side_[1] ||
                                cz >= side_[2])
                                break;
                            passed += depth[index_of(cx, cy, cz)];
                            if (passed > 12.0f) break;
                        }
                        seen += portable_exp(-passed);
                    }
                    open_[index_of(x, y, z)] = seen / float(k_direction_count);
                }
            }
        }
    });
}

float OpennessGrid::at(vec3 position_plant) const {
    vec3 cell = (position_plant - origin_) * (1.0f / cell_m_);
    int low[3];
    float part[3];
    for (int axis = 0; axis < 3; ++axis) {
        float c = std::clamp(cell[axis], 0.0f, float(side_[size_t(axis)] - 1));
        low[axis] = std::min(int(c), std::max(side_[size_t(axis)] - 2, 0));
        part[axis] = c - float(low[axis]);
    }
    float open = 0.0f;
    for (int corner = 0; corner < 8; ++corner) {
        float weight = 1.0f;
        size_t at[3];
        for (int axis = 0; axis < 3; ++axis) {
            int up = corner >> axis & 1;
            weight *= up ? part[axis] : 1.0f - part[axis];
            at[axis] = size_t(std::min(low[axis] + up, side_[size_t(axis)] - 1));
        }
        open += weight * open_[(at[2] * size_t(side_[1]) + at[1]) * size_t(side_[0]) + at[0]];
    }
    float height = std::clamp((position_plant.y - ground_plant_) / (0.3f * height_m_), 0.0f, 1.0f);
    open *= 1.0f - k_ground_share * (1.0f - height);
    return std::clamp(open, k_least, 1.0f);
}

}  // namespace coppice
