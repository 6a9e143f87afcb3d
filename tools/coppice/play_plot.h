// A stacked area plot as inline SVG: what adds up to a frame, over the frames.
#pragma once
#include <string>
#include <vector>

namespace coppice {

struct PlotSeries {
    std::string name;
    std::string color;           // as CSS takes it
    std::vector<double> values;  // as many as x
};

struct PlotSettings {
    std::string label;   // read out by screen readers
    std::string x_name;  // "time, s"
    std::string y_name;  // "ms"
};

// Series are stacked from the bottom in their order; at least one x. More than 600 are averaged in groups.
// Single peaks over twice the 99th percentile are cut off and said, so that they don't flatten everything
// else.
std::string stacked_plot(const std::vector<double>& x, const std::vector<PlotSeries>& series,
                         const PlotSettings& settings);

}  // namespace coppice
