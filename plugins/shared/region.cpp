#include "plugins/shared/region.h"

#include <fmt/format.h>

namespace coppice {
namespace {

constexpr size_t k_point_limit = 100000;

double segment_distance(dvec2 p, dvec2 a, dvec2 b) {
    dvec2 along = b - a;
    double length2 = glm::dot(along, along);
    double t = length2 > 0.0 ? glm::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0.0;
    dvec2 away = p - (a + along * t);
    return std::sqrt(glm::dot(away, away));
}

double shape_distance(const RegionShape& shape, dvec2 p) {
    switch (shape.kind) {
        case RegionShape::Kind::circle:
            return glm::length(p - shape.center) - shape.radius_m;
        case RegionShape::Kind::rectangle: {
            dvec2 d = p - shape.center;
            dvec2 q(std::abs(glm::dot(d, shape.axis)), std::abs(-d.x * shape.axis.y + d.y * shape.axis.x));
            q -= shape.half_size;
            dvec2 out = glm::max(q, dvec2(0.0));
            return std::sqrt(glm::dot(out, out)) + std::min(std::max(q.x, q.y), 0.0);
        }
        case RegionShape::Kind::polygon: {
            double nearest = INFINITY;
            bool inside = false;
            for (size_t i = 0, j = shape.points.size() - 1; i < shape.points.size(); j = i++) {
                dvec2 a = shape.points[i], b = shape.points[j];
                nearest = std::min(nearest, segment_distance(p, a, b));
                if ((a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x)
                    inside = !inside;
            }
            return inside ? -nearest : nearest;
        }
        case RegionShape::Kind::corridor: {
            double nearest = INFINITY;
            for (size_t i = 0; i + 1 < shape.points.size(); ++i)
                nearest = std::min(nearest, segment_distance(p, shape.points[i], shape.points[i + 1]));
            return nearest - shape.radius_m;
        }
    }
    return INFINITY;
}

std::vector<dvec2> read_points(JsonDocument& document, const nlohmann::json* list, size_t least,
                               std::string place) {
    std::vector<dvec2> points;
    bool good = list && list->is_array() && list->size() >= least && list->size() <= k_point_limit;
    for (size_t i = 0; good && i < list->size(); ++i) {
        const auto& pair = (*list)[i];
        good = pair.is_array() && pair.size() == 2 && pair[0].is_number() && pair[1].is_number();
        if (!good) break;
        points.emplace_back(pair[0].get<double>(), pair[1].get<double>());
        good = std::abs(points.back().x) <= k_farthest_m && std::abs(points.back().y) <= k_farthest_m;
    }
    if (!good) {
        document.report(ErrorId::value_out_of_range, std::move(place),
                        list ? "found " + shown(*list) : "missing",
                        fmt::format("write {} to {} places [x, z] within 1e7 m", least, k_point_limit));
        points.assign(least, dvec2(0.0));
    }
    return points;
}

dvec2 read_place(JsonObject& object, const char* key) {
    auto xz = object.numbers(key, 2, -k_farthest_m, k_farthest_m);
    return {xz[0], xz[1]};
}

RegionShape read_shape(JsonObject object) {
    RegionShape shape;
    shape.kind = RegionShape::Kind(object.one_of({"circle", "rectangle", "polygon", "corridor"}));
    JsonDocument& document = object.document();
    if (!document.sound()) return shape;
    if (shape.kind == RegionShape::Kind::circle) {
        JsonObject circle = object.object("circle");
        shape.center = read_place(circle, "center");
        shape.radius_m = circle.number("radius_m", 0.01, k_farthest_m);
        circle.close();
    } else if (shape.kind == RegionShape::Kind::rectangle) {
        JsonObject rectangle = object.object("rectangle");
        shape.center = read_place(rectangle, "center");
        auto size = rectangle.numbers("size_m", 2, 0.01, 2.0 * k_farthest_m);
        shape.half_size = dvec2(size[0], size[1]) * 0.5;
        float turn = rectangle.real("turn_deg", -360.0f, 360.0f, 0.0f) * (k_pi / 180.0f);
        shape.axis = dvec2(portable_cos(turn), -portable_sin(turn));
        rectangle.close();
    } else if (shape.kind == RegionShape::Kind::polygon) {
        shape.points = read_points(document, object.find("polygon"), 3, object.place_of("polygon"));
    } else {
        JsonObject corridor = object.object("corridor");
        shape.points = read_points(document, corridor.find("points"), 2, corridor.place_of("points"));
        shape.radius_m = corridor.number("width_m", 0.01, k_farthest_m) * 0.5;
        corridor.close();
    }
    object.close();
    return shape;
}

}  // namespace

double Region::distance_m(dvec2 p) const {
    double nearest = INFINITY;
    for (const RegionShape& shape : shapes) nearest = std::min(nearest, shape_distance(shape, p));
    return nearest;
}

std::pair<dvec2, dvec2> Region::bounds() const {
    dvec2 low(INFINITY), high(-INFINITY);
    for (const RegionShape& shape : shapes) {
        dvec2 margin(shape.radius_m);
        if (shape.kind == RegionShape::Kind::rectangle)
            margin = dvec2(
                std::abs(shape.axis.x) * shape.half_size.x + std::abs(shape.axis.y) * shape.half_size.y,
                std::abs(shape.axis.y) * shape.half_size.x + std::abs(shape.axis.x) * shape.half_size.y);
        auto include = [&](dvec2 p) {
            low = glm::min(low, p - margin);
            high = glm::max(high, p + margin);
        };
        if (shape.points.empty()) include(shape.center);
        for (dvec2 p : shape.points) include(p);
    }
    return {low, high};
}

Region read_region(JsonDocument& document, const nlohmann::json& value, const std::string& place,
                   const NamedRegions& named) {
    Region region;
    if (value.is_array()) {
        for (size_t i = 0; i < value.size() && document.sound(); ++i) {
            if (value[i].is_array()) {
                document.report(ErrorId::syntax, place, "a list inside a list", "write shapes and names");
                break;
            }
            Region part = read_region(document, value[i], fmt::format("{}[{}]", place, i), named);
            region.shapes.insert(region.shapes.end(), part.shapes.begin(), part.shapes.end());
        }
        if (value.empty())
            document.report(ErrorId::syntax, place, "an empty list", "write at least one shape");
    } else if (value.is_string()) {
        const auto& name = value.get_ref<const std::string&>();
        if (auto found = named.find(name); found != named.end()) return found->second;
        std::vector<std::string> names;
        for (const auto& [known, ignored] : named) names.push_back(known);
        document.report(ErrorId::name_unknown, place, fmt::format("unknown region '{}'", name),
                        known_names(name, names));
    } else {
        region.shapes.push_back(read_shape(JsonObject(document, value, place)));
    }
    return region;
}

}  // namespace coppice
