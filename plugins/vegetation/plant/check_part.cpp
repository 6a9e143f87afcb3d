#include "plugins/vegetation/plant/check_part.h"

#include <cstring>

namespace coppice {
namespace {

bool all_finite(std::span<const float> values) {
    for (float v : values)
        if (!std::isfinite(v)) return false;
    return true;
}

}  // namespace

const char* fault_of_measures(const PackedPart& part) {
    if (std::memchr(part.name, 0, sizeof part.name) == nullptr) return "the name does not end";
    if (part.kind != PackedPartKind::points && part.kind != PackedPartKind::lines) return "an unknown kind";
    if (!(part.importance > 0.0f) || !std::isfinite(part.importance))
        return "an importance that is not positive";
    const float measures[] = {
        part.area_m2,        part.line_length_m,        part.line_error_m,         part.longest_edge_m,
        part.point_radius_m, part.mean_color_linear[0], part.mean_color_linear[1], part.mean_color_linear[2]};
    for (float measure : measures)
        if (!(measure >= 0.0f) || !std::isfinite(measure)) return "a negative or infinite measure";
    if (!all_finite(part.projected_area_m2.m) || !all_finite(part.projected_length_m.m))
        return "a value that is not finite";
    for (float gain : part.coverage_gain)
        if (!(gain > 0.0f) || !std::isfinite(gain)) return "a coverage gain that is not positive";
    return nullptr;
}

}  // namespace coppice
