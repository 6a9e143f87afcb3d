#include "tools/accuracy/accuracy_page_parts.h"

#include <cmath>
#include <fmt/format.h>
#include "tools/coppice/page_text.h"

namespace coppice {

PageInput::PageInput(const AccuracyRecord& from)
    : record(from), means(mean_points(from)), default_method(coppice::default_method(from)) {
    uint32_t pattern = 0;
    for (uint32_t i = 0; i < record.methods.size(); ++i) {
        const bool is_full = i == record.full_method;
        styles.push_back({fmt::format("m{}", i),
                          is_full ? "var(--ink)" : fmt::format("var(--c{})", pattern % 6),
                          is_full ? 3u : pattern, i == default_method});
        // Six colours by six markers: the next round pairs them otherwise.
        if (!is_full) ++pattern;
    }
    full = point_at_default(record, means, record.full_method);
}

std::string number_text(double value, int decimals) {
    return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "\u2013";
}

std::string time_text(double ms) { return number_text(ms, ms < 10.0 ? 2 : ms < 100.0 ? 1 : 0) + "\u202fms"; }

std::string error_text(double value) {
    const double size = std::abs(value);
    return number_text(value, size >= 0.1 || size == 0.0 ? 3 : size >= 0.01 ? 4 : 5);
}

std::string times_text(double quotient) {
    return number_text(quotient, quotient < 1.995 ? 2 : quotient < 9.95 ? 1 : 0) + "\u202f\u00d7";
}

std::string errors_line(const FrameErrors& errors) {
    std::string line;
    for (const PageMetric& metric : k_page_metrics)
        line +=
            fmt::format("{}{} {}", line.empty() ? "" : ", ", metric.name, error_text(errors.*metric.field));
    return line;
}

std::string full_name(const AccuracyRecord& record, uint32_t method, double quality) {
    const std::string setting = setting_text(record.methods[method], quality);
    return record.methods[method].name + (setting.empty() ? "" : ", " + setting);
}

}  // namespace coppice
