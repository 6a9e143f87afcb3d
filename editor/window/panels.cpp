#include "editor/window/panels.h"

#include <algorithm>
#include <filesystem>
#include <cstring>
#include <fmt/format.h>
#include <imgui.h>

namespace coppice {
namespace {

constexpr const char* k_fonts[] = {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                                   "/usr/share/fonts/TTF/DejaVuSans.ttf"};
constexpr float k_font_px = 15.0f;

std::string short_number(double value) {
    if (value < 1000.0) return fmt::format("{:.0f}", value);
    if (value < 1e6) return fmt::format("{:.1f} k", value / 1e3);
    if (value < 1e9) return fmt::format("{:.1f} M", value / 1e6);
    return fmt::format("{:.1f} G", value / 1e9);
}

void text(const std::string& line) { ImGui::TextUnformatted(line.c_str()); }
void wrapped(const std::string& line) {
    ImGui::PushTextWrapPos(0.0f);
    text(line);
    ImGui::PopTextWrapPos();
}
void explain(const char* words) {
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", words);
}

void count_plants(const Session& session, PanelState& state) {
    // Looked at again only after something was done.
    const std::pair now(session.document().root().plants.size(), session.history().done_count());
    if (state.counted_at == now && !state.counts.empty()) return;
    state.counted_at = now;
    std::vector<size_t> counts(session.document().kinds().size(), 0);
    for (const auto& [cell, plants] : session.document().root().plants.cells())
        for (const PlacedPlant& plant : plants) ++counts[plant.kind];
    state.counts.clear();
    for (size_t kind = 0; kind < counts.size(); ++kind)
        state.counts[session.document().kinds()[kind]] = counts[kind];
}

void draw_map_and_distance(const Session& session, BrushSettings& brush) {
    ImGui::InputText("map", brush.map, sizeof brush.map);
    explain("a picture, as seen from the scene's folder: plants stand where it is bright");
    if (brush.map[0]) {
        ImGui::DragFloat("map side", &brush.map_side_m, 1.0f, 0.0f, 1e6f, "%.0f m");
        explain("of a square about the origin; 0: all the ground");
        ImGui::SameLine();
        ImGui::Checkbox("dark", &brush.map_inverted);
        explain("plants stand where the picture is dark");
    }
    const auto& json = session.document().root().text->json;
    const auto plants = json.find("plants");
    if (plants == json.end() || !plants->is_object()) return;
    if (ImGui::BeginCombo("distance to", brush.distance_from.empty() ? "-" : brush.distance_from.c_str())) {
        if (ImGui::Selectable("-", brush.distance_from.empty())) brush.distance_from.clear();
        for (const auto& [name, entry] : plants->items())
            if (ImGui::Selectable(name.c_str(), brush.distance_from == name)) brush.distance_from = name;
        ImGui::EndCombo();
    }
    explain("of that population's plants that stand already");
    if (brush.distance_from.empty()) return;
    ImGui::DragFloat("at least", &brush.distance_least_m, 0.1f, 0.0f, 1000.0f, "%.1f m");
    ImGui::DragFloat("at most", &brush.distance_most_m, 0.1f, 0.0f, 1000.0f, "%.1f m");
    explain("0: any distance");
}

void draw_tools(Session& session, Tools& tools) {
    for (const Tool tool : {Tool::brush, Tool::polygon, Tool::place, Tool::select}) {
        if (tool != Tool::brush) ImGui::SameLine();
        if (ImGui::RadioButton(name_of(tool), tools.tool == tool) && tools.tool != tool) {
            tools.stop(session);
            tools.tool = tool;
        }
    }
    BrushSettings& brush = tools.brush;
    const bool paints = tools.tool == Tool::brush || tools.tool == Tool::polygon;
    if (tools.tool == Tool::brush) {
        ImGui::SliderFloat("radius", &brush.radius_m, 0.2f, 100.0f, "%.1f m", ImGuiSliderFlags_Logarithmic);
        explain("[ and ]");
    }
    if (paints) {
        ImGui::SliderFloat("density", &brush.density_per_m2, 0.001f, 20.0f, "%.3f /m2",
                           ImGuiSliderFlags_Logarithmic);
        explain("Shift with [ and ]");
        ImGui::SliderFloat("distance", &brush.spacing_m, 0.0f, 10.0f, "%.2f m");
        explain("least distance to plants that stand there");
        ImGui::DragFloatRange2("scale", &brush.scale_low, &brush.scale_high, 0.01f, 0.05f, 10.0f, "%.2f");
        ImGui::SliderFloat("tilt", &brush.tilt_deg, 0.0f, 45.0f, "%.0f deg");
        ImGui::SliderFloat("follow slope", &brush.align_to_ground, 0.0f, 1.0f, "%.2f");
        ImGui::Checkbox("##slope", &brush.limit_slope);
        ImGui::SameLine();
        ImGui::SliderFloat("slope to", &brush.slope_max_deg, 0.0f, 90.0f, "%.0f deg");
        ImGui::Checkbox("##height", &brush.limit_altitude);
        ImGui::SameLine();
        ImGui::DragFloatRange2("height", &brush.altitude_low_m, &brush.altitude_high_m, 0.5f, -1000.0f,
                               9000.0f, "%.0f m");
        const auto& json = session.document().root().text->json;
        if (const auto regions = json.find("regions"); regions != json.end() && regions->is_object())
            if (ImGui::BeginCombo("not in", brush.exclude.empty() ? "-" : brush.exclude.c_str())) {
                if (ImGui::Selectable("-", brush.exclude.empty())) brush.exclude.clear();
                for (const auto& [name, region] : regions->items())
                    if (ImGui::Selectable(name.c_str(), brush.exclude == name)) brush.exclude = name;
                ImGui::EndCombo();
            }
        draw_map_and_distance(session, brush);
    }
    if (tools.tool == Tool::polygon) text("click corners, Enter fills, Esc drops");
    if (tools.tool == Tool::select && tools.selected()) {
        const PlacedPlant& plant = *tools.selected();
        text(fmt::format("{} of scale {:.2f}", session.document().kinds()[plant.kind],
                         unpack_scale(plant.scale)));
        if (ImGui::Button("turn left")) tools.act_on_selection(session, "turn", {{"by_deg", 15}});
        ImGui::SameLine();
        if (ImGui::Button("turn right")) tools.act_on_selection(session, "turn", {{"by_deg", -15}});
        if (ImGui::Button("larger")) tools.act_on_selection(session, "scale", {{"by", 1.1}});
        ImGui::SameLine();
        if (ImGui::Button("smaller")) tools.act_on_selection(session, "scale", {{"by", 1 / 1.1}});
        ImGui::SameLine();
        if (ImGui::Button("delete")) tools.act_on_selection(session, "delete", nlohmann::json::object());
        text("drag moves it");
    } else if (tools.tool == Tool::select && tools.selected_tile()) {
        const std::vector<TileHandle> handles = tile_handles(session);
        const size_t index = *tools.selected_tile();
        if (index >= handles.size()) return tools.forget_selection();
        const TileHandle& tile = handles[index];
        text(fmt::format("{} at {:.1f}, {:.1f}", tile.scene, tile.at.x, tile.at.y));
        auto turned = [&](double by_deg) { return nlohmann::json{{"turn_deg", std::remainder(tile.turn_deg + by_deg, 360.0)}}; };
        if (ImGui::Button("turn left")) tools.act_on_tile(session, "move_tile", turned(15.0));
        ImGui::SameLine();
        if (ImGui::Button("turn right")) tools.act_on_tile(session, "move_tile", turned(-15.0));
        if (ImGui::Button("larger")) tools.act_on_tile(session, "move_tile", {{"scale", tile.scale * 1.1}});
        ImGui::SameLine();
        if (ImGui::Button("smaller")) tools.act_on_tile(session, "move_tile", {{"scale", tile.scale / 1.1}});
        ImGui::SameLine();
        if (ImGui::Button("remove")) tools.act_on_tile(session, "remove_tile", nlohmann::json::object());
        text("drag its mark moves it");
    } else if (tools.tool == Tool::select) {
        text("click a placed plant, or the mark of a tile");
    }
}

float number_in(const nlohmann::ordered_json& object, const char* key, float otherwise) {
    if (!object.is_object()) return otherwise;
    const auto value = object.find(key);
    return value != object.end() && value->is_number() ? value->get<float>() : otherwise;
}

// How the colours of the active population's plants differ.
void draw_color_variation(Session& session, Tools& tools, ColorVariation& draft) {
    bool done = false;
    auto slider = [&](const char* name, float& value, float most, const char* format, const char* words) {
        ImGui::SliderFloat(name, &value, 0.0f, most, format);
        explain(words);
        done |= ImGui::IsItemDeactivatedAfterEdit();
    };
    slider("brightness", draft.brightness, 0.9f, "+- %.2f", "how much brighter and darker its plants are; their mean stays");
    slider("hue", draft.hue_deg, 45.0f, "+- %.0f deg", "how far their hue is turned, either way");
    slider("saturation", draft.saturation, 0.7f, "+- %.2f", "how much more and less colourful they are");
    if (!done) return;
    nlohmann::json variation = nullptr;
    if (draft.any())
        variation = {{"brightness", draft.brightness}, {"hue_deg", draft.hue_deg}, {"saturation", draft.saturation}};
    tools.perform(session, "set_population", {{"name", tools.active}, {"color_variation", variation}});
}

void draw_populations(Session& session, Tools& tools, const EditorView& view, const ViewFigures& figures,
                      PanelState& state) {
    count_plants(session, state);
    const auto& json = session.document().root().text->json;
    const auto plants = json.find("plants");
    const bool has_plants = plants != json.end() && plants->is_object();
    double cost = 0.0;
    if (ImGui::BeginTable("populations", 5, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingStretchProp)) {
        ImGui::TableSetupColumn("population", 0, 2.2f);
        ImGui::TableSetupColumn("placed", 0, 1.0f);
        ImGui::TableSetupColumn("by rule", 0, 1.0f);
        ImGui::TableSetupColumn("triangles", 0, 1.2f);
        ImGui::TableSetupColumn("view", 0, 0.8f);
        ImGui::TableHeadersRow();
        auto row = [&](const std::string& name, bool missing) {
            ImGui::PushID(name.c_str());
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            bool painted = tools.brush.kinds.contains(name);
            if (!missing && ImGui::Checkbox("##painted", &painted)) {
                if (painted)
                    tools.brush.kinds.insert(name);
                else
                    tools.brush.kinds.erase(name);
            }
            if (!missing) explain("painted");
            if (!missing) ImGui::SameLine();
            if (ImGui::Selectable(missing ? (name + " (missing)").c_str() : name.c_str(),
                                  tools.active == name)) {
                if (missing)
                    tools.active = name;
                else
                    tools.choose(name);
            }
            const double placed = double(state.counts[name]), by_rule = double(view.base_plant_count(name));
            const double triangles = (placed + by_rule) * view.triangles_of(name);
            cost += triangles;
            ImGui::TableNextColumn();
            text(short_number(placed));
            ImGui::TableNextColumn();
            text(short_number(by_rule));
            ImGui::TableNextColumn();
            text(short_number(triangles));
            ImGui::TableNextColumn();
            const auto share = figures.shares.find(name);
            text(fmt::format("{:.0f} %", share == figures.shares.end() ? 0.0 : 100.0 * share->second));
            explain("of the vertices that this view draws");
            ImGui::PopID();
        };
        if (has_plants)
            for (const auto& [name, entry] : plants->items()) row(name, false);
        for (const auto& [name, count] : std::map(state.counts))
            if (count > 0 && !(has_plants && plants->contains(name))) row(name, true);
        ImGui::EndTable();
    }
    text(fmt::format("{} plants placed, {} triangles in all",
                     short_number(double(session.document().root().plants.size())), short_number(cost)));
    if (figures.cloud_share > 0.005)
        text(fmt::format("{:.0f} % of the view is the distance, where points stand for all", 100.0 * figures.cloud_share));
    if (has_plants && plants->contains(tools.active)) {
        const auto& entry = (*plants)[tools.active];
        if (const std::pair now(tools.active, session.text_version()); state.drafts_of != now) {
            state.drafts_of = now;
            state.importance_draft = number_in(entry, "importance", 1.0f);
            const auto color = entry.is_object() ? entry.find("color_variation") : entry.end();
            const auto& said = color != entry.end() ? *color : entry;
            state.color_draft = {number_in(said, "brightness", 0.0f), number_in(said, "hue_deg", 0.0f),
                                 number_in(said, "saturation", 0.0f)};
        }
        ImGui::SliderFloat("importance", &state.importance_draft, 0.1f, 10.0f, "%.2f",
                           ImGuiSliderFlags_Logarithmic);
        explain("of the active population: how many points and lines stand for it");
        if (ImGui::IsItemDeactivatedAfterEdit())
            tools.perform(session, "set_population",
                          {{"name", tools.active}, {"importance", state.importance_draft}});
        draw_color_variation(session, tools, state.color_draft);
        if (ImGui::Button("levels of detail ...")) state.wants_plant = tools.active;
        explain("the plant beside what stands for it; kind and importance by part");
    }
    if (ImGui::TreeNode("new population")) {
        ImGui::InputText("name", state.new_name, sizeof state.new_name);
        ImGui::InputText("source", state.new_source, sizeof state.new_source);
        explain("a species (.json) or a model (.glb, .gltf), as seen from the scene's folder");
        if (ImGui::Button("add") && state.new_name[0]) {
            tools.perform(session, "add_population",
                          {{"name", state.new_name}, {"source", state.new_source}});
            if (tools.message.empty()) {
                tools.choose(state.new_name);
                state.new_name[0] = state.new_source[0] = '\0';
            }
        }
        ImGui::TreePop();
    }
}

void draw_rules(Session& session, Tools& tools) {
    const auto json = session.document().root().text->json;
    const auto placements = json.find("placements");
    if (placements == json.end() || !placements->is_array()) return;
    for (size_t i = 0; i < placements->size(); ++i) {
        const auto& placement = (*placements)[i];
        if (!placement.is_object() || !placement.contains("scatter") || !placement["scatter"].is_object())
            continue;
        const auto& rule = placement["scatter"];
        std::string name = rule.value("plant", "");
        if (const auto shares = rule.find("plants"); shares != rule.end() && shares->is_object())
            for (const auto& [each, share] : shares->items()) name += (name.empty() ? "" : ", ") + each;
        ImGui::PushID(int(i));
        if (ImGui::TreeNode("##rule", "%s", name.c_str())) {
            wrapped(rule.dump());
            if (ImGui::Button("place one by one")) tools.perform(session, "bake_rule", {{"index", i}});
            explain("its plants can then be erased and moved");
            ImGui::SameLine();
            if (ImGui::Button("remove")) tools.perform(session, "remove_rule", {{"index", i}});
            ImGui::TreePop();
        }
        ImGui::PopID();
    }
    if (ImGui::Button("add the brush's rule, within the ground"))
        tools.perform(session, "add_rule", {{"scatter", tools.rule()}});
}

// The references of one file, with what is below each.
void draw_tile_tree(Session& session, Tools& tools, const std::string& path, int depth,
                    const std::optional<dvec3>& cursor) {
    const EcoFile* file = session.document().find(path);
    if (!file || !file->text || depth > 16) return;
    const auto json = file->text->json;
    const auto references = json.find("references");
    if (references == json.end() || !references->is_array()) return;
    const std::string from_root =
        std::filesystem::path(path)
            .lexically_relative(std::filesystem::path(session.document().root_path()).parent_path())
            .string();
    for (size_t i = 0; i < references->size(); ++i) {
        const auto& reference = (*references)[i];
        if (!reference.is_object()) continue;
        const std::string scene = reference.value("scene", "");
        const std::string child = Document::resolve(path, scene);
        const EcoFile* below = session.document().find(child);
        ImGui::PushID(int(i));
        const bool open =
            ImGui::TreeNode("##tile", "%s%s%s", scene.c_str(), below && below->text ? "" : " (missing)",
                            reference.contains("grid") ? " (grid)" : "");
        if (open) {
            if (below && below->text) text(fmt::format("{} placed plants", below->plants.size()));
            nlohmann::json arguments = {{"index", i}};
            if (path != session.document().root_path()) arguments["file"] = from_root;
            if (ImGui::Button("remove")) {
                tools.perform(session, "remove_tile", arguments);
            } else {
                arguments["at"] = {cursor ? cursor->x : 0.0, cursor ? cursor->z : 0.0};
                ImGui::SameLine();
                if (ImGui::Button("duplicate")) {
                    const auto& at = reference.value("at", nlohmann::ordered_json::array());
                    if (at.size() >= 2 && at[0].is_number() && at.back().is_number())
                        arguments["at"] = {at[0].get<double>() + 20.0, at.back().get<double>()};
                    tools.perform(session, "duplicate_tile", arguments);
                }
                ImGui::SameLine();
                if (ImGui::Button("to the middle of the view"))
                    tools.perform(session, "move_tile", arguments);
            }
            draw_tile_tree(session, tools, child, depth + 1, cursor);
            ImGui::TreePop();
        }
        ImGui::PopID();
    }
}

void draw_tiles(Session& session, Tools& tools, const ViewFigures& figures, PanelState& state) {
    text(std::filesystem::path(session.document().root_path()).filename().string());
    draw_tile_tree(session, tools, session.document().root_path(), 0, figures.cursor);
    ImGui::InputText("scene", state.new_tile, sizeof state.new_tile);
    explain("NAME.eco.json, beside this scene");
    const nlohmann::json arguments = {
        {"scene", state.new_tile},
        {"at", {figures.cursor ? figures.cursor->x : 0.0, figures.cursor ? figures.cursor->z : 0.0}}};
    if (ImGui::Button("create tile")) tools.perform(session, "create_tile", arguments);
    ImGui::SameLine();
    if (ImGui::Button("add tile")) tools.perform(session, "add_tile", arguments);
}

void draw_history(Session& session, Tools& tools) {
    const History& history = session.history();
    const size_t done = history.done_count(), count = history.edits().size();
    const size_t first = done > 12 ? done - 12 : 0;
    for (size_t i = first; i < std::min(count, first + 24); ++i) {
        ImGui::PushID(int(i));
        if (i >= done) ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
        if (ImGui::Selectable(history.edits()[i].name.c_str(), i + 1 == done)) {
            tools.stop(session);
            tools.forget_selection();
            while (session.history().done_count() > i + 1) session.undo();
            while (session.history().done_count() < i + 1) session.redo();
        }
        if (i >= done) ImGui::PopStyleColor();
        ImGui::PopID();
    }
}

void draw_faults(const EditorView& view, const Session& session, PanelState& state) {
    for (const auto* list : {&session.document().faults(), &view.faults(), &std::as_const(state.warnings)})
        for (const Error& fault : *list) {
            ImGui::Bullet();
            wrapped(to_string(fault));
        }
}

constexpr const char* k_help =
    "Right mouse: look     W A S D Q E: fly, Shift fast     wheel: forward and back\n"
    "B brush   P polygon   T place   V select     1 to 9: population\n"
    "Brush: Shift erases all, Ctrl erases the active population, [ ] radius, Shift [ ] density, Alt-click "
    "picks\n"
    "Ctrl Z undo   Ctrl Y redo   Ctrl S save   Ctrl Q close   Ctrl + - size of all text   Del deletes what "
    "is "
    "selected   F1 this";

}  // namespace

void draw_questions(Session& session, PanelState& state) {
    const ImVec2 middle(ImGui::GetIO().DisplaySize.x * 0.5f, ImGui::GetIO().DisplaySize.y * 0.5f);
    auto begin = [&](const char* name) {
        if (!ImGui::IsPopupOpen(name)) ImGui::OpenPopup(name);
        ImGui::SetNextWindowPos(middle, ImGuiCond_Always, ImVec2(0.5f, 0.5f));
        return ImGui::BeginPopupModal(name, nullptr, ImGuiWindowFlags_AlwaysAutoResize);
    };
    if (state.recovering && begin("Unsaved work was found")) {
        text(fmt::format("An earlier run ended without saving {} steps.", session.recoverable_count()));
        if (ImGui::Button("Recover")) {
            auto recovered = session.recover();
            state.note =
                recovered ? fmt::format("recovered {} steps", *recovered) : to_string(recovered.error());
            state.recovering = false;
            ImGui::CloseCurrentPopup();
        }
        ImGui::SameLine();
        if (ImGui::Button("Discard")) {
            (void)session.discard_recovery();
            state.recovering = false;
            ImGui::CloseCurrentPopup();
        }
        ImGui::EndPopup();
    }
    if (state.overwriting && begin("Changed by another program")) {
        text("Since they were read here, another program wrote:");
        for (const std::string& file : session.document().changed_elsewhere()) text("  " + file);
        text("What is there is kept as .bak.");
        if (ImGui::Button("Overwrite")) {
            const Status saved = session.save(true);
            state.note = saved ? "saved" : to_string(saved.error());
            state.overwriting = false;
            ImGui::CloseCurrentPopup();
        }
        ImGui::SameLine();
        if (ImGui::Button("Do not save")) {
            state.overwriting = false;
            ImGui::CloseCurrentPopup();
        }
        ImGui::EndPopup();
    }
    if (state.closing && !state.overwriting && begin("Not saved")) {
        text("There are changes that are not saved.");
        if (!state.note.empty()) wrapped(state.note);
        if (ImGui::Button("Save and close")) {
            state.overwriting = !session.document().changed_elsewhere().empty();
            if (Status saved = session.save(); saved)
                state.closed = true;
            else
                state.note = to_string(saved.error());
        }
        ImGui::SameLine();
        if (ImGui::Button("Close without saving")) {
            session.drop_journal();
            state.closed = true;
        }
        ImGui::SameLine();
        if (ImGui::Button("Go on")) {
            state.closing = false;
            ImGui::CloseCurrentPopup();
        }
        ImGui::EndPopup();
    }
}

void apply_theme(bool dark, float scale) {
    ImGui::GetStyle() = ImGuiStyle();
    if (dark)
        ImGui::StyleColorsDark();
    else
        ImGui::StyleColorsLight();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 0.0f;
    style.FrameRounding = 3.0f;
    style.Colors[ImGuiCol_WindowBg].w = 0.94f;
    style.ScaleAllSizes(scale);
}

bool load_fonts(float scale) {
    ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
    fonts.Clear();
    std::error_code ignored;
    for (const char* path : k_fonts)
        if (std::filesystem::exists(path, ignored) && fonts.AddFontFromFileTTF(path, k_font_px * scale))
            return true;
    ImFontConfig config;
    config.SizePixels = 13.0f * scale;
    fonts.AddFontDefault(&config);
    return false;
}

void draw_panels(Session& session, Tools& tools, const EditorView& view, const ViewFigures& figures,
                 PanelState& state) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float bar_px = ImGui::GetFrameHeight() + 8.0f * state.scale;
    const float side_px = std::min(312.0f * state.scale, size.x * 0.45f);
    const ImGuiWindowFlags fixed = ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                                   ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoTitleBar |
                                   ImGuiWindowFlags_NoBringToFrontOnFocus;

    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize({size.x, bar_px});
    ImGui::Begin("bar", nullptr, fixed | ImGuiWindowFlags_NoScrollbar);
    const Edit *undo = session.history().next_undo(), *redo = session.history().next_redo();
    if (ImGui::Button(session.saved() ? "Save" : "Save *")) state.wants_save = true;
    ImGui::SameLine();
    if (ImGui::Button(undo ? ("Undo " + undo->name + "###undo").c_str() : "Undo###undo")) {
        tools.stop(session);
        tools.forget_selection();
        session.undo();
    }
    ImGui::SameLine();
    if (ImGui::Button(redo ? ("Redo " + redo->name + "###redo").c_str() : "Redo###redo")) {
        tools.stop(session);
        tools.forget_selection();
        session.redo();
    }
    ImGui::SameLine();
    if (ImGui::Checkbox("dark", &state.dark)) apply_theme(state.dark, state.scale);
    ImGui::SameLine();
    ImGui::Checkbox("shadows", &state.shadows);
    ImGui::SameLine();
    if (ImGui::Button("Keys")) state.help = !state.help;
    ImGui::SameLine();
    const std::string& said = tools.message.empty() ? state.note : tools.message;
    text(said);
    ImGui::End();

    ImGui::SetNextWindowPos({0, bar_px});
    ImGui::SetNextWindowSize({side_px, size.y - 2.0f * bar_px});
    ImGui::Begin("left", nullptr, fixed);
    ImGui::PushItemWidth(side_px * 0.55f);
    draw_tools(session, tools);
    ImGui::Separator();
    draw_populations(session, tools, view, figures, state);
    if (ImGui::CollapsingHeader("rules")) draw_rules(session, tools);
    ImGui::PopItemWidth();
    ImGui::End();

    ImGui::SetNextWindowPos({size.x - side_px * 0.8f, bar_px});
    ImGui::SetNextWindowSize({side_px * 0.8f, size.y - 2.0f * bar_px});
    ImGui::Begin("right", nullptr, fixed);
    ImGui::PushItemWidth(side_px * 0.45f);
    if (ImGui::CollapsingHeader("tiles", ImGuiTreeNodeFlags_DefaultOpen))
        draw_tiles(session, tools, figures, state);
    if (ImGui::CollapsingHeader("done", ImGuiTreeNodeFlags_DefaultOpen)) draw_history(session, tools);
    const bool faulty =
        !session.document().faults().empty() || !view.faults().empty() || !state.warnings.empty();
    if (faulty && ImGui::CollapsingHeader("faults", ImGuiTreeNodeFlags_DefaultOpen))
        draw_faults(view, session, state);
    ImGui::PopItemWidth();
    ImGui::End();

    ImGui::SetNextWindowPos({0, size.y - bar_px});
    ImGui::SetNextWindowSize({size.x, bar_px});
    ImGui::Begin("status", nullptr, fixed | ImGuiWindowFlags_NoScrollbar);
    std::string line = fmt::format("{:5.1f} ms   {:4.0f} Hz   d' {:.2f} px   {} vertices", figures.frame_ms,
                                   1000.0 / std::max(figures.frame_ms, 1e-3), figures.sample_distance_px,
                                   short_number(double(figures.vertices)));
    if (figures.cursor)
        line += fmt::format("   at {:.1f}, {:.1f}, {:.1f} m", figures.cursor->x, figures.cursor->y,
                            figures.cursor->z);
    text(line);
    ImGui::End();

    if (state.help) {
        ImGui::SetNextWindowPos({size.x * 0.5f, size.y - bar_px * 1.5f}, ImGuiCond_Always, {0.5f, 1.0f});
        ImGui::Begin("keys", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize);
        ImGui::TextUnformatted(k_help);
        ImGui::End();
    }
    draw_questions(session, state);
}

}  // namespace coppice
