#include "tools/accuracy/accuracy_page.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string_view>
#include <utility>
#include <fmt/format.h>
#include "tools/accuracy/accuracy_page_parts.h"
#include "tools/accuracy/accuracy_page_style.h"
#include "tools/coppice/page_style.h"
#include "tools/coppice/page_text.h"

namespace coppice {
namespace {

// A frame at 1000, 500 ... 30, 15, 5, 2 hertz.
constexpr double k_budgets_ms[] = {1, 2, 4, 8, 16, 33, 66, 200, 500};
constexpr double k_usual_budget_ms = 33;

struct Budget {
    double budget_ms;
    MethodPoint best;
};

// From the smallest that anything keeps to the first that a larger one does not improve on.
std::vector<Budget> budgets_of(const PageInput& page, Truth truth) {
    std::vector<Budget> budgets;
    const auto best_of_all = best_within(page.means, std::numeric_limits<double>::max(), truth);
    for (double budget_ms : k_budgets_ms) {
        const auto best = best_within(page.means, budget_ms, truth);
        if (!best) continue;
        budgets.push_back({budget_ms, *best});
        if (best->frame_ms >= best_of_all->frame_ms &&
            best->against(truth).flip <= best_of_all->against(truth).flip)
            break;
    }
    return budgets;
}

bool no_further(const PageInput& page, const MethodPoint& point, Truth truth) {
    return page.full && std::all_of(std::begin(k_page_metrics), std::end(k_page_metrics), [&](auto& metric) {
               return point.against(truth).*metric.field <= page.full->against(truth).*metric.field;
           });
}

std::string answer(const PageInput& page, const std::vector<Budget>& budgets, Truth truth) {
    if (budgets.empty())
        return page.means.empty()
                   ? "Nothing was measured in every view."
                   : fmt::format("No method draws a frame within {:g} ms here.", *std::rbegin(k_budgets_ms));
    // The usual budget, else the largest below, else what there is.
    const Budget* chosen = &budgets.front();
    for (const Budget& budget : budgets)
        if (budget.budget_ms <= k_usual_budget_ms) chosen = &budget;
    const MethodPoint& best = chosen->best;
    std::string text = fmt::format("Within {:g} ms a frame, use <b>{}</b>: FLIP {} in {}", chosen->budget_ms,
                                   escape_html(full_name(page.record, best.method, best.quality)),
                                   error_text(best.against(truth).flip), time_text(best.frame_ms));
    if (page.full && best.method != page.record.full_method)
        text += fmt::format("; drawing every triangle once a pixel has {} and takes {}, {} as long",
                            error_text(page.full->against(truth).flip), time_text(page.full->frame_ms),
                            times_text(page.full->frame_ms / best.frame_ms));
    return text + ".";
}

std::string error_cells(const PageInput& page, const MethodPoint& point, Truth truth) {
    std::string html;
    for (const PageMetric& metric : k_page_metrics) {
        const double error = point.against(truth).*metric.field;
        html += "<td class=\"text\">" + error_text(error);
        if (page.full && point.method != page.record.full_method) {
            const double full = page.full->against(truth).*metric.field;
            html += error <= full ? " <small class=\"good\">\u2713</small>"
                                  : fmt::format(" <small class=\"bad\">{}</small>", times_text(error / full));
        }
        html += "</td>";
    }
    return html;
}

std::string budget_row(const PageInput& page, const std::string& head, const MethodPoint& point, Truth truth,
                       const char* css_class = "") {
    const std::string setting = setting_text(page.record.methods[point.method], point.quality);
    return fmt::format(
        "<tr class=\"{}\"><td class=\"text\">{}</td><td class=\"text\"><b>{}</b>{}</td><td>{}</td>"
        "<td>{}</td>{}</tr>\n",
        css_class, head, escape_html(page.record.methods[point.method].name),
        escape_html(setting.empty() ? "" : ", " + setting), time_text(point.frame_ms),
        page.full ? times_text(page.full->frame_ms / point.frame_ms) : "", error_cells(page, point, truth));
}

std::string budget_table(const PageInput& page, Truth truth) {
    const std::vector<Budget> budgets = budgets_of(page, truth);
    std::string html = fmt::format("<p class=\"answer\">{}</p>\n", answer(page, budgets, truth));
    if (page.means.empty()) return html;
    html +=
        "<div class=\"scroll\"><table class=\"numbers budgets\"><thead><tr><th class=\"text\">budget a "
        "frame</th><th class=\"text\">use</th><th>time</th><th>times<br>as quick</th>";
    for (const PageMetric& metric : k_page_metrics)
        html += fmt::format("<th class=\"text\">{}</th>", metric.name);
    html += "</tr></thead><tbody>\n";
    for (const Budget& budget : budgets)
        html += budget_row(page,
                           fmt::format("{:g} ms <small class=\"soft\">{:.0f} Hz</small>", budget.budget_ms,
                                       1000.0 / budget.budget_ms),
                           budget.best, truth);
    // The quickest that is as good by all four, whatever it takes: what the bench is after.
    const MethodPoint* equal = nullptr;
    for (const MethodPoint& point : page.means)
        if (point.method != page.record.full_method && no_further(page, point, truth) &&
            (!equal || point.frame_ms < equal->frame_ms))
            equal = &point;
    const auto shown = point_at_default(page.record, page.means, page.default_method);
    const char* apart = "apart";
    if (equal) html += budget_row(page, "quickest as near as full", *equal, truth, std::exchange(apart, ""));
    if (shown && page.default_method != page.record.full_method)
        html += budget_row(page, "the program's default", *shown, truth, std::exchange(apart, ""));
    if (page.full) html += budget_row(page, "full geometry", *page.full, truth, std::exchange(apart, ""));
    return html + "</tbody></table></div>\n";
}

std::string figures_table(const AccuracyRecord& record) {
    if (record.figures.empty()) return {};
    std::string html =
        "<h2>What it is to reach</h2>\n<div class=\"scroll\"><table class=\"numbers\"><thead><tr><th "
        "class=\"text\">figure</th><th>measured</th><th>to reach</th><th "
        "class=\"text\"></th></tr></thead><tbody>\n";
    auto value_text = [](double value, const std::string& unit) {
        return std::isfinite(value) ? escape_html(fmt::format("{:.4g} {}", value, unit))
                                    : std::string("\u2013");
    };
    for (const Figure& figure : record.figures) {
        const bool good = holds(figure);
        html += fmt::format(
            "<tr><td class=\"text\">{}</td><td>{}</td><td>{}</td><td class=\"text\">{}</td></tr>\n",
            escape_html(figure.name), value_text(figure.value, figure.unit),
            figure.reach ? (figure.direction == Reach::at_least ? "at least " : "at most ") +
                               value_text(*figure.reach, figure.unit)
                         : "",
            !figure.reach ? ""
                          : fmt::format("<span class=\"badge {}\">{}</span>", good ? "good" : "bad",
                                        good ? "\u2713 holds" : "\u2717 not reached"));
    }
    return html + "</tbody></table></div>\n";
}

std::string choosers(const AccuracyRecord& record) {
    auto choice = [](const char* name, const std::string& value, const std::string& text, bool checked) {
        return fmt::format("<label><input type=\"radio\" name=\"{}\" value=\"{}\"{}>{}</label>", name, value,
                           checked ? " checked" : "", escape_html(text));
    };
    std::string html = "<div class=\"choose\"><div>compare with " +
                       choice("truth", "shadowed", "the reference", true) +
                       choice("truth", "unshadowed", "the reference without shadows", false) + "</div>";
    if (record.views.size() > 1) {
        html += "<div>view " + choice("view", "mean", "mean of all", true);
        for (size_t view = 0; view < record.views.size(); ++view)
            html += choice("view", std::to_string(view), record.views[view].name, false);
        html += "</div>";
    }
    return html + "</div>\n";
}

std::string methods_table(const PageInput& page) {
    const AccuracyRecord& record = page.record;
    double most_pop = 0.0, most_shimmer = 0.0;
    for (const AccuracyMethodRecord& method : record.methods) {
        most_pop = std::max(most_pop, method.pop_energy.value_or(0.0));
        most_shimmer = std::max(most_shimmer, method.shimmer.value_or(0.0));
    }
    auto cell = [](const std::optional<double>& value, double most) -> std::string {
        if (!value || !std::isfinite(*value)) return "<td data-key=\"\" class=\"text\">\u2013</td>";
        constexpr double k_bar_px = 90.0;
        const double width =
            most > 0.0 && std::isfinite(most) ? std::max(*value, 0.0) / most * k_bar_px : 0.0;
        return fmt::format(
            "<td data-key=\"{0}\" class=\"text\"><span class=\"bar\" "
            "style=\"width:{1:.1f}px\"></span>{0:.3g}</td>",
            *value, width);
    };
    std::string html =
        "<h2>The methods, and how they move</h2>\n<p class=\"soft\">Pop energy: how much of a picture "
        "changes at once because its level of detail does, motion apart (mean square of display light "
        "at each place's largest step). Shimmer: how much still plants flicker under a slow camera (RMS "
        "of display light from frame to frame). Both over a flight at the default setting; less is "
        "better.</p>\n<div class=\"scroll\"><table class=\"numbers\"><thead><tr>";
    for (const char* name : {"method", "what it does", "pop energy", "shimmer"})
        html += fmt::format("<th class=\"text\" scope=\"col\"><button>{}</button></th>", name);
    html += "</tr></thead><tbody>\n";
    for (size_t i = 0; i < record.methods.size(); ++i) {
        const AccuracyMethodRecord& method = record.methods[i];
        html += fmt::format("<tr><td class=\"text\">{} {}</td><td class=\"text\">{}</td>{}{}</tr>\n",
                            line_key(page.styles[i]), escape_html(method.name), escape_html(method.what),
                            cell(method.pop_energy, most_pop), cell(method.shimmer, most_shimmer));
    }
    return html + "</tbody></table></div>\n";
}

std::string sample_row(const PageInput& page, const MethodPoint& point, const std::string& view) {
    constexpr double k_mib = 1 << 20;
    const AccuracyMethodRecord& method = page.record.methods[point.method];
    std::string html = fmt::format(
        "<tr data-view=\"{}\"{}><td class=\"text\">{}</td><td data-key=\"{}\">{}</td><td "
        "data-key=\"{}\">{}</td>",
        view, view == "mean" ? "" : " hidden", escape_html(method.name),
        method.quality_name.empty() ? "" : number_text(point.quality, 6),
        escape_html(setting_text(method, point.quality)), number_text(point.frame_ms, 6),
        number_text(point.frame_ms, 2));
    for (double count : {point.triangles, point.lines, point.points})
        html += fmt::format("<td data-key=\"{:.0f}\">{}</td>", count, short_count(count));
    for (double bytes : {point.geometry_bytes, point.list_bytes})
        html += fmt::format("<td data-key=\"{:.0f}\">{:.1f}</td>", bytes, bytes / k_mib);
    for (const ErrorColumn& column : k_error_columns) {
        auto key = [&](Truth truth) {
            const double value = point.against(truth).*column.field;
            // Equal pictures have the greatest PSNR.
            return std::isfinite(value) ? fmt::format("{}", value) : "1e9";
        };
        html += fmt::format("<td data-shadowed=\"{}\" data-unshadowed=\"{}\">", key(Truth::shadowed),
                            key(Truth::unshadowed)) +
                of_both_truths("span",
                               [&](Truth truth) {
                                   const double value = point.against(truth).*column.field;
                                   return column.field != &FrameErrors::psnr_db ? error_text(value)
                                          : std::isfinite(value)                ? number_text(value, 1)
                                                                                : std::string("equal");
                               }) +
                "</td>";
    }
    return html + "</tr>\n";
}

std::string samples_table(const PageInput& page) {
    const AccuracyRecord& record = page.record;
    std::string html =
        "<h2>All figures</h2>\n<p class=\"soft\">Of the view chosen above; a click on a head sorts. "
        "Times are medians, counts are primitives drawn in a frame, geometry is what the method keeps "
        "in memory, lists are what it writes each frame. RMSE, coverage and colours are of display "
        "light, where 1 is the brightest the screen can show. Coverage and mean colour are compared in "
        "squares of 16 pixels, the biases over the whole picture; a positive coverage bias is too much "
        "plant.</p>\n<div class=\"scroll\"><table class=\"numbers samples\"><thead><tr>";
    for (const char* name : {"method", "setting", "time<br>ms", "triangles", "lines", "points",
                             "geometry<br>MiB", "lists<br>MiB", "RMSE", "PSNR<br>dB", "FLIP", "coverage",
                             "coverage<br>bias", "mean<br>colour", "colour<br>bias"})
        html += fmt::format("<th scope=\"col\"{}><button>{}</button></th>",
                            std::string_view(name) == "method" ? " class=\"text\"" : "", name);
    html += "</tr></thead><tbody>\n";
    for (const MethodPoint& point : page.means) html += sample_row(page, point, "mean");
    if (record.views.size() > 1)
        for (uint32_t view = 0; view < record.views.size(); ++view)
            for (const MethodPoint& point : view_points(record, view))
                html += sample_row(page, point, std::to_string(view));
    return html + "</tbody></table></div>\n";
}

std::string facts_table(const AccuracyRecord& record) {
    std::string html = "<table>\n";
    auto row = [&html](const char* name, const std::string& value) {
        if (!value.empty())
            html += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", name, escape_html(value));
    };
    row("device", record.device);
    row("driver", record.driver);
    row("machine", record.machine);
    row("date", record.date);
    row("picture", fmt::format("{} x {}", record.width, record.height));
    row("reference",
        fmt::format("ray traced, every triangle, {} samples a pixel, with shadows; and once lit as the "
                    "frames are, without",
                    record.reference_samples));
    row("scene",
        fmt::format("{}: {} plants, {} triangles", record.scene_name, short_count(double(record.plants)),
                    short_count(double(record.scene_triangles))));
    row("took", number_text(record.duration_s, 0) + " s, references apart");
    return html + "</table>\n";
}

}  // namespace

std::string accuracy_page(const AccuracyRecord& record) {
    const PageInput page(record);
    const std::string name = escape_html(record.scene_name);
    auto count = [](size_t number, const char* noun) {
        return fmt::format("{} {}{}", number, noun, number == 1 ? "" : "s");
    };
    std::string html = fmt::format(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
        "content=\"width=device-width,initial-scale=1\"><meta name=\"color-scheme\" content=\"light "
        "dark\"><title>Time against error: {0} - Coppice</title><style>{1}{2}</style></head>\n"
        "<body class=\"in-shadowed\"><main>\n<h1>{0}: which method at which budget</h1>\n",
        name, k_page_style, k_accuracy_style);
    html += fmt::format(
        "<p class=\"soft\">{} drew {} at {} x {} pixels on {}; each picture was compared with a "
        "ray-traced one of every triangle at {} samples a pixel. All errors are 0 for the reference "
        "itself; smaller is better.</p>\n",
        count(record.methods.size(), "method"), count(record.views.size(), "view"), record.width,
        record.height, escape_html(record.device), record.reference_samples);
    html += of_both_truths("div", [&](Truth truth) { return budget_table(page, truth); });
    html +=
        "<p class=\"soft\">Means over the views; best by FLIP. <span class=\"good\">\u2713</span>: no "
        "further from the reference than full geometry, every triangle at one sample a pixel; else how "
        "many times as far.</p>\n";
    html += figures_table(record);
    html += choosers(record);
    html += curves_section(page);
    html += resting_section(page);
    html += pictures_section(page);
    html += methods_table(page);
    html += samples_table(page);
    html += "<h2>Machine, settings</h2>\n" + facts_table(record);
    html += "<h2>Again</h2>\n<p><code>" + escape_html(record.command) + "</code></p>\n</main>\n<script>" +
            k_accuracy_script + "</script></body></html>\n";
    return html;
}

}  // namespace coppice
