#include "plugins/vegetation/query/stem_index.h"

#include <algorithm>
#include <cmath>

namespace coppice {
namespace {

constexpr int k_block = 8;  // squares a side that lie together in memory
constexpr size_t k_most_changes = 64;

// Where the ray enters and leaves the box; an empty range where it does not.
struct Span {
    double first, last;
};
Span clip(dvec3 from, dvec3 direction, double most, dvec3 least_corner, dvec3 most_corner) {
    Span span{0.0, most};
    for (int axis = 0; axis < 3; ++axis) {
        if (direction[axis] == 0.0) {
            if (from[axis] < least_corner[axis] || from[axis] > most_corner[axis]) return {1.0, 0.0};
            continue;
        }
        const double a = (least_corner[axis] - from[axis]) / direction[axis],
                     b = (most_corner[axis] - from[axis]) / direction[axis];
        span.first = std::max(span.first, std::min(a, b));
        span.last = std::min(span.last, std::max(a, b));
    }
    return span;
}

// How far along [0, 1] the axis is nearest to a place, which is given from the foot.
float nearest_along(vec3 axis, vec3 from_foot) {
    const float square = glm::dot(axis, axis);
    return square > 0.0f ? glm::clamp(glm::dot(axis, from_foot) / square, 0.0f, 1.0f) : 0.0f;
}

// Along a unit direction from a place, given from the foot, to the capsule's surface: 0 from inside, infinite where it is
// not met. The surface is that of an endless cylinder between the ends of the axis, and of a sphere at each end.
float distance_to_capsule(vec3 place, vec3 direction, vec3 axis, float radius) {
    // Counted from where the ray is nearest to the foot: squares of long ways would leave nothing of the radius.
    const float nearest_m = -glm::dot(place, direction), radius_square = radius * radius;
    const vec3 from_foot = place + direction * nearest_m;
    const float axis_square = glm::dot(axis, axis), axis_along = glm::dot(axis, direction),
                axis_from = glm::dot(axis, from_foot);
    const float a = axis_square - axis_along * axis_along;  // 0: along the axis
    const float b = -axis_from * axis_along;
    const float c = axis_square * (glm::dot(from_foot, from_foot) - radius_square) - axis_from * axis_from;
    float along =
        axis_along > 0.0f ? -1.0f : axis_square + 1.0f;  // of the place on the axis, times its length
    if (a > 1e-6f * axis_square) {
        const float discriminant = b * b - a * c;
        if (discriminant < 0.0f) return INFINITY;
        const float distance = (-b - std::sqrt(discriminant)) / a;
        along = axis_from + distance * axis_along;
        if (along >= 0.0f && along <= axis_square && distance + nearest_m >= 0.0f)
            return distance + nearest_m;
    } else if (c > 0.0f && axis_square > 0.0f) {
        return INFINITY;
    }
    const vec3 inside = place - axis * nearest_along(axis, place);
    if (glm::dot(inside, inside) <= radius_square) return 0.0f;
    const vec3 from_end = along <= 0.0f ? from_foot : from_foot - axis;
    const float end_along = glm::dot(from_end, direction);
    const float discriminant = end_along * end_along - glm::dot(from_end, from_end) + radius_square;
    if (discriminant < 0.0f) return INFINITY;
    const float distance = nearest_m - end_along - std::sqrt(discriminant);
    return distance >= 0.0f ? distance : INFINITY;
}

bool finite(dvec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

bool usable(const Stem& stem) {
    return finite(stem.foot_world) && finite(stem.head_world) && std::isfinite(stem.radius_m) &&
           stem.radius_m > 0.0f;
}

}  // namespace

StemIndex::StemIndex(std::span<const Stem> stems) { build({stems.begin(), stems.end()}); }

StemIndex::Capsule StemIndex::capsule_of(const Stem& stem) const {
    const vec3 foot(stem.foot_world - origin_);
    return {foot, stem.radius_m, vec3(stem.head_world - origin_) - foot, stem.plant};
}

Stem StemIndex::stem_of(const Capsule& capsule) const {
    return {origin_ + dvec3(capsule.foot), origin_ + dvec3(capsule.foot + capsule.axis), capsule.radius_m,
            capsule.plant};
}

uint32_t StemIndex::square(int x, int z) const {
    const uint32_t block = uint32_t(z / k_block) * blocks_across_ + uint32_t(x / k_block);
    return block * k_block * k_block + uint32_t(z % k_block) * k_block + uint32_t(x % k_block);
}

StemIndex::Squares StemIndex::squares_between(vec3 least, vec3 most) const {
    auto at = [this](float place, float corner, int count) {
        const float square = std::floor((place - corner) / side_m_);
        return int(std::clamp(square, -1.0f, float(count)));
    };
    return {std::max(at(least.x, corner_.x, count_x_), 0), std::max(at(least.z, corner_.z, count_z_), 0),
            std::min(at(most.x, corner_.x, count_x_) + 1, count_x_),
            std::min(at(most.z, corner_.z, count_z_) + 1, count_z_)};
}

StemIndex::Squares StemIndex::squares_of(const Capsule& capsule) const {
    const vec3 head = capsule.foot + capsule.axis;
    return squares_between(glm::min(capsule.foot, head) - std::fabs(capsule.radius_m),
                           glm::max(capsule.foot, head) + std::fabs(capsule.radius_m));
}

std::span<const StemIndex::Capsule> StemIndex::built_in(uint32_t square) const {
    return std::span(capsules_).subspan(first_[square], first_[square + 1] - first_[square]);
}

template <class Visit>
void StemIndex::visit(uint32_t square, Visit&& visit) const {
    for (const Capsule& capsule : built_in(square))
        if (capsule.radius_m > 0.0f) visit(capsule);
    if (added_in_.empty()) return;
    if (auto added = added_in_.find(square); added != added_in_.end())
        for (const Capsule& capsule : added->second) visit(capsule);
}

void StemIndex::build(std::vector<Stem> stems) {
    *this = StemIndex();
    std::erase_if(stems, [](const Stem& stem) { return !usable(stem); });
    std::ranges::stable_sort(stems, {}, &Stem::plant);
    size_t kept = 0;
    for (size_t i = 0; i < stems.size(); ++i)
        if (i + 1 == stems.size() || stems[i + 1].plant != stems[i].plant) stems[kept++] = stems[i];
    stems.resize(kept);
    if (stems.empty()) return;

    dvec3 least(INFINITY), most(-INFINITY);
    for (const Stem& stem : stems) {
        least = glm::min(least, stem.foot_world);
        most = glm::max(most, stem.foot_world);
    }
    origin_ = (least + most) * 0.5;
    least_ = vec3(INFINITY);
    most_ = vec3(-INFINITY);
    std::vector<Capsule> capsules;
    double width_sum_m = 0.0;
    for (const Stem& stem : stems) {
        const Capsule capsule = capsule_of(stem);
        const vec3 head = capsule.foot + capsule.axis;
        least_ = glm::min(least_, glm::min(capsule.foot, head) - capsule.radius_m);
        most_ = glm::max(most_, glm::max(capsule.foot, head) + capsule.radius_m);
        width_sum_m +=
            double(2.0f * capsule.radius_m + std::fabs(capsule.axis.x) + std::fabs(capsule.axis.z));
        capsules.push_back(capsule);
    }
    // About a stem a square, but squares no smaller than what stands in them.
    const double across_m = double(most_.x) - double(least_.x), along_m = double(most_.z) - double(least_.z);
    const double count = double(stems.size());
    side_m_ = float(std::max({std::sqrt(across_m * along_m / count), width_sum_m / count,
                              std::max(across_m, along_m) / 65536.0, 1e-3}));
    corner_ = least_;
    count_x_ = int(across_m / double(side_m_)) + 1;
    count_z_ = int(along_m / double(side_m_)) + 1;
    blocks_across_ = uint32_t((count_x_ - 1) / k_block + 1);
    const size_t squares = size_t(blocks_across_) * size_t((count_z_ - 1) / k_block + 1) * k_block * k_block;

    auto each_place = [&](auto&& place) {
        for (const Capsule& capsule : capsules) {
            const Squares in = squares_of(capsule);
            for (int z = in.first_z; z < in.end_z; ++z)
                for (int x = in.first_x; x < in.end_x; ++x) place(capsule, square(x, z));
        }
    };
    first_.assign(squares + 1, 0);
    each_place([&](const Capsule&, uint32_t at) { ++first_[at + 1]; });
    for (size_t i = 0; i < squares; ++i) first_[i + 1] += first_[i];
    capsules_.resize(first_[squares]);
    std::vector<uint32_t> next(first_.begin(), first_.end() - 1);
    each_place([&](const Capsule& capsule, uint32_t at) {
        const uint32_t row = next[at]++;
        capsules_[row] = capsule;
        if (rows_.empty() || rows_.back().plant != capsule.plant) rows_.push_back({capsule.plant, row});
    });
    size_ = rows_.size();
}

StemHit StemIndex::first_hit(dvec3 from_world, vec3 direction, float most_distance_m) const {
    StemHit hit;
    const double length = glm::length(dvec3(direction));
    if (size_ == 0 || !finite(from_world) || !std::isfinite(length) || length == 0.0 ||
        !(most_distance_m >= 0.0f))
        return hit;
    const dvec3 along = dvec3(direction) / length;
    const Span span = clip(from_world - origin_, along, double(most_distance_m), dvec3(least_), dvec3(most_));
    if (!(span.first <= span.last)) return hit;
    // From where the ray enters, so that nothing is lost to large numbers.
    const vec3 from(from_world - origin_ + along * span.first), unit(along);
    const float reach_m = float(span.last - span.first);
    float best_m = std::nextafter(reach_m, INFINITY);
    const Capsule* met = nullptr;
    auto test = [&](const Capsule& capsule) {
        const float distance_m =
            distance_to_capsule(from - capsule.foot, unit, capsule.axis, capsule.radius_m);
        if (distance_m > best_m || (distance_m == best_m && (!met || capsule.plant >= met->plant))) return;
        best_m = distance_m;
        met = &capsule;
    };
    for (const Capsule& capsule : beside_) test(capsule);

    // From square to square, over the nearer of the two next borders.
    struct Axis {
        int square, step, end;
        float next_m, a_square_m;  // along the ray
    };
    auto start = [&](float place, float slope, int count) {
        const float squares = place / side_m_;
        Axis axis;
        axis.square = std::clamp(int(std::floor(squares)), 0, count - 1);
        axis.step = slope > 0.0f ? 1 : -1;
        axis.end = slope > 0.0f ? count : -1;
        axis.a_square_m = slope == 0.0f ? INFINITY : side_m_ / std::fabs(slope);
        const float border = float(axis.square + (slope > 0.0f ? 1 : 0)) * side_m_;
        axis.next_m = slope == 0.0f ? INFINITY : (border - place) / slope;
        return axis;
    };
    Axis x = start(from.x - corner_.x, unit.x, count_x_), z = start(from.z - corner_.z, unit.z, count_z_);
    while (true) {
        visit(square(x.square, z.square), test);
        Axis& next = x.next_m < z.next_m ? x : z;
        if (!(next.next_m < best_m)) break;
        next.square += next.step;
        if (next.square == next.end) break;
        next.next_m += next.a_square_m;
    }
    if (!met) return hit;
    hit.plant = met->plant;
    hit.distance_m = float(span.first + double(best_m));
    const vec3 from_foot = from + unit * best_m - met->foot;
    hit.normal_world = normalize_or(from_foot - met->axis * nearest_along(met->axis, from_foot), -unit);
    return hit;
}

StemHit StemIndex::nearest(dvec3 at_world, float within_m) const {
    StemHit hit;
    if (size_ == 0 || !finite(at_world) || !(within_m >= 0.0f)) return hit;
    const vec3 at(at_world - origin_);
    vec3 away(0.0f);
    auto test = [&](const Capsule& capsule) {
        const vec3 from_foot = at - capsule.foot;
        const vec3 apart = from_foot - capsule.axis * nearest_along(capsule.axis, from_foot);
        const float distance_m = std::max(glm::length(apart) - capsule.radius_m, 0.0f);
        if (distance_m > within_m || distance_m > hit.distance_m ||
            (distance_m == hit.distance_m && capsule.plant >= hit.plant))
            return;
        hit.plant = capsule.plant;
        hit.distance_m = distance_m;
        away = apart;
    };
    for (const Capsule& capsule : beside_) test(capsule);
    // Rings of squares about that of the place, or the one of the grid that is nearest to it.
    const int middle_x = int(std::clamp(std::floor((at.x - corner_.x) / side_m_), 0.0f, float(count_x_ - 1))),
              middle_z = int(std::clamp(std::floor((at.z - corner_.z) / side_m_), 0.0f, float(count_z_ - 1)));
    const float outside_m = std::max({corner_.x - at.x, at.x - corner_.x - float(count_x_) * side_m_,
                                      corner_.z - at.z, at.z - corner_.z - float(count_z_) * side_m_, 0.0f});
    const int most_rings = std::max(count_x_, count_z_);
    for (int ring = 0; ring <= most_rings; ++ring) {
        // What is farther out is at least so far away.
        const float least_m = std::max(float(ring - 1) * side_m_, outside_m);
        if (least_m > std::min(within_m, hit.distance_m)) break;
        for (int z = middle_z - ring; z <= middle_z + ring; ++z) {
            if (z < 0 || z >= count_z_) continue;
            const bool whole_row = z == middle_z - ring || z == middle_z + ring;
            for (int x = middle_x - ring; x <= middle_x + ring; x += whole_row || ring == 0 ? 1 : 2 * ring)
                if (x >= 0 && x < count_x_) visit(square(x, z), test);
        }
    }
    if (hit.any()) hit.normal_world = normalize_or(away, vec3(0.0f, 1.0f, 0.0f));
    return hit;
}

void StemIndex::in_box(dvec3 least_world, dvec3 most_world, std::vector<Stem>& out) const {
    if (size_ == 0 || !finite(least_world) || !finite(most_world)) return;
    const vec3 least(least_world - origin_), most(most_world - origin_);
    if (!(least.x <= most.x && least.y <= most.y && least.z <= most.z)) return;
    // The box of a capsule, not the capsule itself, whose ends are round.
    auto touches = [&](const Capsule& capsule) {
        const vec3 head = capsule.foot + capsule.axis;
        const vec3 low = glm::min(capsule.foot, head) - capsule.radius_m,
                   high = glm::max(capsule.foot, head) + capsule.radius_m;
        return low.x <= most.x && low.y <= most.y && low.z <= most.z && high.x >= least.x &&
               high.y >= least.y && high.z >= least.z;
    };
    for (const Capsule& capsule : beside_)
        if (touches(capsule)) out.push_back(stem_of(capsule));
    const Squares in = squares_between(least, most);
    for (int z = in.first_z; z < in.end_z; ++z)
        for (int x = in.first_x; x < in.end_x; ++x)
            visit(square(x, z), [&](const Capsule& capsule) {
                // Of the squares it lies in, the first here tells of it.
                const Squares of = squares_of(capsule);
                if (x != std::max(of.first_x, in.first_x) || z != std::max(of.first_z, in.first_z)) return;
                if (touches(capsule)) out.push_back(stem_of(capsule));
            });
}

const StemIndex::Capsule* StemIndex::find(uint32_t plant) const {
    auto row = std::ranges::lower_bound(rows_, plant, {}, &Row::plant);
    return row != rows_.end() && row->plant == plant ? &capsules_[row->capsule] : nullptr;
}

std::vector<Stem> StemIndex::all() const {
    std::vector<Stem> stems;
    for (const Row& row : rows_)
        if (capsules_[row.capsule].radius_m > 0.0f) stems.push_back(stem_of(capsules_[row.capsule]));
    for (const auto& [plant, capsule] : added_) stems.push_back(stem_of(capsule));
    return stems;
}

void StemIndex::remove(uint32_t plant) {
    if (auto added = added_.find(plant); added != added_.end()) {
        const Squares in = squares_of(added->second);
        for (int z = in.first_z; z < in.end_z; ++z)
            for (int x = in.first_x; x < in.end_x; ++x)
                std::erase_if(added_in_[square(x, z)], [&](const Capsule& c) { return c.plant == plant; });
        std::erase_if(beside_, [&](const Capsule& c) { return c.plant == plant; });
        added_.erase(added);
        --size_;
        return;
    }
    const Capsule* built = find(plant);
    if (!built || built->radius_m < 0.0f) return;
    const Squares in = squares_of(*built);
    for (int z = in.first_z; z < in.end_z; ++z)
        for (int x = in.first_x; x < in.end_x; ++x) {
            const uint32_t at = square(x, z);
            for (uint32_t i = first_[at]; i < first_[at + 1]; ++i)
                if (capsules_[i].plant == plant) capsules_[i].radius_m = -capsules_[i].radius_m;
        }
    --size_;
}

void StemIndex::set(const Stem& stem) {
    remove(stem.plant);
    if (!usable(stem)) return;
    if (first_.empty()) return build({stem});
    const Capsule capsule = capsule_of(stem);
    added_.emplace(stem.plant, capsule);
    ++size_;
    const vec3 head = capsule.foot + capsule.axis;
    const vec3 low = glm::min(capsule.foot, head) - capsule.radius_m,
               high = glm::max(capsule.foot, head) + capsule.radius_m;
    const vec3 end = corner_ + vec3(float(count_x_) * side_m_, 0.0f, float(count_z_) * side_m_);
    least_ = glm::min(least_, low);
    most_ = glm::max(most_, high);
    if (low.x < corner_.x || low.z < corner_.z || high.x >= end.x || high.z >= end.z) {
        beside_.push_back(capsule);
    } else {
        const Squares in = squares_of(capsule);
        for (int z = in.first_z; z < in.end_z; ++z)
            for (int x = in.first_x; x < in.end_x; ++x) added_in_[square(x, z)].push_back(capsule);
    }
    if (added_.size() > k_most_changes + rows_.size() / 2 ||
        beside_.size() > k_most_changes + rows_.size() / 256)
        build(all());
}

uint64_t StemIndex::size_bytes() const {
    return first_.size() * sizeof(first_[0]) + capsules_.size() * sizeof(Capsule) +
           rows_.size() * sizeof(Row) + added_.size() * 2 * sizeof(Capsule);
}

}  // namespace coppice
