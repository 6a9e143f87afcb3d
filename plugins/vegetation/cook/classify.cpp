#include "plugins/vegetation/cook/classify.h"

#include "plugins/vegetation/cook/trace_lines.h"
#include "plugins/vegetation/cook/triangle_areas.h"

namespace coppice {
namespace {

constexpr double k_slender_elongation = 6.0;
constexpr double k_slender_share = 0.6;

// Share of the area that belongs to slender stems.
double slender_share(const PartDescription& part, const TracedSkeleton& skeleton, bool closed) {
    std::vector<double> areas = triangle_areas(part);
    std::vector<StemRange> stems = find_stems(skeleton.segments);
    std::vector<uint32_t> stem_of(skeleton.segments.size());
    for (uint32_t i = 0; i < stems.size(); ++i)
        for (uint32_t s = stems[i].first; s < stems[i].last; ++s) stem_of[s] = i;
    std::vector<double> stem_area(stems.size(), 0.0);
    for (size_t t = 0; t < areas.size(); ++t) stem_area[stem_of[skeleton.triangle_segment[t]]] += areas[t];
    double slender = 0.0, total = 0.0;
    for (size_t i = 0; i < stems.size(); ++i) {
        double length = double(stems[i].length_m);
        // A tube's area is pi times its length times its thickness, a blade's is length times width.
        double elongation = length * length * (closed ? double(k_pi) : 1.0) / std::max(stem_area[i], 1e-30);
        if (elongation > k_slender_elongation) slender += stem_area[i];
        total += stem_area[i];
    }
    return total > 0.0 ? slender / total : 0.0;
}

}  // namespace

std::vector<SlenderPart> classify_part(PartDescription part, const std::vector<uint32_t>& welded, bool closed,
                                       LineParts line_parts) {
    SlenderPart whole;
    const bool may_be_lines =
        part.kind == PartKind::lines ||
        (part.kind == PartKind::automatic &&
         (part.leaf ? line_parts == LineParts::slender : line_parts != LineParts::none));
    part.kind = may_be_lines && line_parts != LineParts::none ? part.kind : PartKind::points;
    if (part.kind != PartKind::points) {
        bool has_skeleton = !part.skeleton.empty();
        whole.skeleton = has_skeleton ? adopt_skeleton(part) : trace_skeleton(part, welded);
        bool slender = part.kind == PartKind::lines || has_skeleton ||
                       slender_share(part, whole.skeleton, closed) > k_slender_share;
        part.kind = slender ? PartKind::lines : PartKind::points;
    }
    whole.part = std::move(part);
    if (whole.part.kind == PartKind::lines) return split_by_thickness(std::move(whole));
    whole.skeleton = {};
    std::vector<SlenderPart> pieces;
    pieces.push_back(std::move(whole));
    return pieces;
}

}  // namespace coppice
