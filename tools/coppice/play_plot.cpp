#include "tools/coppice/play_plot.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include "tools/coppice/page_text.h"
#include "tools/coppice/statistics.h"

namespace coppice {
namespace {

constexpr size_t k_column_limit = 600;
constexpr double k_width = 960, k_height = 300, k_left = 64, k_right = 12, k_top = 14, k_bottom = 42;

// 1, 2 or 5 times a power of ten, so that about `ticks` of them fit into `range`.
double tick_step(double range, int ticks) {
    double rough = range / ticks;
    if (!(rough > 0.0) || !std::isfinite(rough)) return 1.0;
    double power = std::pow(10.0, std::floor(std::log10(rough)));
    for (double factor : {1.0, 2.0, 5.0})
        if (power * factor >= rough) return power * factor;
    return power * 10.0;
}

std::vector<double> average_groups(const std::vector<double>& values, size_t group) {
    std::vector<double> means;
    for (size_t first = 0; first < values.size(); first += group) {
        size_t last = std::min(first + group, values.size());
        double sum = 0.0;
        for (size_t i = first; i < last; ++i) sum += values[i];
        means.push_back(sum / double(last - first));
    }
    return means;
}

}  // namespace

std::string stacked_plot(const std::vector<double>& all_x, const std::vector<PlotSeries>& series,
                         const PlotSettings& settings) {
    const size_t group = (all_x.size() + k_column_limit - 1) / k_column_limit;
    const std::vector<double> x = average_groups(all_x, std::max<size_t>(group, 1));
    // tops[s][i]: the sum of series 0 to s in column i.
    std::vector<std::vector<double>> tops;
    for (const PlotSeries& one : series) {
        std::vector<double> values = average_groups(one.values, std::max<size_t>(group, 1));
        values.resize(x.size(), 0.0);
        if (!tops.empty())
            for (size_t i = 0; i < x.size(); ++i) values[i] += tops.back()[i];
        tops.push_back(std::move(values));
    }
    const std::vector<double>& total = tops.back();
    const double highest = *std::max_element(total.begin(), total.end());
    const double usual = quantile(total, 0.99);
    const bool cut = highest > 2.0 * usual && usual > 0.0;
    double y_max = cut ? 1.3 * usual : 1.06 * highest;
    if (!(y_max > 0.0)) y_max = 1.0;
    const double x_min = x.front(), x_range = std::max(x.back() - x.front(), 1e-9);
    auto at_x = [&](double v) { return k_left + (v - x_min) / x_range * (k_width - k_left - k_right); };
    auto at_y = [&](double v) {
        return k_height - k_bottom - std::min(v / y_max, 1.0) * (k_height - k_top - k_bottom);
    };

    std::string svg = fmt::format(
        "<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\" xmlns=\"http://www.w3.org/2000/svg\">\n",
        k_width, k_height, escape_html(settings.label));
    const double y_step = tick_step(y_max, 5);
    for (int tick = 0; double(tick) * y_step <= y_max; ++tick) {
        double value = double(tick) * y_step;
        svg += fmt::format(
            "<line class=\"grid\" x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/>"
            "<text x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\">{5}</text>\n",
            k_left, k_width - k_right, at_y(value), k_left - 8, at_y(value) + 4, short_count(value));
    }
    for (size_t s = 0; s < series.size(); ++s) {
        svg += fmt::format("<path fill=\"{}\" d=\"M", series[s].color);
        for (size_t i = 0; i < x.size(); ++i)
            svg += fmt::format("{:.1f},{:.1f} ", at_x(x[i]), at_y(tops[s][i]));
        for (size_t i = x.size(); i-- > 0;)
            svg += fmt::format("L{:.1f},{:.1f} ", at_x(x[i]), at_y(s == 0 ? 0.0 : tops[s - 1][i]));
        svg += fmt::format("Z\"><title>{}</title></path>\n", escape_html(series[s].name));
    }
    const double x_step = tick_step(x_range, 10);
    for (int tick = 0; x_min + double(tick) * x_step <= x_min + x_range * 1.0001; ++tick) {
        double value = x_min + double(tick) * x_step;
        svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{:g}</text>\n", at_x(value),
                           k_height - k_bottom + 17, std::round(value * 1e6) / 1e6);
    }
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                       (k_left + k_width) / 2, k_height - 6, escape_html(settings.x_name));
    svg +=
        fmt::format("<text transform=\"translate(14,{:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                    (k_top + k_height - k_bottom) / 2, escape_html(settings.y_name));
    if (cut)
        svg += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">peaks up to {} are cut off</text>\n",
                           k_width - k_right, k_top - 2, short_count(highest));
    svg += "</svg>\n<p class=\"legend\">";
    for (size_t s = series.size(); s-- > 0;)
        svg += fmt::format("<span><i style=\"background:{}\"></i>{}</span>", series[s].color,
                           escape_html(series[s].name));
    return svg + "</p>\n";
}

}  // namespace coppice
