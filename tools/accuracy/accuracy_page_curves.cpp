// The curves of the accuracy page: error over frame time, and over the frames a view rests.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <fmt/format.h>
#include "tools/accuracy/accuracy_page_parts.h"
#include "tools/coppice/page_text.h"

namespace coppice {
namespace {

constexpr const char* k_full_name = "every triangle, 1 sample";

// Mean and single views are parts of one page; the chosen one is not hidden.
std::string open_view(const std::string& view) {
    return fmt::format("<div class=\"curves\" data-view=\"{}\"{}>\n", view, view == "mean" ? "" : " hidden");
}

std::string plot_card(const PageMetric& metric, Truth truth, const std::string& plot) {
    return fmt::format("<div class=\"plot {}\"><h3>{} <span>{}</span></h3>{}</div>\n", name_of(truth),
                       metric.name, metric.meaning, plot);
}

std::string point_title(const AccuracyRecord& record, const MethodPoint& point, Truth truth) {
    return fmt::format("{}\n{}\n{}", full_name(record, point.method, point.quality),
                       time_text(point.frame_ms), errors_line(point.against(truth)));
}

struct Ranges {
    LogRange x;
    LogRange y[std::size(k_truths)][std::size(k_page_metrics)];
};

// The same for the mean and every view, so that changing the view shows what changes.
template <class Points, class X>
Ranges ranges_of(const Points& points, X x_of) {
    Ranges ranges;
    std::vector<double> x;
    for (const auto& point : points) x.push_back(x_of(point));
    ranges.x = log_range(x);
    for (size_t t = 0; t < std::size(k_truths); ++t)
        for (size_t m = 0; m < std::size(k_page_metrics); ++m) {
            std::vector<double> y;
            for (const auto& point : points)
                y.push_back((k_truths[t] == Truth::shadowed ? point.errors : point.unshadowed_errors).*
                            k_page_metrics[m].field);
            ranges.y[t][m] = log_range(y);
        }
    return ranges;
}

std::string curves_of(const PageInput& page, const Ranges& ranges, const std::vector<MethodPoint>& points) {
    const AccuracyRecord& record = page.record;
    const std::optional<MethodPoint> full = point_at_default(record, points, record.full_method);
    std::string html;
    for (size_t t = 0; t < std::size(k_truths); ++t)
        for (size_t m = 0; m < std::size(k_page_metrics); ++m) {
            const PageMetric& metric = k_page_metrics[m];
            std::vector<LogPlotSeries> series;
            for (uint32_t method = 0; method < record.methods.size(); ++method) {
                LogPlotSeries one{page.styles[method], {}};
                for (const MethodPoint& point : points)
                    if (point.method == method)
                        one.points.push_back({point.frame_ms, point.against(k_truths[t]).*metric.field,
                                              point_title(record, point, k_truths[t])});
                series.push_back(std::move(one));
            }
            // Drawn last: on top.
            if (page.default_method < series.size())
                std::rotate(series.begin() + page.default_method, series.begin() + page.default_method + 1,
                            series.end());
            LogPlotSettings settings{fmt::format("{} over frame time", metric.name), "frame time, ms",
                                     ranges.x, ranges.y[t][m]};
            if (full) settings.reference = {{full->frame_ms, full->against(k_truths[t]).*metric.field, ""}};
            settings.reference_name = k_full_name;
            html += plot_card(metric, k_truths[t], log_plot(series, settings));
        }
    return html;
}

std::string legend(const PageInput& page) {
    std::string html = "<p class=\"methods\">\n";
    for (size_t i = 0; i < page.record.methods.size(); ++i) {
        const AccuracyMethodRecord& method = page.record.methods[i];
        html +=
            fmt::format("<label title=\"{}\"><input type=\"checkbox\" value=\"{}\" checked>{}{}{}</label>\n",
                        escape_html(method.what), page.styles[i].css_class, line_key(page.styles[i]),
                        escape_html(method.name),
                        i == page.default_method ? " <span class=\"badge\">default</span>" : "");
    }
    return html + "</p>\n";
}

const AccuracyRecord::Resting* find_resting(const AccuracyRecord& record, uint32_t view, uint32_t frames) {
    for (const AccuracyRecord::Resting& entry : record.resting)
        if (entry.view == view && entry.frames == frames) return &entry;
    return nullptr;
}

// One view at rest, or the mean of several; with the full geometry of the same views.
struct RestingCurve {
    std::vector<AccuracyRecord::Resting> entries;  // by rising number of frames
    std::optional<MethodPoint> full;
};

RestingCurve resting_curve(const AccuracyRecord& record, const std::vector<uint32_t>& views) {
    RestingCurve curve;
    AccuracyRecord part;
    part.methods = record.methods;
    part.full_method = record.full_method;
    std::vector<uint32_t> counts;
    for (const AccuracyRecord::Resting& entry : record.resting) counts.push_back(entry.frames);
    std::sort(counts.begin(), counts.end());
    counts.erase(std::unique(counts.begin(), counts.end()), counts.end());
    for (uint32_t frames : counts) {
        AccuracyRecord::Resting mean{0, frames, 0.0, {}, {}};
        bool in_all = true;
        for (uint32_t view : views) {
            const AccuracyRecord::Resting* entry = find_resting(record, view, frames);
            in_all = in_all && entry;
            if (!entry) break;
            mean.total_ms += entry->total_ms / double(views.size());
            for (const ErrorColumn& column : k_error_columns) {
                mean.errors.*column.field += entry->errors.*column.field / double(views.size());
                mean.unshadowed_errors.*column.field +=
                    entry->unshadowed_errors.*column.field / double(views.size());
            }
        }
        if (in_all) curve.entries.push_back(mean);
    }
    for (uint32_t view : views) {
        part.views.push_back(record.views[view]);
        for (AccuracySample sample : record.samples)
            if (sample.view == view && sample.method == record.full_method) {
                sample.view = uint32_t(part.views.size() - 1);
                part.samples.push_back(sample);
            }
    }
    curve.full = point_at_default(part, mean_points(part), part.full_method);
    return curve;
}

std::string resting_plots(const PageInput& page, const Ranges& ranges, const RestingCurve& curve) {
    std::string html;
    for (size_t t = 0; t < std::size(k_truths); ++t)
        for (size_t m = 0; m < std::size(k_page_metrics); ++m) {
            const PageMetric& metric = k_page_metrics[m];
            LogPlotSeries series{page.styles[page.default_method], {}};
            series.style.css_class = "";  // the legend of the curves is not meant
            for (const AccuracyRecord::Resting& entry : curve.entries) {
                const FrameErrors& errors =
                    k_truths[t] == Truth::shadowed ? entry.errors : entry.unshadowed_errors;
                series.points.push_back({double(entry.frames), errors.*metric.field,
                                         fmt::format("{} frames, {}\n{}", entry.frames,
                                                     time_text(entry.total_ms), errors_line(errors))});
            }
            LogPlotSettings settings{fmt::format("{} over frames at rest", metric.name), "frames at rest",
                                     ranges.x, ranges.y[t][m]};
            if (curve.full) settings.reference = {{1.0, curve.full->against(k_truths[t]).*metric.field, ""}};
            settings.reference_is_level = true;
            settings.reference_name = k_full_name;
            html += plot_card(metric, k_truths[t], log_plot({series}, settings));
        }
    return html;
}

// When each error falls below the full geometry's, and how far it goes.
std::string resting_table(const RestingCurve& curve) {
    if (!curve.full || curve.entries.empty()) return {};
    const AccuracyRecord::Resting &first = curve.entries.front(), &last = curve.entries.back();
    std::string html = fmt::format(
        "<div class=\"scroll\"><table class=\"numbers\"><thead><tr><th class=\"text\">mean of the "
        "views</th><th>{}</th><th>after {} frame{}</th><th>after {}</th><th>of full geometry's</th><th "
        "class=\"text\">no larger than full geometry's</th></tr></thead>",
        k_full_name, first.frames, first.frames == 1 ? "" : "s", last.frames);
    return html +
           of_both_truths(
               "tbody",
               [&](Truth truth) {
                   std::string rows;
                   for (const PageMetric& metric : k_page_metrics) {
                       auto error = [&](const AccuracyRecord::Resting& entry) {
                           return (truth == Truth::shadowed ? entry.errors : entry.unshadowed_errors).*
                                  metric.field;
                       };
                       const double limit = curve.full->against(truth).*metric.field;
                       const auto below = std::find_if(curve.entries.begin(), curve.entries.end(),
                                                       [&](auto& entry) { return error(entry) <= limit; });
                       rows += fmt::format(
                           "<tr><td class=\"text\">{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td "
                           "class=\"text\">{}</td></tr>\n",
                           metric.name, error_text(limit), error_text(error(first)), error_text(error(last)),
                           times_text(error(last) / limit),
                           below == curve.entries.end()
                               ? std::string("<span class=\"bad\">in none of them</span>")
                               : fmt::format("<span class=\"good\">from frame {}, {}</span>", below->frames,
                                             time_text(below->total_ms)));
                   }
                   return rows;
               }) +
           "</table></div>\n";
}

}  // namespace

std::string curves_section(const PageInput& page) {
    const AccuracyRecord& record = page.record;
    std::string html =
        "<section><h2>Error over time</h2>\n<p class=\"soft\">Every line is a method from its finest "
        "setting to its coarsest. Further left is quicker, further down is nearer to the reference; "
        "both axes are logarithmic. The shaded corner is what to look for: quicker than every triangle "
        "at one sample a pixel, and no further from the reference. Rest the mouse on a point for its "
        "setting.</p>\n" +
        legend(page);
    std::vector<MethodPoint> all;
    for (uint32_t view = 0; view < record.views.size(); ++view)
        for (MethodPoint& point : view_points(record, view)) all.push_back(point);
    const Ranges ranges = ranges_of(all, [](auto& point) { return point.frame_ms; });
    html += open_view("mean") + curves_of(page, ranges, page.means) + "</div>\n";
    if (record.views.size() > 1)
        for (uint32_t view = 0; view < record.views.size(); ++view)
            html += open_view(std::to_string(view)) + curves_of(page, ranges, view_points(record, view)) +
                    "</div>\n";
    return html + "</section>\n";
}

std::string resting_section(const PageInput& page) {
    const AccuracyRecord& record = page.record;
    if (record.resting.empty() || page.styles.empty()) return {};
    std::vector<uint32_t> views;
    for (uint32_t view = 0; view < record.views.size(); ++view)
        if (std::any_of(record.resting.begin(), record.resting.end(),
                        [view](auto& entry) { return entry.view == view; }))
            views.push_back(view);
    struct Point {
        double frames;
        FrameErrors errors, unshadowed_errors;
    };
    std::vector<Point> all;
    for (const AccuracyRecord::Resting& entry : record.resting)
        all.push_back({double(entry.frames), entry.errors, entry.unshadowed_errors});
    for (uint32_t view : views)
        if (auto full = point_at_default(record, view_points(record, view), record.full_method))
            all.push_back({1.0, full->errors, full->unshadowed_errors});
    const Ranges ranges = ranges_of(all, [](auto& point) { return point.frames; });

    const RestingCurve mean = resting_curve(record, views);
    std::string html =
        "<section><h2>A view at rest</h2>\n<p class=\"soft\">While the camera stands still, frames add "
        "up to one picture, each from another place of the pixel: the error after n frames of the "
        "default method.</p>\n" +
        resting_table(mean) + open_view("mean") + resting_plots(page, ranges, mean) + "</div>\n";
    if (record.views.size() > 1)
        for (uint32_t view = 0; view < record.views.size(); ++view)
            html += open_view(std::to_string(view)) +
                    (std::find(views.begin(), views.end(), view) == views.end()
                         ? "<p class=\"soft\">Not measured in this view.</p>"
                         : resting_plots(page, ranges, resting_curve(record, {view}))) +
                    "</div>\n";
    return html + "</section>\n";
}

}  // namespace coppice
