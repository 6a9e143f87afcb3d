// What the mouse does in the view: brush, polygon, single plants. Turns gestures into commands of a session.
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <set>
#include "editor/commands/brush.h"
#include "editor/session/session.h"

namespace coppice {

enum class Tool { brush, polygon, place, select };
const char* name_of(Tool tool);

// How the panels are set.
struct BrushSettings {
    float radius_m = 6.0f, density_per_m2 = 0.3f, spacing_m = 0.0f;
    float scale_low = 0.8f, scale_high = 1.2f, tilt_deg = 2.0f, align_to_ground = 0.0f;
    bool limit_slope = false, limit_altitude = false;
    float slope_max_deg = 35.0f, altitude_low_m = 0.0f, altitude_high_m = 100.0f;
    std::string exclude;          // a region of the scene
    char map[256] = "";           // a picture, as seen from the scene's folder
    float map_side_m = 0.0f;      // of a square about the origin; 0: all the terrain
    bool map_inverted = false;
    std::string distance_from;  // a population
    float distance_least_m = 0.0f, distance_most_m = 0.0f;  // 0: any
    std::set<std::string> kinds;  // that are painted, in equal shares
};

// One frame's gesture.
struct Gesture {
    std::optional<dvec3> ground;                           // under the cursor
    double handle_m = 0.5;                                 // how far around it a tile's handle is taken, on the ground
    bool pressed = false, held = false, released = false;  // the left button, in the view
    bool shift = false, control = false, alt = false;
    bool confirmed = false, cancelled = false;  // Enter or right click; Escape
};

// Where the root's tiles stand, by their number; of those that do not say so, at the origin.
struct TileHandle {
    std::string scene;
    dvec2 at;
    double turn_deg, scale;
};
std::vector<TileHandle> tile_handles(const Session& session);

class Tools {
  public:
    Tool tool = Tool::brush;
    BrushSettings brush;
    std::string active;  // population: placed, painted where none is chosen, erased with Ctrl
    std::function<double(const std::string& kind)> crown_width_m;  // 0: not known
    std::string message;                                           // what went wrong last; empty: nothing

    // Makes the population the active one and the one that is painted, at the density it had last: at first its crowns touch.
    void choose(const std::string& population);
    void handle(Session& session, const Gesture& gesture);
    // Also when the tool changes or the window loses the mouse: a stroke ends where it is.
    void stop(Session& session);
    // What the selected plant, or tile, becomes.
    void act_on_selection(Session& session, const char* command, nlohmann::json arguments);
    void perform(Session& session, const char* command, const nlohmann::json& arguments);
    nlohmann::json rule() const;  // "scatter", without the region

    const std::vector<dvec2>& polygon() const { return polygon_; }
    const std::optional<PlacedPlant>& selected() const { return selected_; }
    // Which of the root's references, where a tile is.
    const std::optional<size_t>& selected_tile() const { return tile_; }
    void select_tile(size_t index);
    void act_on_tile(Session& session, const char* command, nlohmann::json arguments);
    // How far what is selected has been dragged, until the button is let go.
    dvec2 dragged() const { return dragging_ && tool == Tool::select ? drag_to_ - drag_from_ : dvec2(0.0); }
    void forget_selection() {
        selected_.reset();
        tile_.reset();
    }

  private:
    void begin_stroke(Session& session, const Gesture& gesture);
    void extend_stroke(Session& session, dvec2 to);
    void pick(Session& session, dvec2 at);
    void pick_tile(const Session& session, dvec2 at, double handle_m);

    std::map<std::string, float> densities_;  // of populations that are not active
    std::optional<PaintStroke> stroke_;
    bool erasing_ = false, dragging_ = false;
    std::vector<uint16_t> erased_kinds_;
    std::vector<dvec2> points_;
    size_t stroke_plants_ = 0;
    std::string stroke_kind_;  // in the step's name
    uint64_t stroke_number_ = 0;
    std::vector<dvec2> polygon_;
    std::optional<PlacedPlant> selected_;
    std::optional<size_t> tile_;
    dvec2 drag_from_{0.0}, drag_to_{0.0};
};

}  // namespace coppice
