#include "editor/window/tools.h"

#include <algorithm>
#include <fmt/format.h>
#include "editor/commands/rule_names.h"
#include "runtime/core/hash.h"

namespace coppice {
namespace {

constexpr double k_pick_radius_m = 3.0;
constexpr double k_step_share = 0.25;  // of the radius: a stroke's pieces are that long at least

}  // namespace

const char* name_of(Tool tool) {
    switch (tool) {
        case Tool::brush:
            return "Brush";
        case Tool::polygon:
            return "Polygon";
        case Tool::place:
            return "Place";
        case Tool::select:
            return "Select";
    }
    return "";
}

void Tools::choose(const std::string& population) {
    brush.kinds = {population};
    if (population == active) return;
    densities_[active] = brush.density_per_m2;
    active = population;
    if (const auto before = densities_.find(population); before != densities_.end())
        brush.density_per_m2 = before->second;
    else if (const double width_m = crown_width_m ? crown_width_m(population) : 0.0; width_m > 0.0)
        brush.density_per_m2 = float(std::clamp(1.0 / (width_m * width_m), 0.001, 4.0));
}

nlohmann::json Tools::rule() const {
    nlohmann::json shares = nlohmann::json::object();
    for (const std::string& kind : brush.kinds) shares[kind] = 1;
    if (shares.empty() && !active.empty()) shares[active] = 1;
    nlohmann::json rule = {{"plants", shares},
                           {"density_per_m2", brush.density_per_m2},
                           {"scale", {brush.scale_low, std::max(brush.scale_low, brush.scale_high)}},
                           {"tilt_deg", brush.tilt_deg},
                           {"align_to_ground", brush.align_to_ground},
                           {"seed", hash_combine(stroke_number_, 1)}};
    if (brush.spacing_m > 0.0f) rule["spacing_m"] = brush.spacing_m;
    if (brush.limit_slope) rule["slope_max_deg"] = brush.slope_max_deg;
    if (brush.limit_altitude)
        rule["altitude_m"] = {brush.altitude_low_m, std::max(brush.altitude_low_m, brush.altitude_high_m)};
    if (!brush.exclude.empty()) rule["exclude"] = brush.exclude;
    if (brush.map[0]) {
        nlohmann::json& map = rule["density_map"] = {{"picture", brush.map}};
        if (brush.map_side_m > 0.0f) {
            map["center"] = {0, 0};
            map["size_m"] = {brush.map_side_m, brush.map_side_m};
        }
        if (brush.map_inverted) map["black"] = 1, map["white"] = 0;
    }
    if (!brush.distance_from.empty() && (brush.distance_least_m > 0.0f || brush.distance_most_m > 0.0f)) {
        nlohmann::json& distance = rule["distance"] = {{"from", brush.distance_from}};
        if (brush.distance_least_m > 0.0f) distance["least_m"] = brush.distance_least_m;
        if (brush.distance_most_m > 0.0f)
            distance["most_m"] = std::max(brush.distance_least_m, brush.distance_most_m);
    }
    return rule;
}

void Tools::perform(Session& session, const char* command, const nlohmann::json& arguments) {
    stop(session);
    auto edit = session.perform(command, arguments);
    message = edit ? "" : to_string(edit.error());
}

void Tools::act_on_selection(Session& session, const char* command, nlohmann::json arguments) {
    if (!selected_) return;
    const dvec2 at = ground_place(*selected_);
    arguments["near"] = {at.x, at.y};
    arguments["radius_m"] = 0.01;
    arguments["populations"] = {session.document().kinds()[selected_->kind]};
    stop(session);
    auto edit = session.perform(command, arguments);
    message = edit ? "" : to_string(edit.error());
    if (!edit || !*edit) return;
    const FileEdit& change = (*edit)->files[0];
    selected_ = change.added.empty() ? std::nullopt : std::optional(change.added[0]);
}

void Tools::pick(Session& session, dvec2 at) {
    selected_.reset();
    double nearest_m = k_pick_radius_m;
    session.document().root().plants.each_in(at - k_pick_radius_m, at + k_pick_radius_m,
                                             [&](const PlacedPlant& plant) {
                                                 const double away_m = glm::length(ground_place(plant) - at);
                                                 if (away_m > nearest_m) return;
                                                 nearest_m = away_m;
                                                 selected_ = plant;
                                             });
}

std::vector<TileHandle> tile_handles(const Session& session) {
    std::vector<TileHandle> handles;
    const auto& json = session.document().root().text->json;
    const auto references = json.find("references");
    if (references == json.end() || !references->is_array()) return handles;
    for (const auto& reference : *references) {
        TileHandle handle{"", dvec2(0.0), 0.0, 1.0};
        if (reference.is_object()) {
            if (const auto scene = reference.find("scene"); scene != reference.end() && scene->is_string())
                handle.scene = scene->get<std::string>();
            const auto at = reference.find("at");
            if (at != reference.end() && at->is_array() && at->size() >= 2 && at->front().is_number() && at->back().is_number())
                handle.at = {at->front().get<double>(), at->back().get<double>()};
            for (const auto& [key, value] : {std::pair{"turn_deg", &handle.turn_deg}, {"scale", &handle.scale}})
                if (const auto said = reference.find(key); said != reference.end() && said->is_number())
                    *value = said->get<double>();
        }
        handles.push_back(std::move(handle));
    }
    return handles;
}

// Tiles go before plants: they are few, and stand among them.
void Tools::pick_tile(const Session& session, dvec2 at, double handle_m) {
    tile_.reset();
    const std::vector<TileHandle> handles = tile_handles(session);
    double nearest_m = handle_m;
    for (size_t i = 0; i < handles.size(); ++i)
        if (const double away_m = glm::length(handles[i].at - at); away_m < nearest_m) {
            nearest_m = away_m;
            select_tile(i);
        }
}

void Tools::select_tile(size_t index) {
    selected_.reset();
    tile_ = index;
}

void Tools::act_on_tile(Session& session, const char* command, nlohmann::json arguments) {
    if (!tile_) return;
    arguments["index"] = *tile_;
    const bool removes = std::string_view(command) == "remove_tile";
    perform(session, command, arguments);
    if (removes && message.empty()) tile_.reset();
}

void Tools::begin_stroke(Session& session, const Gesture& gesture) {
    message.clear();
    erasing_ = gesture.shift || gesture.control;
    erased_kinds_.clear();
    points_.clear();
    stroke_plants_ = 0;
    ++stroke_number_;
    stroke_kind_ = !erasing_ && brush.kinds.size() == 1 ? *brush.kinds.begin() : "plants";
    stroke_.reset();
    if (erasing_) {
        if (gesture.control && !gesture.shift) {
            if (active.empty()) return;
            stroke_kind_ = active;
            erased_kinds_ = {session.changing_document().kind_of(active)};
        }
    } else {
        const CommandContext context = session.context();
        EcoFile& root = context.document.root();
        auto names = rule_names_of(context, {context.document.root_path(), &root, session.terrain()});
        auto text = JsonDocument::parse(nlohmann::json{{"scatter", rule()}}.dump(), "");
        if (names && text) {
            JsonObject arguments(*text, text->root(), "");
            const Region under_brush{{RegionShape{}}};
            BrushRule read = read_brush_rule(arguments, *names, session.terrain(), &under_brush);
            if (text->sound())
                stroke_.emplace(std::move(read), double(brush.radius_m));
            else
                message = to_string(text->status().error());
        } else {
            message = to_string(names ? text.error() : names.error());
        }
        if (root.plants_lost) {
            message = root.placed_path + " could not be read: nothing is placed beside it";
            stroke_.reset();
        }
        if (!stroke_) return;
    }
    dragging_ = true;
    if (gesture.ground) extend_stroke(session, {gesture.ground->x, gesture.ground->z});
}

void Tools::extend_stroke(Session& session, dvec2 to) {
    const double radius_m = double(brush.radius_m);
    if (!points_.empty() && glm::length(to - points_.back()) < k_step_share * radius_m) return;
    Target target{session.document().root_path(), &session.changing_document().root(), session.terrain()};
    std::vector<PlacedPlant> removed, added;
    if (erasing_) {
        std::vector<dvec2> piece;
        if (!points_.empty()) piece.push_back(points_.back());
        piece.push_back(to);
        removed = plants_under(target.file->plants, piece, radius_m, erased_kinds_, 1.0, 0);
    } else {
        auto more = stroke_->extend(to, target.file->plants);
        if (!more) {
            message = to_string(more.error());
            return;
        }
        added = std::move(*more);
    }
    points_.push_back(to);
    stroke_plants_ += removed.size() + added.size();
    session.extend(edit_of(target, std::move(removed), std::move(added)));
}

void Tools::stop(Session& session) {
    if (!dragging_) return;
    dragging_ = false;
    stroke_.reset();
    if (tool == Tool::brush) {
        session.finish(fmt::format("{} {} {}", erasing_ ? "erase" : "paint", stroke_plants_, stroke_kind_));
    } else if (tool == Tool::select && selected_ && glm::length(drag_to_ - drag_from_) > 0.05) {
        const dvec2 by = drag_to_ - drag_from_;
        act_on_selection(session, "move", {{"by", {by.x, by.y}}});
    } else if (tool == Tool::select && tile_ && glm::length(drag_to_ - drag_from_) > 0.05) {
        const std::vector<TileHandle> handles = tile_handles(session);
        if (*tile_ >= handles.size()) return;
        const dvec2 to = handles[*tile_].at + drag_to_ - drag_from_;
        act_on_tile(session, "move_tile", {{"at", {to.x, to.y}}});
    }
}

void Tools::handle(Session& session, const Gesture& gesture) {
    const std::optional<dvec2> at =
        gesture.ground ? std::optional(dvec2(gesture.ground->x, gesture.ground->z)) : std::nullopt;
    if (gesture.pressed && gesture.alt && at) {
        // What stands there becomes what is painted.
        pick(session, *at);
        if (selected_) choose(session.document().kinds()[selected_->kind]);
        return;
    }
    switch (tool) {
        case Tool::brush:
            if (gesture.pressed) begin_stroke(session, gesture);
            if (dragging_ && gesture.held && at) extend_stroke(session, *at);
            break;
        case Tool::polygon:
            if (gesture.pressed && at) polygon_.push_back(*at);
            if (gesture.cancelled) polygon_.clear();
            if (gesture.confirmed && polygon_.size() >= 3) {
                nlohmann::json points = nlohmann::json::array();
                for (const dvec2& point : polygon_) points.push_back({point.x, point.y});
                ++stroke_number_;
                polygon_.clear();
                perform(session, "fill", {{"polygon", points}, {"scatter", rule()}});
            }
            break;
        case Tool::place:
            if (gesture.pressed && at) {
                perform(session, "place", {{"population", active}, {"at", {at->x, at->y}}});
                if (message.empty()) pick(session, *at);
            }
            break;
        case Tool::select:
            if (gesture.pressed && at) {
                pick_tile(session, *at, gesture.handle_m);
                if (!tile_) pick(session, *at);
                drag_from_ = drag_to_ = *at;
                dragging_ = selected_.has_value() || tile_.has_value();
            }
            if (dragging_ && gesture.held && at) drag_to_ = *at;
            break;
    }
    if (gesture.released) stop(session);
}

}  // namespace coppice
