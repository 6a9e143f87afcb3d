#include "tools/accuracy/log_plot.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <fmt/format.h>
#include "tools/coppice/page_text.h"

namespace coppice {
namespace {

constexpr const char* k_markers[] = {
    "M-4,0a4,4 0 1 0 8,0a4,4 0 1 0 -8,0",                           // disk
    "M-3.7,-3.7H3.7V3.7H-3.7Z",                                     // square
    "M0,-4.8L4.5,3.4H-4.5Z",                                        // triangle
    "M0,-5L5,0L0,5L-5,0Z",                                          // diamond
    "M0,4.8L4.5,-3.4H-4.5Z",                                        // triangle, downwards
    "M-1.6,-4.6H1.6V-1.6H4.6V1.6H1.6V4.6H-1.6V1.6H-4.6V-1.6H-1.6Z"  // cross
};
constexpr const char* k_dashes[] = {"", "6 3", "2 3"};

// Markers change from line to line; every full round of them is dashed otherwise, and every other one hollow.
std::string line_attributes(const LineStyle& style) {
    const char* dash = k_dashes[style.pattern / std::size(k_markers) % std::size(k_dashes)];
    return fmt::format("fill=\"none\" stroke=\"currentColor\" stroke-width=\"{}\"{}",
                       style.strong ? 3.2 : 1.6, *dash ? fmt::format(" stroke-dasharray=\"{}\"", dash) : "");
}
const char* marker_attributes(const LineStyle& style) {
    return style.pattern / std::size(k_markers) % 2 == 1
               ? "fill=\"var(--card)\" stroke=\"currentColor\" stroke-width=\"1.8\""
               : "fill=\"currentColor\" stroke=\"var(--card)\" stroke-width=\"0.8\"";
}
std::string marker(const LineStyle& style, double x, double y, const std::string& title) {
    return fmt::format("<path d=\"{}\" transform=\"translate({:.1f},{:.1f}){}\"><title>{}</title></path>",
                       k_markers[style.pattern % std::size(k_markers)], x, y,
                       style.strong ? " scale(1.3)" : "", escape_html(title));
}

double share_of(double value, const LogRange& range) {
    if (!(value > range.low)) return 0.0;
    return std::min(std::log(value / range.low) / std::log(range.high / range.low), 1.0);
}

// Steps of a decade times powers of ten, those in range.
std::vector<double> ticks_of(const LogRange& range, std::span<const double> steps) {
    std::vector<double> ticks;
    // A tick just outside by rounding is meant.
    const double low = range.low * (1.0 - 1e-9), high = range.high * (1.0 + 1e-9);
    for (int power = int(std::floor(std::log10(range.low))); power <= std::ceil(std::log10(range.high));
         ++power)
        for (double step : steps) {
            // Dividing by an exact power keeps 0.2 as it is written.
            const double value = power < 0 ? step / std::pow(10.0, -power) : step * std::pow(10.0, power);
            if (value >= low && value <= high) ticks.push_back(value);
        }
    return ticks;
}

}  // namespace

LogRange log_range(std::span<const double> values) {
    constexpr double k_margin = 1.12;
    LogRange range{0.0, 0.0};
    for (double value : values) {
        if (!(value > 0.0) || !std::isfinite(value)) continue;
        range.low = range.low > 0.0 ? std::min(range.low, value) : value;
        range.high = std::max(range.high, value);
    }
    if (!(range.low > 0.0)) return {0.1, 1.0};
    return {range.low / k_margin, range.high * k_margin};
}

std::vector<double> log_ticks(const LogRange& range) {
    constexpr size_t k_most = 12, k_fewest = 3;
    static constexpr double k_decade[] = {1}, k_usual[] = {1, 2, 5}, k_fine[] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    std::vector<double> ticks = ticks_of(range, k_usual);
    if (ticks.size() > k_most) return ticks_of(range, k_decade);
    if (ticks.size() < k_fewest) ticks = ticks_of(range, k_fine);
    // Over a small part of a decade logarithms are nearly straight, and so may the steps be: of at most a
    // fifth of the range's power of ten, which gives three.
    const double power = std::pow(10.0, std::floor(std::log10(range.high - range.low)));
    for (double parts : {1.0, 2.0, 5.0}) {
        if (ticks.size() >= k_fewest) break;
        ticks.clear();
        for (double n = std::ceil(range.low / power * parts); n * power / parts <= range.high; ++n)
            ticks.push_back(n * power / parts);
    }
    return ticks;
}

double LogPlotFrame::at_x(double value, const LogRange& range) const {
    return left + share_of(value, range) * (width - left - right);
}
double LogPlotFrame::at_y(double value, const LogRange& range) const {
    return height - bottom - share_of(value, range) * (height - top - bottom);
}

std::string line_key(const LineStyle& style) {
    return fmt::format(
        "<svg class=\"key\" viewBox=\"0 0 34 14\" aria-hidden=\"true\" style=\"color:{}\">"
        "<path d=\"M1,7H33\" {}/><g {}>{}</g></svg>",
        style.color, line_attributes(style), marker_attributes(style), marker(style, 17, 7, ""));
}

std::string log_plot(const std::vector<LogPlotSeries>& series, const LogPlotSettings& settings) {
    const LogPlotFrame frame;
    const double right = frame.width - frame.right, bottom = frame.height - frame.bottom;
    auto at_x = [&](double value) { return frame.at_x(value, settings.x); };
    auto at_y = [&](double value) { return frame.at_y(value, settings.y); };

    std::string svg = fmt::format(
        "<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\" xmlns=\"http://www.w3.org/2000/svg\">\n",
        frame.width, frame.height, escape_html(settings.label));
    const bool with_reference =
        settings.reference && std::isfinite(settings.reference->x) && std::isfinite(settings.reference->y);
    const double reference_x =
        with_reference && !settings.reference_is_level ? at_x(settings.reference->x) : right;
    const double reference_y = with_reference ? at_y(settings.reference->y) : 0.0;
    if (with_reference)
        svg += fmt::format(
            "<rect class=\"better\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>\n",
            frame.left, reference_y, reference_x - frame.left, bottom - reference_y);
    for (double tick : log_ticks(settings.x))
        svg += fmt::format(
            "<path class=\"grid\" d=\"M{0:.1f},{1:.1f}V{2:.1f}\"/><text x=\"{0:.1f}\" y=\"{3:.1f}\" "
            "text-anchor=\"middle\">{4}</text>\n",
            at_x(tick), frame.top, bottom, bottom + 17, short_count(tick));
    for (double tick : log_ticks(settings.y))
        svg += fmt::format(
            "<path class=\"grid\" d=\"M{0:.1f},{1:.1f}H{2:.1f}\"/><text x=\"{3:.1f}\" y=\"{4:.1f}\" "
            "text-anchor=\"end\">{5}</text>\n",
            frame.left, at_y(tick), right, frame.left - 8, at_y(tick) + 4, short_count(tick));
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
                       (frame.left + right) / 2, frame.height - 6, escape_html(settings.x_name));
    if (with_reference) {
        svg += fmt::format("<path class=\"reference\" d=\"M{:.1f},{:.1f}H{:.1f}\"/>", frame.left, reference_y,
                           right);
        if (!settings.reference_is_level)
            svg += fmt::format("<path class=\"reference\" d=\"M{:.1f},{:.1f}V{:.1f}\"/>", reference_x,
                               frame.top, bottom);
    }
    for (const LogPlotSeries& one : series) {
        std::string line, markers;
        for (const LogPlotPoint& point : one.points) {
            if (!std::isfinite(point.x) || !std::isfinite(point.y)) continue;
            const double x = at_x(point.x), y = at_y(point.y);
            line += fmt::format("{}{:.1f},{:.1f}", line.empty() ? "M" : "L", x, y);
            markers += marker(one.style, x, y, point.title) + "\n";
        }
        if (line.empty()) continue;
        svg +=
            fmt::format("<g class=\"series {}\" style=\"color:{}\"><path d=\"{}\" {}/><g {}>\n{}</g></g>\n",
                        one.style.css_class, one.style.color, line, line_attributes(one.style),
                        marker_attributes(one.style), markers);
    }
    if (with_reference) {
        // Over the lines, above its own where there is room; left of the time, as lines beyond it are few.
        const bool room = reference_x - frame.left > 170;
        svg += fmt::format("<text class=\"halo\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n",
                           room ? reference_x - 7 : reference_x + 7,
                           reference_y - frame.top > 18 ? reference_y - 6 : reference_y + 15,
                           room ? "end" : "start", escape_html(settings.reference_name));
    }
    return svg + "</svg>\n";
}

}  // namespace coppice
