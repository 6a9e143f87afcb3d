#include "editor/window/plant_panels.h"

#include <algorithm>
#include <fmt/format.h>
#include <imgui.h>
#include "plugins/vegetation/cook/part_settings.h"

namespace coppice {
namespace {

constexpr float k_least_px = 2.0f, k_most_px = 2000.0f;
constexpr double k_bound = 0.03;  // that tests hold species to
constexpr ImU32 k_coverage_color = IM_COL32(90, 190, 255, 255), k_color_color = IM_COL32(255, 170, 60, 255);

void text(const std::string& line) { ImGui::TextUnformatted(line.c_str()); }
void wrapped(const std::string& line) {
    ImGui::PushTextWrapPos(0.0f);
    text(line);
    ImGui::PopTextWrapPos();
}
void explain(const std::string& words) {
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", words.c_str());
}

float left_px(float scale) { return std::min(440.0f * scale, ImGui::GetIO().DisplaySize.x * 0.42f); }
float right_px(float scale) { return std::min(300.0f * scale, ImGui::GetIO().DisplaySize.x * 0.3f); }

std::string counts_text(uint64_t triangles, uint64_t lines, uint64_t points, uint64_t leaves) {
    std::string said;
    auto add = [&](uint64_t count, const char* one, const char* many) {
        if (count > 0) said += fmt::format("{}{} {}", said.empty() ? "" : ", ", count, count == 1 ? one : many);
    };
    add(triangles, "triangle", "triangles");
    add(leaves, "leaf", "leaves");
    add(lines, "line", "lines");
    add(points, "point", "points");
    return said.empty() ? "nothing" : said;
}

void perform(Session& session, PanelState& state, const nlohmann::json& arguments) {
    auto edit = session.perform("set_part", arguments);
    state.note = edit ? "" : to_string(edit.error());
}

void draw_size(PlantEditor& plant) {
    StageView& view = plant.view;
    ImGui::SliderFloat("size", &view.height_px, k_least_px, k_most_px, "%.0f px tall", ImGuiSliderFlags_Logarithmic);
    explain("what stands for the plant where it is that tall in the picture is shown to the right, magnified");
    ImGui::Checkbox("at its own size", &view.own_size);
    explain("as small as games show it");
    ImGui::SameLine();
    ImGui::Checkbox("colours by kind", &view.kinds);
    explain("triangles green, leaves yellow, lines blue, points red");
    if (plant.stage().is_empty()) return;
    const PrimitiveCounts drawn = plant.stage().drawn();
    wrapped("drawn: " + counts_text(drawn.triangles, drawn.lines, drawn.points, drawn.leaves));
}

void draw_part(Session& session, PlantEditor& plant, PanelState& state, uint32_t index) {
    const PackedPart& part = plant.plant()->parts[index];
    const PartSettings set = plant.settings_of(part.name);
    ImGui::PushID(int(index));
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    const vec3 color = glm::clamp(vec3(part.mean_color_linear[0], part.mean_color_linear[1], part.mean_color_linear[2]),
                                  vec3(0.0f), vec3(1.0f));
    const float line_px = ImGui::GetTextLineHeight();
    ImGui::AlignTextToFramePadding();
    ImGui::ColorButton("##colour", ImVec4(linear_to_srgb(color.x), linear_to_srgb(color.y), linear_to_srgb(color.z), 1.0f),
                       ImGuiColorEditFlags_NoTooltip | ImGuiColorEditFlags_NoDragDrop, {0.7f * line_px, 0.7f * line_px});
    ImGui::SameLine();
    text(part.name);
    explain(fmt::format("{} triangles, {} points, {} lines stored\n{:.3f} m2{}", part.triangle_count, part.point_count,
                        part.line_count, part.area_m2,
                        part.line_count > 0 ? fmt::format(", {:.1f} m of lines within {:.1f} mm", part.line_length_m,
                                                          double(part.line_error_m) * 1000.0)
                                            : ""));
    ImGui::TableNextColumn();
    ImGui::SetNextItemWidth(-1.0f);
    if (ImGui::BeginCombo("##kind", name_of(set.kind))) {
        for (PartKind kind : {PartKind::automatic, PartKind::points, PartKind::lines, PartKind::leaves}) {
            if (kind == PartKind::leaves && !(part.flags & k_part_leaf)) continue;
            if (ImGui::Selectable(name_of(kind), kind == set.kind) && kind != set.kind)
                perform(session, state, {{"population", plant.population()}, {"part", part.name}, {"kind", name_of(kind)}});
        }
        ImGui::EndCombo();
    }
    explain("what it turns into in the distance");
    ImGui::TableNextColumn();
    ImGui::SetNextItemWidth(-1.0f);
    float importance = set.importance > 0.0f ? set.importance : part.importance;
    if (state.tried_part == int(index)) importance = state.tried_importance;
    if (ImGui::SliderFloat("##importance", &importance, 0.1f, 10.0f, set.importance > 0.0f ? "%.2f" : "(%.2f)",
                           ImGuiSliderFlags_Logarithmic)) {
        state.tried_part = int(index);
        state.tried_importance = importance;
        plant.try_importance(index, importance);
    }
    explain("how many primitives stand for it: 2 is twice as many. In brackets: as its colour says; a right click brings that back");
    if (ImGui::IsItemDeactivatedAfterEdit()) {
        perform(session, state, {{"population", plant.population()}, {"part", part.name}, {"importance", importance}});
        state.tried_part = -1;
    }
    if (ImGui::IsItemClicked(ImGuiMouseButton_Right))
        perform(session, state, {{"population", plant.population()}, {"part", part.name}, {"importance", 0.0}});
    ImGui::TableNextColumn();
    const PartChoice choice = plant.choice_at(index, plant.view.height_px);
    text(counts_text(choice.triangles, choice.lines, choice.points - choice.skipped_points, choice.leaves));
    ImGui::PopID();
}

void draw_parts(Session& session, PlantEditor& plant, PanelState& state) {
    if (!ImGui::BeginTable("parts", 4, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingStretchProp)) return;
    ImGui::TableSetupColumn("part", 0, 1.3f);
    ImGui::TableSetupColumn("kind", 0, 1.5f);
    ImGui::TableSetupColumn("importance", 0, 1.3f);
    ImGui::TableSetupColumn("at that size", 0, 1.6f);
    ImGui::TableHeadersRow();
    for (uint32_t part = 0; part < plant.plant()->parts.size(); ++part) draw_part(session, plant, state, part);
    ImGui::EndTable();
}

// Errors over the size, in logarithmic steps of it.
void draw_plot(const std::vector<LevelFigures>& figures, float height_px, float scale) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float wide = ImGui::GetContentRegionAvail().x, margin = 34.0f * scale, bottom = 20.0f * scale;
    const ImVec2 size(wide, 0.75f * wide), low(at.x + margin, at.y + size.y - bottom), high(at.x + wide - 8.0f * scale, at.y + 6.0f * scale);
    ImGui::Dummy(size);
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImU32 frame = ImGui::GetColorU32(ImGuiCol_TextDisabled), ink = ImGui::GetColorU32(ImGuiCol_Text);
    double most = 2.0 * k_bound;
    for (const LevelFigures& each : figures)
        most = std::max({most, 1.1 * std::fabs(each.coverage_error), 1.1 * each.color_error});
    const float first = std::log2(10.0f), last = std::log2(500.0f);
    auto x_of = [&](float px) { return low.x + (high.x - low.x) * std::clamp((std::log2(px) - first) / (last - first), 0.0f, 1.0f); };
    auto y_of = [&](double error) { return low.y + (high.y - low.y) * float(0.5 + 0.5 * error / most); };
    list->AddRect({low.x, high.y}, {high.x, low.y}, frame);
    for (double line : {-k_bound, 0.0, k_bound}) {
        list->AddLine({low.x, y_of(line)}, {high.x, y_of(line)}, frame, line == 0.0 ? 1.5f : 0.5f);
        list->AddText({at.x, y_of(line) - 0.5f * ImGui::GetTextLineHeight()}, ink, (line == 0.0 ? "0" : fmt::format("{:+.0f} %", 100.0 * line)).c_str());
    }
    for (float px : {20.0f, 50.0f, 100.0f, 200.0f, 400.0f}) {
        list->AddLine({x_of(px), low.y}, {x_of(px), low.y - 4.0f * scale}, frame);
        list->AddText({x_of(px) - 8.0f * scale, low.y + 2.0f * scale}, ink, fmt::format("{:.0f}", px).c_str());
    }
    list->AddLine({x_of(height_px), low.y}, {x_of(height_px), high.y}, ImGui::GetColorU32(ImGuiCol_SliderGrabActive), 2.0f * scale);
    auto curve = [&](auto error_of, ImU32 color) {
        for (size_t i = 0; i < figures.size(); ++i) {
            const ImVec2 here(x_of(figures[i].height_px), y_of(error_of(figures[i])));
            list->AddCircleFilled(here, 2.5f * scale, color);
            if (i > 0)
                list->AddLine({x_of(figures[i - 1].height_px), y_of(error_of(figures[i - 1]))}, here, color, 1.5f * scale);
        }
    };
    curve([](const LevelFigures& each) { return each.coverage_error; }, k_coverage_color);
    curve([](const LevelFigures& each) { return each.color_error; }, k_color_color);
}

void draw_figures(PlantEditor& plant, float scale) {
    const std::vector<LevelFigures> figures = plant.work().figures();
    text("off from all triangles, over the height in px");
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(k_coverage_color), "coverage");
    ImGui::SameLine();
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(k_color_color), "mean colour");
    ImGui::SameLine();
    text(plant.work().is_cooking() ? "cooking ..." : plant.work().is_measuring() ? "measuring ..." : "");
    draw_plot(figures, plant.view.height_px, scale);
    if (!figures.empty() && ImGui::BeginTable("figures", 4, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingStretchProp)) {
        for (const char* column : {"px", "coverage", "colour", "vertices"}) ImGui::TableSetupColumn(column);
        ImGui::TableHeadersRow();
        for (const LevelFigures& each : figures) {
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            text(fmt::format("{:.0f}", each.height_px));
            ImGui::TableNextColumn();
            text(fmt::format("{:+.1f} %", 100.0 * each.coverage_error));
            ImGui::TableNextColumn();
            text(fmt::format("{:.1f} %", 100.0 * each.color_error));
            ImGui::TableNextColumn();
            text(fmt::format("{}", vertices_of(each.drawn)));
        }
        ImGui::EndTable();
    }
}

void label(const std::string& words, float middle_px, float y_px) {
    ImDrawList* list = ImGui::GetBackgroundDrawList();
    const ImVec2 size = ImGui::CalcTextSize(words.c_str()), at(middle_px - 0.5f * size.x, y_px);
    list->AddRectFilled({at.x - 6.0f, at.y - 2.0f}, {at.x + size.x + 6.0f, at.y + size.y + 3.0f}, IM_COL32(0, 0, 0, 140), 4.0f);
    list->AddText(at, IM_COL32(255, 255, 255, 255), words.c_str());
}

}  // namespace

FreeColumns plant_free_columns(float scale) {
    return {left_px(scale), ImGui::GetIO().DisplaySize.x - right_px(scale)};
}

void draw_plant_panels(Session& session, PlantEditor& plant, PanelState& state) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float bar_px = ImGui::GetFrameHeight() + 8.0f * state.scale;
    const ImGuiWindowFlags fixed = ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
                                   ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoBringToFrontOnFocus;
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize({size.x, bar_px});
    ImGui::Begin("bar", nullptr, fixed | ImGuiWindowFlags_NoScrollbar);
    if (ImGui::Button(session.saved() ? "Save" : "Save *")) state.wants_save = true;
    if (!session.document().root().is_made_up) {
        ImGui::SameLine();
        if (ImGui::Button("Back to the scene")) state.wants_scene = true;
        explain("Esc");
    }
    const Edit *undo = session.history().next_undo(), *redo = session.history().next_redo();
    ImGui::SameLine();
    if (ImGui::Button(undo ? ("Undo " + undo->name + "###undo").c_str() : "Undo###undo")) session.undo();
    ImGui::SameLine();
    if (ImGui::Button(redo ? ("Redo " + redo->name + "###redo").c_str() : "Redo###redo")) session.redo();
    ImGui::SameLine();
    if (ImGui::Checkbox("dark", &state.dark)) apply_theme(state.dark, state.scale);
    ImGui::SameLine();
    ImGui::Checkbox("shadows", &plant.view.shadows);
    ImGui::SameLine();
    text(state.note);
    ImGui::End();

    ImGui::SetNextWindowPos({0, bar_px});
    ImGui::SetNextWindowSize({left_px(state.scale), size.y - bar_px});
    ImGui::Begin("plant", nullptr, fixed);
    text(plant.population());
    ImGui::PushItemWidth(left_px(state.scale) * 0.6f);
    draw_size(plant);
    ImGui::PopItemWidth();
    ImGui::Separator();
    if (plant.plant())
        draw_parts(session, plant, state);
    else if (plant.work().is_cooking())
        text("cooking ...");
    if (!plant.fault().empty()) wrapped(plant.fault());
    ImGui::Separator();
    wrapped("right mouse: walk around   wheel: nearer and farther   Ctrl Z, Ctrl Y, Ctrl S");
    ImGui::End();

    ImGui::SetNextWindowPos({size.x - right_px(state.scale), bar_px});
    ImGui::SetNextWindowSize({right_px(state.scale), size.y - bar_px});
    ImGui::Begin("levels", nullptr, fixed);
    draw_figures(plant, state.scale);
    ImGui::End();

    draw_questions(session, state);
    if (plant.stage().is_empty()) return;
    const FreeColumns free = plant_free_columns(state.scale);
    const float middle_px = 0.5f * (free.low_px + free.high_px), quarter_px = 0.24f * (free.high_px - free.low_px);
    label("all triangles", middle_px - quarter_px, size.y - bar_px);
    label(plant.view.own_size ? fmt::format("{:.0f} px", plant.view.height_px)
                              : fmt::format("as at {:.0f} px, x {:.1f}", plant.view.height_px,
                                            plant.stage().sample_distance_px()),
          middle_px + quarter_px, size.y - bar_px);
}

}  // namespace coppice
