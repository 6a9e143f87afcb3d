// One measured figure, with what it is to reach: the entries of every benchmark's list `figures` (DESIGN
// section 8).
#pragma once
#include <optional>
#include <string>
#include <nlohmann/json.hpp>

namespace coppice {

enum class Reach { at_least, at_most };

struct Figure {
    std::string name;
    double value;
    std::string unit;
    std::optional<double> reach;  // empty: measured, nothing asked
    Reach direction = Reach::at_least;
};

inline bool holds(const Figure& figure) {
    if (!figure.reach) return true;
    return figure.direction == Reach::at_least ? figure.value >= *figure.reach
                                               : figure.value <= *figure.reach;
}

// {name, value, unit, reach, holds}; the last two are null where nothing is asked.
inline nlohmann::json to_json(const Figure& figure) {
    nlohmann::json json{{"name", figure.name},
                        {"value", figure.value},
                        {"unit", figure.unit},
                        {"reach", nullptr},
                        {"holds", nullptr}};
    if (figure.reach) {
        json["reach"] = *figure.reach;
        json["holds"] = holds(figure);
    }
    return json;
}

}  // namespace coppice
