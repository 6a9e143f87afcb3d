// Lines over two logarithmic axes as inline SVG: what falls by a factor looks the same wherever it does.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace coppice {

struct LogRange {
    double low, high;  // 0 < low < high
};
// All that is positive and finite, with a margin; [0.1, 1] where nothing is.
LogRange log_range(std::span<const double> values);
// Rising, all in range: 1, 2 and 5 times powers of ten; powers alone where those are too many, finer steps
// where they are fewer than three.
std::vector<double> log_ticks(const LogRange& range);

// Colours alone don't tell twelve lines apart, nor all readers: each line has a marker and a dash too.
struct LineStyle {
    std::string css_class;  // of the group, to switch it
    std::string color;      // as CSS takes it
    uint32_t pattern;       // of marker and dash; equal ones look the same
    bool strong = false;    // drawn thicker
};
// The line with its marker, for a legend.
std::string line_key(const LineStyle& style);

struct LogPlotPoint {
    double x, y;        // what an axis does not reach, zero among it, lies on its end; not finite: left out
    std::string title;  // shown where the mouse rests
};
struct LogPlotSeries {
    LineStyle style;
    std::vector<LogPlotPoint> points;  // joined in this order
};
struct LogPlotSettings {
    std::string label;  // read out by screen readers
    std::string x_name;
    LogRange x, y;
    std::optional<LogPlotPoint> reference;  // lines through it; what is better than it in both is shaded
    bool reference_is_level = false;        // its y counts only
    std::string reference_name;
};

// Size of a plot in its own units, and where a value lies.
struct LogPlotFrame {
    double width = 560, height = 340, left = 58, right = 14, top = 12, bottom = 44;
    double at_x(double value, const LogRange& range) const;
    double at_y(double value, const LogRange& range) const;
};

std::string log_plot(const std::vector<LogPlotSeries>& series, const LogPlotSettings& settings);

}  // namespace coppice
