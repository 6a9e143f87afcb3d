// Parts of the accuracy page that are too long for one file, and what they share.
#pragma once
#include <optional>
#include <string>
#include <vector>
#include "tools/accuracy/accuracy_summary.h"
#include "tools/accuracy/log_plot.h"

namespace coppice {

struct PageInput {
    explicit PageInput(const AccuracyRecord& record);

    const AccuracyRecord& record;
    std::vector<MethodPoint> means;
    std::vector<LineStyle> styles;  // a method each
    uint32_t default_method;
    std::optional<MethodPoint> full;  // mean of the full geometry at one sample a pixel
};

inline constexpr Truth k_truths[] = {Truth::shadowed, Truth::unshadowed};
inline const char* name_of(Truth truth) { return truth == Truth::shadowed ? "shadowed" : "unshadowed"; }

// The errors the issue is about, in the order they are shown.
struct PageMetric {
    const char *name, *meaning;
    double FrameErrors::*field;
};
inline constexpr PageMetric k_page_metrics[] = {
    {"FLIP", "how different it looks", &FrameErrors::flip},
    {"RMSE", "root mean square of the difference", &FrameErrors::rmse},
    {"coverage", "plants missing or too many", &FrameErrors::coverage},
    {"mean colour", "too light, too dark, tinted", &FrameErrors::mean_color}};

// A dash where a number is not finite.
std::string number_text(double value, int decimals);
std::string time_text(double ms);         // "12.3 ms"
std::string error_text(double value);     // three digits that count, up to five decimals
std::string times_text(double quotient);  // "41x" with the sign
std::string errors_line(const FrameErrors& errors);
// Name and setting.
std::string full_name(const AccuracyRecord& record, uint32_t method, double quality);
// Both, of which the page shows the one against the chosen reference.
template <class Text>
std::string of_both_truths(const char* tag, Text text) {
    std::string html;
    for (Truth truth : k_truths)
        html +=
            std::string("<") + tag + " class=\"" + name_of(truth) + "\">" + text(truth) + "</" + tag + ">";
    return html;
}

std::string curves_section(const PageInput& page);
std::string resting_section(const PageInput& page);   // empty where nothing rested
std::string pictures_section(const PageInput& page);  // a row a view

}  // namespace coppice
