// What stands beside the view: tools, populations with what they cost, rules, tiles, what was done, what is wrong.
#pragma once
#include "plugins/vegetation/eco/vary_color.h"
#include "editor/view/editor_view.h"
#include "editor/window/tools.h"

namespace coppice {

// Between frames; what a person asks for with buttons and keys beside the commands.
struct PanelState {
    bool dark = true, shadows = false, help = false;
    float scale = 1.0f;
    float target_ms = 33.0f;  // that a moving view's frames may take
    bool wants_save = false, wants_close = false, wants_scale = false;
    bool closing = false;  // the question is asked
    bool overwriting = false;  // likewise: what is to be saved over was changed by another program
    bool closed = false;
    bool recovering = false;  // likewise, at the start
    bool is_asking() const { return closing || overwriting || recovering; }
    std::string wants_plant;  // the population whose plant view is asked for
    bool wants_scene = false;
    int tried_part = -1;  // of a plant, whose importance is being dragged
    float tried_importance = 1.0f;
    std::string note;         // "saved", or why not
    std::vector<Error> warnings;
    char new_name[64] = "", new_source[256] = "", new_tile[128] = "";
    float importance_draft = 0.0f;
    ColorVariation color_draft;
    std::pair<std::string, uint64_t> drafts_of;  // the population, the text's version
    std::map<std::string, size_t> counts;               // of placed plants
    std::pair<size_t, size_t> counted_at{SIZE_MAX, 0};  // plants, steps
};

struct ViewFigures {
    double frame_ms = 0.0;
    float sample_distance_px = 0.0f;
    uint64_t vertices = 0;
    // Of the vertices that the view draws, by population; and of clouds, which stand for all plants in the distance.
    std::map<std::string, double> shares;
    double cloud_share = 0.0;
    std::optional<dvec3> cursor;
};

void apply_theme(bool dark, float scale);
// Fonts of the display's resolution; false: only the built-in one was found.
bool load_fonts(float scale);

// Before closing, and where unsaved work was found.
void draw_questions(Session& session, PanelState& state);

// The whole of a frame's panels; needs a frame of ImGui that has begun. width of the view that stays free: view_low to view_high.
void draw_panels(Session& session, Tools& tools, const EditorView& view, const ViewFigures& figures,
                 PanelState& state);

}  // namespace coppice
