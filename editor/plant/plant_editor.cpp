#include "editor/plant/plant_editor.h"

#include <algorithm>
#include "editor/view/base_scene.h"

namespace coppice {

Result<std::unique_ptr<PlantEditor>> PlantEditor::open(Registry& registry, const Session& session,
                                                   const std::string& population, const gpu::Device& device,
                                                   const PlantWork::Settings& work, uint32_t width, uint32_t height) {
    const auto& json = session.document().root().text->json;
    const auto plants = json.find("plants");
    std::unique_ptr<PlantEditor> view(new PlantEditor);
    if (plants != json.end() && plants->is_object())
        if (const auto entry = plants->find(population); entry != plants->end() && entry->is_object())
            if (const auto source = entry->find("source"); source != entry->end() && source->is_string())
                view->path_ = Document::resolve(session.document().root_path(), source->get<std::string>());
    if (view->path_.empty())
        return fail(ErrorId::name_unknown, session.document().root_path(), "plants",
                    "'" + population + "' has no source", "a population of the scene");
    if (view->path_.ends_with(".plant"))
        return fail(ErrorId::value_out_of_range, view->path_, "", "is packed: its parts are what they were cooked to",
                    "name the species or model that it was cooked from");
    view->population_ = population;
    COPPICE_TRY(view->stage_, PlantStage::create(device, registry, width, height));
    view->work_ = std::make_unique<PlantWork>(work);
    view->follow(session);
    return view;
}

void PlantEditor::follow(const Session& session) {
    if (session.text_version() != seen_version_) {
        seen_version_ = session.text_version();
        auto settings = part_settings_in(session.document(), path_);
        if (!settings) {
            fault_ = to_string(settings.error());
        } else if (!started_ || *settings != settings_) {
            started_ = true;
            settings_ = std::move(*settings);
            work_->start({path_, variation_, settings_});
        }
    }
    std::optional<Result<Plant>> cooked = work_->take_plant();
    if (!cooked) return;
    if (!*cooked) {
        fault_ = to_string(cooked->error());
        return;
    }
    tried_.clear();
    plant_ = std::move(**cooked);
    const Status shown = stage_->show(*plant_);
    fault_ = shown ? "" : to_string(shown.error());
}

void PlantEditor::try_importance(uint32_t part, float importance) {
    if (!plant_) return;
    tried_[part] = importance;
    if (Status shown = stage_->show(*plant_, tried_); !shown) fault_ = to_string(shown.error());
}

PartSettings PlantEditor::settings_of(const std::string& part) const {
    const auto found = std::ranges::find(settings_, part, &PartSettings::name);
    return found == settings_.end() ? PartSettings{part} : *found;
}

PartChoice PlantEditor::choice_at(uint32_t part, float height_px) const {
    PackedPart packed = plant_->parts[part];
    if (const auto tried = tried_.find(part); tried != tried_.end()) packed.importance = tried->second;
    LeafLevels leaves;
    for (const PackedCrown& crown : plant_->crowns)
        if (crown.part == part) leaves = {crown.full_count, crown.least_count};
    const float height_m = std::max(plant_->bounds_plant.size().y, 1e-4f);
    return choose_part(packed, {vec3(0.0f, 0.0f, -1.0f), height_px / height_m}, FrameSettings{}, 0.5f, leaves);
}

}  // namespace coppice
