// Text of the pages the program writes.
#pragma once
#include <cmath>
#include <cstddef>
#include <iterator>
#include <string>
#include <fmt/format.h>

namespace coppice {

// 1234567 -> "1.23 M". Three digits that count.
inline std::string short_count(double value) {
    static constexpr const char* k_units[] = {"", " k", " M", " G", " T"};
    size_t unit = 0;
    for (; std::abs(value) >= 999.5 && unit + 1 < std::size(k_units); ++unit) value /= 1000.0;
    return fmt::format("{:.3g}{}", value, k_units[unit]);
}

inline std::string escape_html(const std::string& text) {
    std::string escaped;
    for (char c : text) {
        switch (c) {
            case '&':
                escaped += "&amp;";
                break;
            case '<':
                escaped += "&lt;";
                break;
            case '>':
                escaped += "&gt;";
                break;
            case '"':
                escaped += "&quot;";
                break;
            default:
                escaped += c;
        }
    }
    return escaped;
}

}  // namespace coppice
