#include "plugins/vegetation/eco/make_cloud.h"

#include <bit>
#include <cassert>
#include <functional>
#include "plugins/vegetation/eco/part_chance.h"
#include "plugins/vegetation/eco/point_demand.h"
#include "plugins/vegetation/plant/direction_form.h"
#include "plugins/vegetation/plant/pack.h"
#include "plugins/vegetation/plant/point_run.h"
#include "runtime/core/hash.h"

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

// Everything but the points.
void finish(TileCloud& cloud, const Totals& totals) {
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
}

// What is drawn at a density, and that times its height gains.
struct DrawnGain {
    double drawn = 0.0, second = 0.0, fourth = 0.0;

    void add(double more, HeightGain gain, HeightGain upright) {
        drawn += more;
        second += more * double(gain.second * upright.second);
        fourth += more * double(gain.fourth * upright.fourth);
    }
};

// sum(density) -> DrawnGain of all that is in the cloud.
template <class Sum>
void set_height_gain(TileCloud& cloud, Sum&& sum) {
    PackedPart& part = cloud.part;
    const double area_m2 = double(mean_projected_area_m2(part));
    if (!(area_m2 > 0.0)) return;
    for (uint32_t level = 0; level < part.height_gain.size(); ++level) {
        const double fill = double(fill_at_level(2 * level + 1));
        const DrawnGain at = sum(fill * double(part.point_count) / area_m2);
        if (at.drawn > 0.0)
            part.height_gain[level] =
                round_height_gain({float(at.second / at.drawn), float(at.fourth / at.drawn)});
    }
}

// One part of one plant, and the next of its points.
struct Source {
    const PointDemand* demand;
    uint32_t plant, part;
    double scale_square;
    HeightGain upright;  // share that is left of the part's by how the plant leans
    float chance;
    uint32_t first_point;
    uint32_t given = 0;  // points so far
    LinePoint point{};   // the next
    float density = 0.0f;
};

// False where there are no more.
bool find_point(Source& source, const Plant& plant) {
    const PointDemand& demand = *source.demand;
    const PackedPart& part = demand.part();
    if (source.given >= demand.stored_count()) return false;
    const double asked = double(source.given) + 1.0 - double(source.chance);
    const double density = demand.density(asked) / source.scale_square;
    const uint32_t next = point_of_run(source.first_point, source.given);
    source.point = part.kind == PackedPartKind::lines
                       ? line_point(part, plant.line_vertices, next)
                       : LinePoint{plant.points[size_t(part.first_point) + next], 1.0f};
    source.density = std::max(
        source.density,
        pack_density(std::min(density, k_densest), source.point.width_share / float(demand.importance())));
    return density < k_densest;
}

// The demands of the models that are used, found by model.
class DemandsOfModels {
  public:
    DemandsOfModels(std::span<const Plant> plants, std::span<const SceneModel> scene_models)
        : plants_(plants), scene_models_(scene_models), of_model_(plants.size()) {}

    std::span<const PointDemand> of(uint32_t model) {
        std::vector<PointDemand>& demands = of_model_[model];
        const float importance = model < scene_models_.size() ? scene_models_[model].importance : 1.0f;
        if (demands.empty())
            for (const PackedPart& part : plants_[model].parts) demands.emplace_back(part, importance);
        return demands;
    }

  private:
    std::span<const Plant> plants_;
    std::span<const SceneModel> scene_models_;
    std::vector<std::vector<PointDemand>> of_model_;  // never moved once made: sources point into them
};

bool is_usable(const PlantPosition& p) {
    return is_finite(vec3(p.x_tile, p.y_tile, p.z_tile)) && p.scale > 0.0f && p.scale <= k_largest_scale;
}

}  // namespace

TileCloud gather_cloud(std::span<const PlantPosition> positions, std::span<const PlantTurn> turns,
                       std::span<const PlantModel> models, std::span<const Plant> plants,
                       std::span<const SceneModel> scene_models) {
    assert(positions.size() == turns.size() && positions.size() == models.size());
    DemandsOfModels demands(plants, scene_models);
    std::vector<ColorTints> tints_of_model;
    for (const SceneModel& model : scene_models) tints_of_model.emplace_back(model.color_variation);
    std::vector<uint32_t> tints(positions.size(), 0);
    Totals totals;
    std::vector<Source> sources;
    for (size_t i = 0; i < positions.size(); ++i) {
        if (models[i].model < tints_of_model.size())
            tints[i] = tints_of_model[models[i].model].tint_of(models[i].seed);
        if (!is_usable(positions[i])) continue;
        const std::span<const PointDemand> parts = demands.of(models[i].model);
        const double scale_square = double(positions[i].scale) * double(positions[i].scale);
        std::array<vec3, k_projection_direction_count> directions_plant = projection_directions();
        const mat3 rotation = rotation_matrix(turns[i]);
        const HeightGain upright{legendre_2(rotation[1].y), legendre_4(rotation[1].y)};
        for (vec3& d : directions_plant) d = d * rotation;
        for (size_t p = 0; p < parts.size(); ++p) {
            const PointDemand& demand = parts[p];
            const double area_m2 = demand.area_m2() * scale_square;
            if (!(area_m2 > 0.0 && area_m2 <= k_largest_area_m2)) continue;
            const PackedPart& part = demand.part();
            for (size_t d = 0; d < directions_plant.size(); ++d)
                totals.seen_m2[d] +=
                    std::min(scale_square * double(part.projected_area_m2.evaluate(directions_plant[d])),
                             k_largest_area_m2);
            totals.surface_m2 +=
                double(part.area_m2) * scale_square * (part.flags & k_part_closed ? 0.5 : 1.0);
            for (size_t c = 0; c < 3; ++c)
                totals.color[glm::length_t(c)] += area_m2 * double(part.mean_color_linear[c]);
            const double exhausted = demand.stored_count() > 0
                                         ? demand.density(double(demand.stored_count())) / scale_square
                                         : 0.0;
            totals.exhausted_area_m2[density_step(exhausted)] += area_m2;
            const uint32_t number = uint32_t(p);
            sources.push_back({&demand, uint32_t(i), number, scale_square, upright,
                               part_chance(models[i], number),
                               first_point_of(models[i].seed, number, point_turn_mask(demand.stored_count()))});
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
        const PackedVertex& stored = source.point.vertex;
        const vec3 at = vec3(place.x_tile, place.y_tile, place.z_tile) +
                        rotation * (vec3(stored.x_plant, stored.y_plant, stored.z_plant) * place.scale);
        const vec3 normal = rotation * decode_surface(stored.surface).normal;
        const uint32_t surface = tint_surface(tints[source.plant], stored.surface,
                                              mix_bits(models[source.plant].seed + source.part) ^ mix_bits(source.given));
        cloud.points.push_back({at.x, at.y, at.z, replace_normal(surface, normal)});
        cloud.densities.push_back(source.density);
        ++source.given;
        if (find_point(source, plant)) {
            queue.back().first = source.density;
            std::push_heap(queue.begin(), queue.end(), std::greater<>());
        } else {
            queue.pop_back();
        }
    }

    finish(cloud, totals);
    set_height_gain(cloud, [&sources](double density) {
        DrawnGain sum;
        for (const Source& source : sources) {
            const PointDemand& demand = *source.demand;
            const double density_plant = density * source.scale_square;
            sum.add(demand.area_m2() * source.scale_square * demand.gain(density_plant),
                    demand.height_gain(density_plant), source.upright);
        }
        return sum;
    });
    return cloud;
}

TileCloud merge_clouds(std::span<const TileCloud* const> children, std::span<const vec3> offsets_m) {
    assert(children.size() == offsets_m.size());
    Totals totals;
    for (size_t i = 0; i < children.size(); ++i) {
        const TileCloud& child = *children[i];
        double area_m2 = 0.0;
        for (size_t step = 0; step < k_density_steps; ++step) {
            area_m2 += double(child.exhausted_area_m2[step]);
            totals.exhausted_area_m2[step] += double(child.exhausted_area_m2[step]);
        }
        for (size_t d = 0; d < totals.seen_m2.size(); ++d)
            totals.seen_m2[d] += double(child.part.projected_area_m2.evaluate(projection_directions()[d]));
        totals.surface_m2 += double(child.part.area_m2);
        for (size_t c = 0; c < 3; ++c)
            totals.color[glm::length_t(c)] += area_m2 * double(child.part.mean_color_linear[c]);
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

    finish(cloud, totals);
    set_height_gain(cloud, [children](double density) {
        DrawnGain sum;
        for (const TileCloud* child : children) {
            if (child->points.empty()) continue;
            const double fill =
                density * double(mean_projected_area_m2(child->part)) / double(child->part.point_count);
            const auto drawn =
                std::upper_bound(child->densities.begin(), child->densities.end(), float(density)) -
                child->densities.begin();
            sum.add(double(drawn), height_gain_at(child->part, float(fill)), {1.0f, 1.0f});
        }
        return sum;
    });
    return cloud;
}

}  // namespace coppice
