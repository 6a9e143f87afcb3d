// The pictures of the accuracy page: for each view the reference and what the methods make of it in the same
// time.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include "tools/accuracy/accuracy_page_parts.h"
#include "tools/coppice/page_text.h"

namespace coppice {
namespace {

std::string picture(const AccuracyRecord& record, const std::string& file, const std::string& what) {
    if (file.empty()) return fmt::format("<div class=\"none\">{}: not kept</div>", escape_html(what));
    return fmt::format(
        "<a href=\"{0}\"><img loading=\"lazy\" src=\"{0}\" width=\"{1}\" height=\"{2}\" alt=\"{3}\"></a>",
        escape_html(file), record.width, record.height, escape_html(what));
}

// How far in time, as a factor. What has no picture comes after all that have one.
double distance(const AccuracySample& sample, double frame_ms) {
    constexpr double k_least_ms = 1e-3;
    const double factor =
        std::abs(std::log(std::max(sample.frame_ms, k_least_ms) / std::max(frame_ms, k_least_ms)));
    return (std::isfinite(factor) ? factor : 100.0) + (sample.picture_file.empty() ? 1000.0 : 0.0);
}

const AccuracySample* nearest_in_time(const AccuracyRecord& record, uint32_t view, uint32_t method,
                                      double frame_ms) {
    const AccuracySample* nearest = nullptr;
    for (const AccuracySample& sample : record.samples)
        if (sample.view == view && sample.method == method &&
            (!nearest || distance(sample, frame_ms) < distance(*nearest, frame_ms)))
            nearest = &sample;
    return nearest;
}

const AccuracySample* nearest_in_quality(const AccuracyRecord& record, uint32_t view, uint32_t method) {
    const std::optional<MethodPoint> point = point_at_default(record, view_points(record, view), method);
    for (const AccuracySample& sample : record.samples)
        if (point && sample.view == view && sample.method == method && sample.quality == point->quality)
            return &sample;
    return nullptr;
}

std::string tile(const PageInput& page, const AccuracySample& sample) {
    const AccuracyRecord& record = page.record;
    const std::string name = full_name(record, sample.method, sample.quality);
    return "<figure>" + picture(record, sample.picture_file, name) +
           picture(record, sample.flip_file, "FLIP map of " + name) +
           fmt::format("<figcaption><b>{}</b>{}<br>{}<br>", escape_html(name),
                       sample.method == page.default_method ? " <span class=\"badge\">default</span>" : "",
                       time_text(sample.frame_ms)) +
           of_both_truths(
               "span",
               [&](Truth truth) {
                   return errors_line(truth == Truth::shadowed ? sample.errors : sample.unshadowed_errors);
               }) +
           "</figcaption></figure>\n";
}

}  // namespace

std::string pictures_section(const PageInput& page) {
    const AccuracyRecord& record = page.record;
    if (record.views.empty()) return {};
    std::string html =
        "<h2>Pictures</h2>\n<p class=\"soft\">Under each picture its FLIP map: the brighter, the more "
        "the eye notices when the reference takes its place. The default method is at its default "
        "setting, the others at the one nearest to it in time. Click to enlarge.</p>\n";
    for (uint32_t view = 0; view < record.views.size(); ++view) {
        html += fmt::format(
            "<h3>{} <span class=\"soft\">plants cover {} % of it</span></h3>\n<div class=\"row main\">\n",
            escape_html(record.views[view].name), number_text(100.0 * record.views[view].plant_coverage, 0));
        html += "<figure>" + picture(record, record.views[view].reference_file, "the reference") +
                fmt::format(
                    "<figcaption><b>reference</b><br>ray traced, every triangle, {} samples a pixel"
                    "</figcaption></figure>\n",
                    record.reference_samples);
        const AccuracySample* shown = nearest_in_quality(record, view, page.default_method);
        const AccuracySample* full = nearest_in_quality(record, view, record.full_method);
        if (shown) html += tile(page, *shown);
        if (full && full != shown) html += tile(page, *full);
        html += "</div>\n<div class=\"row\">\n";
        for (uint32_t method = 0; method < record.methods.size(); ++method) {
            if (method == page.default_method || method == record.full_method) continue;
            const AccuracySample* sample =
                nearest_in_time(record, view, method, shown ? shown->frame_ms : 0.0);
            if (sample) html += tile(page, *sample);
        }
        html += "</div>\n";
    }
    return html;
}

}  // namespace coppice
