#include "plugins/vegetation/eco/make_cloud.h"

#include <bit>
#include <cassert>
#include <functional>
#include "plugins/vegetation/eco/part_chance.h"
#include "plugins/vegetation/eco/point_demand.h"
#include "plugins/vegetation/plant/direction_form.h"
#include "plugins/vegetation/plant/pack.h"

namespace coppice {
namespace {

constexpr double k_largest_area_m2 = 1e9;
constexpr float k_largest_scale = 1e5f;
constexpr double k_densest = 1e30;  // nobody comes so near; and it is a finite float

// A step's lower end is the float whose exponent and first two bits of mantissa are the step's.
constexpr uint32_t k_first_step = (127 - 32) << 2;
uint32_t density_step(double density) {
    const float clamped = float(std::clamp(density, 0x1p-32, 0x1p+31));
    return (std::bit_cast<uint32_t>(clamped) >> 21) - k_first_step;
}
float step_begin(uint32_t step) {
    return step == 0 ? 0.0f : std::bit_cast<float>((step + k_first_step) << 21);
}

// What all the plants of a cloud add up to.
struct Totals {
    DirectionValues seen_m2{};  // from projection_directions()
    double surface_m2 = 0.0;    // such that seen over surface is |n . v| in the mean
    dvec3 color{0.0};           // times projected area
    std::array<double, k_density_steps> exhausted_area_m2{};
};

// Everything but the points. gain(T): of all the plants, by area, at that density.
template <class Gain>
void finish(TileCloud& cloud, const Totals& totals, Gain&& gain) {
    PackedPart& part = cloud.part;
    copy_name("cloud", part.name, sizeof part.name);
    part.kind = PackedPartKind::points;
    part.importance = 1.0f;
    part.point_count = uint32_t(cloud.points.size());
    part.area_m2 = float(std::min(totals.surface_m2, 1e30));
    part.projected_area_m2 = fit_direction_form(totals.seen_m2);
    part.coverage_gain.fill(1.0f);

    double area_m2 = 0.0, exhausted_m2 = 0.0;
    for (double a : totals.exhausted_area_m2) area_m2 += a;
    if (!(area_m2 > 0.0)) return;
    for (size_t c = 0; c < 3; ++c)
        part.mean_color_linear[c] = float(totals.color[glm::length_t(c)] / area_m2);
    for (uint32_t step = 0; step < k_density_steps; ++step) {
        cloud.exhausted_area_m2[step] = float(totals.exhausted_area_m2[step]);
        exhausted_m2 += totals.exhausted_area_m2[step];
        if (exhausted_m2 <= k_exhausted_share * area_m2) cloud.exhausted_density = step_begin(step + 1);
    }
    if (cloud.points.empty()) return;
    part.point_radius_m = float(std::sqrt(double(part.area_m2) / (double(part.point_count) * double(k_pi))));
    Box bounds;
    for (const PackedVertex& p : cloud.points) bounds.include(vec3(p.x_plant, p.y_plant, p.z_plant));
    for (int axis = 0; axis < 3; ++axis) {
        part.bounds_min[axis] = bounds.min[axis];
        part.bounds_max[axis] = bounds.max[axis];
    }
    const double seen_m2 = mean_over_directions(part.projected_area_m2);
    if (!(seen_m2 > 0.0)) return;
    for (size_t level = 0; level < k_gain_levels; ++level) {
        const double fill = 1.0 / double(1u << (k_gain_levels - 1 - level));
        part.coverage_gain[level] = float(gain(fill * double(part.point_count) / seen_m2));
    }
}

// One part of one plant, and the next of its points.
struct Source {
    const PointDemand* demand;
    uint32_t plant, part;
    double scale_square;
    float chance;
    float density = 0.0f;       // of the next point
    uint32_t given = 0;         // points so far
    uint32_t line = 0;          // the next point's
    double width_before = 0.0;  // of all lines before that one

    double asked() const { return double(given) + 1.0 - double(chance); }
};

float line_width(const PackedPart& part, const Plant& plant, uint32_t line) {
    return std::bit_cast<float>(plant.line_vertices[2 * (size_t(part.first_line) + line) + 1].surface);
}

// Lines lie one behind the other, as broad as long: every unit of width has a point. False where there are no more.
bool find_point(Source& source, const Plant& plant) {
    const PointDemand& demand = *source.demand;
    if (demand.part().kind == PackedPartKind::lines) {
        while (source.line < demand.stored_count()) {
            const double width = double(line_width(demand.part(), plant, source.line));
            if (source.width_before + width >= source.asked()) break;
            source.width_before += width;
            ++source.line;
        }
        if (source.line >= demand.stored_count()) return false;
    } else if (source.given >= demand.stored_count()) {
        return false;
    }
    const double density = demand.density(source.asked()) / source.scale_square;
    source.density = std::max(source.density, float(std::min(density, k_densest)));
    return density < k_densest;
}

PackedVertex stored_point(const Source& source, const Plant& plant) {
    const PackedPart& part = source.demand->part();
    if (part.kind == PackedPartKind::points) return plant.points[size_t(part.first_point) + source.given];
    const PackedVertex* ends = &plant.line_vertices[2 * (size_t(part.first_line) + source.line)];
    const float along = std::clamp(
        float((source.asked() - source.width_before) / double(line_width(part, plant, source.line))), 0.0f,
        1.0f);
    const vec3 begin(ends[0].x_plant, ends[0].y_plant, ends[0].z_plant);
    const vec3 at = begin + (vec3(ends[1].x_plant, ends[1].y_plant, ends[1].z_plant) - begin) * along;
    return {at.x, at.y, at.z, ends[0].surface};
}

// Colour, openness and kind keep their bits: coding them anew would dither them once more.
uint32_t turn_surface(uint32_t surface, const mat3& rotation) {
    constexpr uint32_t k_normal_bits = 0xfffu;
    const uint32_t turned =
        encode_surface({rotation * decode_surface(surface).normal, vec3(0.0f), 0.0f, false}, 0);
    return (surface & ~k_normal_bits) | (turned & k_normal_bits);
}

// The demands of the models that are used, found by model.
class DemandsOfModels {
  public:
    explicit DemandsOfModels(std::span<const Plant> plants) : plants_(plants), of_model_(plants.size()) {}

    std::span<const PointDemand> of(uint32_t model) {
        std::vector<PointDemand>& demands = of_model_[model];
        if (demands.empty()) demands = {plants_[model].parts.begin(), plants_[model].parts.end()};
        return demands;
    }

  private:
    std::span<const Plant> plants_;
    std::vector<std::vector<PointDemand>> of_model_;  // never moved once made: sources point into them
};

bool is_usable(const PlantPosition& p) {
    return is_finite(vec3(p.x_tile, p.y_tile, p.z_tile)) && p.scale > 0.0f && p.scale <= k_largest_scale;
}

}  // namespace

TileCloud gather_cloud(std::span<const PlantPosition> positions, std::span<const PlantTurn> turns,
                       std::span<const PlantModel> models, std::span<const Plant> plants) {
    assert(positions.size() == turns.size() && positions.size() == models.size());
    DemandsOfModels demands(plants);
    Totals totals;
    std::vector<Source> sources;
    for (size_t i = 0; i < positions.size(); ++i) {
        if (!is_usable(positions[i])) continue;
        const std::span<const PointDemand> parts = demands.of(models[i].model);
        const double scale_square = double(positions[i].scale) * double(positions[i].scale);
        std::array<vec3, k_projection_direction_count> directions_plant = projection_directions();
        const mat3 rotation = rotation_matrix(turns[i]);
        for (vec3& d : directions_plant) d = d * rotation;
        for (size_t p = 0; p < parts.size(); ++p) {
            const PointDemand& demand = parts[p];
            const double area_m2 = demand.area_m2() * scale_square;
            if (!(area_m2 > 0.0 && area_m2 <= k_largest_area_m2)) continue;
            const PackedPart& part = demand.part();
            for (size_t d = 0; d < directions_plant.size(); ++d)
                totals.seen_m2[d] +=
                    scale_square * double(part.projected_area_m2.evaluate(directions_plant[d]));
            totals.surface_m2 +=
                double(part.area_m2) * scale_square * (part.flags & k_part_closed ? 0.5 : 1.0);
            for (size_t c = 0; c < 3; ++c)
                totals.color[glm::length_t(c)] += area_m2 * double(part.mean_color_linear[c]);
            const double exhausted = demand.stored_count() > 0
                                         ? demand.density(double(demand.stored_count())) / scale_square
                                         : 0.0;
            totals.exhausted_area_m2[density_step(exhausted)] += area_m2;
            sources.push_back(
                {&demand, uint32_t(i), uint32_t(p), scale_square, part_chance(models[i], uint32_t(p))});
        }
    }

    // Sources stand in order of plant and part, so their number resolves ties.
    using Next = std::pair<float, size_t>;  // density, source
    std::vector<Next> queue;
    for (size_t s = 0; s < sources.size(); ++s)
        if (find_point(sources[s], plants[models[sources[s].plant].model]))
            queue.push_back({sources[s].density, s});
    std::make_heap(queue.begin(), queue.end(), std::greater<>());
    TileCloud cloud;
    while (!queue.empty() && cloud.points.size() < k_cloud_points) {
        std::pop_heap(queue.begin(), queue.end(), std::greater<>());
        Source& source = sources[queue.back().second];
        const Plant& plant = plants[models[source.plant].model];
        const PlantPosition& place = positions[source.plant];
        const mat3 rotation = rotation_matrix(turns[source.plant]);
        const PackedVertex stored = stored_point(source, plant);
        const vec3 at = vec3(place.x_tile, place.y_tile, place.z_tile) +
                        rotation * (vec3(stored.x_plant, stored.y_plant, stored.z_plant) * place.scale);
        cloud.points.push_back({at.x, at.y, at.z, turn_surface(stored.surface, rotation)});
        cloud.densities.push_back(source.density);
        ++source.given;
        if (find_point(source, plant)) {
            queue.back().first = source.density;
            std::push_heap(queue.begin(), queue.end(), std::greater<>());
        } else {
            queue.pop_back();
        }
    }

    finish(cloud, totals, [&](double density) {
        double area_m2 = 0.0, drawn_m2 = 0.0;
        for (const Source& source : sources) {
            const double of_part = source.demand->area_m2() * source.scale_square;
            area_m2 += of_part;
            drawn_m2 += of_part * source.demand->gain(density * source.scale_square);
        }
        return drawn_m2 / area_m2;
    });
    return cloud;
}

TileCloud merge_clouds(std::span<const TileCloud* const> children, std::span<const vec3> offsets_m) {
    assert(children.size() == offsets_m.size());
    Totals totals;
    std::vector<double> areas_m2(children.size(), 0.0);
    for (size_t i = 0; i < children.size(); ++i) {
        const TileCloud& child = *children[i];
        for (size_t step = 0; step < k_density_steps; ++step) {
            areas_m2[i] += double(child.exhausted_area_m2[step]);
            totals.exhausted_area_m2[step] += double(child.exhausted_area_m2[step]);
        }
        for (size_t d = 0; d < totals.seen_m2.size(); ++d)
            totals.seen_m2[d] += double(child.part.projected_area_m2.evaluate(projection_directions()[d]));
        totals.surface_m2 += double(child.part.area_m2);
        for (size_t c = 0; c < 3; ++c)
            totals.color[glm::length_t(c)] += areas_m2[i] * double(child.part.mean_color_linear[c]);
    }

    TileCloud cloud;
    std::vector<size_t> given(children.size(), 0);
    while (cloud.points.size() < k_cloud_points) {
        size_t nearest = children.size();
        for (size_t i = 0; i < children.size(); ++i)
            if (given[i] < children[i]->points.size() &&
                (nearest == children.size() ||
                 children[i]->densities[given[i]] < children[nearest]->densities[given[nearest]]))
                nearest = i;
        if (nearest == children.size()) break;
        const size_t index = given[nearest]++;
        PackedVertex point = children[nearest]->points[index];
        point.x_plant += offsets_m[nearest].x;
        point.y_plant += offsets_m[nearest].y;
        point.z_plant += offsets_m[nearest].z;
        cloud.points.push_back(point);
        cloud.densities.push_back(children[nearest]->densities[index]);
    }

    finish(cloud, totals, [&](double density) {
        double area_m2 = 0.0, drawn_m2 = 0.0;
        for (size_t i = 0; i < children.size(); ++i) {
            const PackedPart& part = children[i]->part;
            area_m2 += areas_m2[i];
            const double fill = part.point_count > 0 ? density * areas_m2[i] / double(part.point_count) : 0.0;
            drawn_m2 += areas_m2[i] * double(gain_at(part, float(std::min(fill, k_densest))));
        }
        return drawn_m2 / area_m2;
    });
    return cloud;
}

}  // namespace coppice
