#include "tools/accuracy/vertex_merging.h"

#include <algorithm>
#include <array>
#include <utility>
#include "runtime/core/hash.h"

namespace coppice {
namespace {

constexpr float k_least_cell_share =
    0x1p-20f;  // of the plant's extent: a cell's number fits into 21 bits an axis

float largest_extent_m(const Plant& plant) {
    const vec3 size = plant.bounds_plant.size();
    return std::max({size.x, size.y, size.z});
}

dvec3 position_of(const PackedVertex& v) { return {v.x_plant, v.y_plant, v.z_plant}; }

class CellMerger {
  public:
    CellMerger(dvec3 origin, double cell_m, std::span<const PackedVertex> corners, bool leaf)
        : corners_(corners), cell_of_(corners.size()) {
        find_cells(origin, cell_m);
        average(leaf);
    }

    // Three corners a triangle.
    std::vector<PackedVertex> merged_corners() const {
        struct Merged {
            std::array<uint32_t, 3> cells;  // sorted
            uint32_t triangle;
        };
        std::vector<Merged> triangles;
        for (uint32_t t = 0; t < corners_.size() / 3; ++t) {
            Merged merged{{cell_of_[3 * t], cell_of_[3 * t + 1], cell_of_[3 * t + 2]}, t};
            std::sort(merged.cells.begin(), merged.cells.end());
            const bool collapsed = merged.cells[0] == merged.cells[1] || merged.cells[1] == merged.cells[2];
            if (!collapsed) triangles.push_back(merged);
        }
        std::sort(triangles.begin(), triangles.end(), [](const Merged& a, const Merged& b) {
            return a.cells != b.cells ? a.cells < b.cells : a.triangle < b.triangle;
        });
        auto same = [](const Merged& a, const Merged& b) { return a.cells == b.cells; };
        triangles.erase(std::unique(triangles.begin(), triangles.end(), same), triangles.end());
        std::sort(triangles.begin(), triangles.end(),
                  [](const Merged& a, const Merged& b) { return a.triangle < b.triangle; });
        std::vector<PackedVertex> corners;
        for (const Merged& merged : triangles)
            for (uint32_t k = 0; k < 3; ++k) corners.push_back(vertices_[cell_of_[3 * merged.triangle + k]]);
        return corners;
    }

  private:
    void find_cells(dvec3 origin, double cell_m) {
        std::vector<std::pair<uint64_t, uint32_t>> keys(corners_.size());
        for (uint32_t i = 0; i < corners_.size(); ++i) {
            const dvec3 at = (position_of(corners_[i]) - origin) * (1.0 / cell_m);
            uint64_t key = 0;
            for (int axis = 0; axis < 3; ++axis)
                key = key << 21 | uint64_t(std::clamp(at[axis], 0.0, double((1u << 21) - 1)));
            keys[i] = {key, i};
        }
        std::sort(keys.begin(), keys.end());
        for (size_t i = 0; i < keys.size(); ++i) {
            if (i == 0 || keys[i].first != keys[i - 1].first) first_corner_.push_back(keys[i].second);
            cell_of_[keys[i].second] = uint32_t(first_corner_.size() - 1);
        }
    }

    void average(bool leaf) {
        struct Sum {
            double weight = 0.0, openness = 0.0;
            dvec3 position{0.0}, normal{0.0}, color{0.0};
        };
        std::vector<Sum> sums(first_corner_.size());
        for (size_t i = 0; i < corners_.size(); ++i) {
            const size_t t = i / 3 * 3;
            const dvec3 a = position_of(corners_[t]);
            // More than nothing, so that a cell of triangles without area still has a mean.
            const double weight = 1e-30 + 0.5 * glm::length(glm::cross(position_of(corners_[t + 1]) - a,
                                                                       position_of(corners_[t + 2]) - a));
            const Surface surface = decode_surface(corners_[i].surface);
            Sum& sum = sums[cell_of_[i]];
            sum.weight += weight;
            sum.position += position_of(corners_[i]) * weight;
            sum.normal += dvec3(surface.normal) * weight;
            sum.color += dvec3(surface.color_linear) * weight;
            sum.openness += double(surface.openness) * weight;
        }
        for (size_t i = 0; i < sums.size(); ++i) {
            const double share = 1.0 / sums[i].weight;
            const vec3 position(sums[i].position * share);
            const vec3 normal = normalize_or(vec3(sums[i].normal * share),
                                             decode_surface(corners_[first_corner_[i]].surface).normal);
            const Surface surface{normal, vec3(sums[i].color * share), float(sums[i].openness * share), leaf};
            vertices_.push_back(
                {position.x, position.y, position.z, encode_surface(surface, mix_bits(uint32_t(i)))});
        }
    }

    std::span<const PackedVertex> corners_;
    std::vector<uint32_t> cell_of_;       // of every corner
    std::vector<uint32_t> first_corner_;  // of every cell
    std::vector<PackedVertex> vertices_;  // of every cell
};

float median_edge_m(const Plant& plant) {
    std::vector<float> lengths;
    const auto& v = plant.triangle_vertices;
    for (size_t i = 0; i < v.size(); ++i)
        lengths.push_back(float(glm::length(position_of(v[i % 3 == 2 ? i - 2 : i + 1]) - position_of(v[i]))));
    if (lengths.empty()) return 0.0f;
    auto middle = lengths.begin() + ptrdiff_t(lengths.size() / 2);
    std::nth_element(lengths.begin(), middle, lengths.end());
    return *middle;
}

}  // namespace

Result<Plant> merge_vertices(const Plant& plant, float cell_m) {
    // A plant of a single point has one cell, of any size.
    const float extent_m = largest_extent_m(plant);
    const double cell = extent_m > 0.0f ? double(std::max(cell_m, extent_m * k_least_cell_share)) : 1.0;
    PlantBlocks blocks = empty_blocks_like(plant);
    for (const PackedPart& part : plant.parts) {
        const auto corners =
            plant.triangle_vertices.subspan(3 * size_t(part.first_triangle), 3 * size_t(part.triangle_count));
        const CellMerger merger(dvec3(plant.bounds_plant.min), cell, corners,
                                (part.flags & k_part_leaf) != 0);
        const std::vector<PackedVertex> merged = merger.merged_corners();
        if (merged.empty()) continue;
        PackedPart like = part;
        like.flags &= ~k_part_faces_outwards;  // a triangle may have turned over
        add_triangle_part(like, merged, blocks);
    }
    return pack_substitute(blocks);
}

Result<SubstituteLadder> make_vertex_merging_ladder(const Plant& plant) {
    SubstituteLadder ladder;
    COPPICE_TRY(Plant full, triangles_only(plant));
    ladder.push_back({std::move(full), 0.0f});
    const float extent_m = largest_extent_m(plant);
    float cell_m = std::max(median_edge_m(plant), extent_m * k_least_cell_share);
    for (; cell_m > 0.0f && cell_m <= 0.5f * extent_m; cell_m *= 2.0f) {
        COPPICE_TRY(Plant merged, merge_vertices(plant, cell_m));
        if (merged.parts.empty()) break;
        ladder.push_back({std::move(merged), cell_m});
    }
    return ladder;
}

}  // namespace coppice
