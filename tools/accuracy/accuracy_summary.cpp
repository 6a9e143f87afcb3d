#include "tools/accuracy/accuracy_summary.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace coppice {
namespace {

constexpr double MethodPoint::*k_point_fields[] = {&MethodPoint::frame_ms,       &MethodPoint::triangles,
                                                   &MethodPoint::lines,          &MethodPoint::points,
                                                   &MethodPoint::geometry_bytes, &MethodPoint::list_bytes};

MethodPoint make_point(const AccuracySample& sample) {
    return {sample.method,
            sample.quality,
            sample.frame_ms,
            double(sample.triangles),
            double(sample.lines),
            double(sample.points),
            double(sample.geometry_bytes),
            double(sample.list_bytes),
            sample.errors,
            sample.unshadowed_errors};
}

// Of every field that is averaged.
void add_scaled(MethodPoint& sum, const MethodPoint& point, double factor) {
    for (auto field : k_point_fields) sum.*field += factor * point.*field;
    for (const ErrorColumn& column : k_error_columns) {
        sum.errors.*column.field += factor * point.errors.*column.field;
        sum.unshadowed_errors.*column.field += factor * point.unshadowed_errors.*column.field;
    }
}

std::vector<MethodPoint> by_method(std::vector<MethodPoint> points) {
    std::stable_sort(points.begin(), points.end(), [](auto& a, auto& b) { return a.method < b.method; });
    return points;
}

}  // namespace

std::vector<MethodPoint> view_points(const AccuracyRecord& record, uint32_t view) {
    std::vector<MethodPoint> points;
    for (const AccuracySample& sample : record.samples)
        if (sample.view == view) points.push_back(make_point(sample));
    return by_method(std::move(points));
}

std::vector<MethodPoint> mean_points(const AccuracyRecord& record) {
    std::vector<MethodPoint> means;
    for (const AccuracySample& first : record.samples) {
        auto same = [&first](auto& other) {
            return other.method == first.method && other.quality == first.quality;
        };
        if (std::any_of(means.begin(), means.end(), same)) continue;
        std::vector<bool> seen(record.views.size(), false);
        const double count = double(std::count_if(record.samples.begin(), record.samples.end(), same));
        MethodPoint mean{first.method, first.quality};
        for (const AccuracySample& sample : record.samples) {
            if (!same(sample)) continue;
            add_scaled(mean, make_point(sample), 1.0 / count);
            if (sample.view < seen.size()) seen[sample.view] = true;
        }
        if (std::all_of(seen.begin(), seen.end(), [](bool in) { return in; })) means.push_back(mean);
    }
    return by_method(std::move(means));
}

std::optional<MethodPoint> best_within(std::span<const MethodPoint> points, double budget_ms, Truth truth) {
    std::optional<MethodPoint> best;
    for (const MethodPoint& point : points) {
        const double flip = point.against(truth).flip;
        if (!(point.frame_ms <= budget_ms) || !std::isfinite(flip)) continue;
        const double least = best ? best->against(truth).flip : 0.0;
        if (!best || flip < least || (flip == least && point.frame_ms < best->frame_ms)) best = point;
    }
    return best;
}

std::optional<MethodPoint> best_within(const AccuracyRecord& record, double budget_ms, Truth truth) {
    return best_within(mean_points(record), budget_ms, truth);
}

uint32_t default_method(const AccuracyRecord& record) {
    for (size_t i = 0; i < record.methods.size(); ++i)
        if (record.methods[i].is_default) return uint32_t(i);
    return record.full_method;
}

std::optional<MethodPoint> point_at_default(const AccuracyRecord& record, std::span<const MethodPoint> points,
                                            uint32_t method) {
    std::optional<MethodPoint> nearest;
    if (method >= record.methods.size()) return nearest;
    auto distance = [wanted = record.methods[method].default_quality](const MethodPoint& point) {
        return std::abs(point.quality - wanted);
    };
    for (const MethodPoint& point : points)
        if (point.method == method && (!nearest || distance(point) < distance(*nearest))) nearest = point;
    return nearest;
}

std::string setting_text(const AccuracyMethodRecord& method, double quality) {
    if (method.quality_name.empty()) return {};
    // A short last word is a unit: "d' px".
    const size_t space = method.quality_name.rfind(' ');
    if (space == std::string::npos || method.quality_name.size() - space > 3)
        return fmt::format("{} {:g}", method.quality_name, quality);
    return fmt::format("{} {:g}{}", method.quality_name.substr(0, space), quality,
                       method.quality_name.substr(space));
}

}  // namespace coppice
