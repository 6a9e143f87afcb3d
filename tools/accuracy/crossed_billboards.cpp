#include "tools/accuracy/crossed_billboards.h"

#include <algorithm>
#include <array>
#include <utility>
#include "plugins/vegetation/cook/progressive_order.h"
#include "plugins/vegetation/cook/space_curve.h"
#include "runtime/core/hash.h"
#include "tools/accuracy/plant_picture.h"

namespace coppice {
namespace {

constexpr uint32_t k_samples_a_texel = 4;  // along a side of the finest texture's
// Side of a drawn texel over d'. Texels are 0.917 to 1 of that; larger squares fill gaps inside a crown and swell what
// stands alone: at this size the two cancel for a tree's crown.
constexpr float k_splat_share = 0.98f;

struct Texel {
    vec3 position_plant;
    Surface surface;
};

// Which texel of a row or column each sample falls into, and how many samples a texel would hold were the picture
// larger.
struct TexelAxis {
    TexelAxis(uint32_t sample_count, double samples_a_texel) {
        for (uint32_t i = 0; i < sample_count; ++i)
            texel_of.push_back(uint32_t((double(i) + 0.5) / samples_a_texel));
        count = texel_of.back() + 1;
        auto first = [&](uint32_t texel) {
            return int64_t(std::ceil(double(texel) * samples_a_texel - 0.5));
        };
        for (uint32_t t = 0; t < count; ++t) held.push_back(uint32_t(first(t + 1) - first(t)));
    }
    uint32_t count;
    std::vector<uint32_t> texel_of, held;
};

// Appends the opaque texels of the picture's plane.
void add_texels(const PlantPicture& picture, const Box& bounds, float texel_m, std::vector<Texel>& texels) {
    struct Sum {
        uint32_t covered = 0, leaves = 0;
        vec3 normal{0.0f}, color{0.0f};
        float openness = 0.0f;
    };
    const double samples_a_texel = double(texel_m) / double(picture.sample_m);
    const TexelAxis columns(picture.columns, samples_a_texel), rows(picture.rows, samples_a_texel);
    std::vector<Sum> sums(size_t(columns.count) * rows.count);
    for (uint32_t row = 0; row < picture.rows; ++row)
        for (uint32_t column = 0; column < picture.columns; ++column) {
            const size_t sample = size_t(row) * picture.columns + column;
            if (!picture.covered[sample]) continue;
            const Surface& surface = picture.surfaces[sample];
            Sum& sum = sums[size_t(rows.texel_of[row]) * columns.count + columns.texel_of[column]];
            ++sum.covered;
            sum.leaves += surface.leaf;
            sum.normal += surface.normal;
            sum.color += surface.color_linear;
            sum.openness += surface.openness;
        }

    std::vector<vec3> places;
    std::vector<size_t> sum_of;
    const int across = (picture.axis + 1) % 3, up = (picture.axis + 2) % 3;
    for (size_t i = 0; i < sums.size(); ++i) {
        if (sums[i].covered == 0) continue;
        vec3 place = bounds.center();
        place[across] = bounds.min[across] + (float(i % columns.count) + 0.5f) * texel_m;
        place[up] = bounds.min[up] + (float(i / columns.count) + 0.5f) * texel_m;
        places.push_back(place);
        sum_of.push_back(i);
    }
    // What a texel covers too little or too much is handed on along a curve that stays near, so that the covered area
    // is right in every neighbourhood, to half a texel.
    float carried = 0.0f;
    for (uint32_t i : order_along_curve(places)) {
        const Sum& sum = sums[sum_of[i]];
        const size_t column = sum_of[i] % columns.count, row = sum_of[i] / columns.count;
        carried += float(sum.covered) / float(columns.held[column] * rows.held[row]);
        if (carried < 0.5f) continue;
        carried -= 1.0f;
        vec3 facing(0.0f);
        facing[picture.axis] = 1.0f;
        const float share = 1.0f / float(sum.covered);
        texels.push_back({places[i],
                          {normalize_or(sum.normal, facing), sum.color * share, sum.openness * share,
                           2 * sum.leaves >= sum.covered}});
    }
}

// The level of detail would thin out texels smaller than d' and draw the others larger, which leaves holes in what was
// closed. A gain of 1 / fill, fill = (texel / d')^2 from 2^-1/4 to 1, makes up for it. Gains are straight lines between
// fills of 1/2 and 1 (gain_at): this one touches 1 / fill in the middle from below, so that 99 % of the points are drawn
// and none gives way to the triangle.
void draw_all_points(PackedPart& part) {
    part.importance = 1.0f / (k_splat_share * k_splat_share);
    const float middle = portable_exp2(-0.125f);
    auto gain = [&](float fill) { return 0.9999f * (2.0f - fill / middle) / (middle * part.importance); };
    part.coverage_gain.fill(gain(0.5f));
    part.coverage_gain[k_gain_levels - 1] = gain(1.0f);
}

PackedPart billboard_part(std::span<const Texel> texels, float texel_m) {
    PackedPart part{};
    copy_name("billboards", part.name, sizeof part.name);
    part.kind = PackedPartKind::points;
    part.importance = 1.0f;
    // The points' own, which the level of detail guards by a triangle: one of no area.
    part.triangle_count = 1;
    part.point_count = uint32_t(texels.size());
    // All its points face the viewer: as much of them is seen from anywhere.
    const float seen_m2 = float(texels.size()) * texel_m * texel_m;
    part.area_m2 = 2.0f * seen_m2;
    part.projected_area_m2.m = {seen_m2 * seen_m2, seen_m2 * seen_m2, seen_m2 * seen_m2, 0.0f, 0.0f, 0.0f};
    part.point_radius_m = texel_m / std::sqrt(k_pi);
    part.coverage_gain.fill(1.0f);
    Box bounds;
    dvec3 color(0.0);
    for (const Texel& texel : texels) {
        bounds.include(texel.position_plant);
        color += dvec3(texel.surface.color_linear);
    }
    for (int axis = 0; axis < 3; ++axis) {
        part.bounds_min[axis] = bounds.min[axis];
        part.bounds_max[axis] = bounds.max[axis];
        part.mean_color_linear[axis] = float(color[axis] / double(texels.size()));
    }
    return part;
}

Result<Plant> pack_billboards(const Plant& plant, std::span<const Texel> texels, float texel_m,
                              bool coarsest) {
    PlantBlocks blocks = empty_blocks_like(plant);
    blocks.parts.push_back(billboard_part(texels, texel_m));
    if (!coarsest) draw_all_points(blocks.parts.back());
    const vec3 middle = plant.bounds_plant.center();
    blocks.triangle_vertices.assign(3, {middle.x, middle.y, middle.z, 0});
    blocks.point_owners.assign(texels.size(), 0);
    std::vector<vec3> places;
    for (const Texel& texel : texels) places.push_back(texel.position_plant);
    const std::vector<uint32_t> curve = order_along_curve(places);
    for (uint32_t place : make_prefix_order(uint32_t(curve.size()), PrefixOrder::progressive, 1)) {
        const Texel& texel = texels[curve[place]];
        const vec3 p = texel.position_plant;
        const uint32_t dither = mix_bits(uint32_t(blocks.points.size()));
        blocks.points.push_back({p.x, p.y, p.z, encode_surface(texel.surface, dither)});
    }
    return pack_substitute(blocks);
}

}  // namespace

Result<SubstituteLadder> make_crossed_billboards_ladder(const Plant& plant) {
    SubstituteLadder ladder;
    COPPICE_TRY(Plant full, triangles_only(plant));
    ladder.push_back({std::move(full), 0.0f});
    const vec3 extent = plant.bounds_plant.size();
    const float finest_m = std::max({extent.x, extent.y, extent.z}) / float(k_billboard_texels);
    if (!(finest_m > 0.0f)) return ladder;
    std::array<PlantPicture, 3> pictures;
    for (int axis = 0; axis < 3; ++axis)
        pictures[size_t(axis)] = picture_plant(plant, axis, finest_m / float(k_samples_a_texel));
    constexpr uint32_t k_last_step = k_billboard_octaves * k_billboard_steps;
    for (uint32_t step = 0; step <= k_last_step; ++step) {
        const float texel_m = finest_m * portable_exp2(float(step) / float(k_billboard_steps));
        std::vector<Texel> texels;
        for (const PlantPicture& picture : pictures) add_texels(picture, plant.bounds_plant, texel_m, texels);
        if (texels.empty()) break;
        COPPICE_TRY(Plant billboards, pack_billboards(plant, texels, texel_m, step == k_last_step));
        ladder.push_back({std::move(billboards), texel_m});
    }
    return ladder;
}

}  // namespace coppice
