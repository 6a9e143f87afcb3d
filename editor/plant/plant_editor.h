// The levels of detail of one plant, as they are set and as they look: the editor that Deussen et al. 2002 describe (4.3).
#pragma once
#include "editor/plant/plant_stage.h"
#include "editor/plant/plant_work.h"
#include "editor/session/session.h"

namespace coppice {

class PlantEditor {
  public:
    // Of a population of the session's root, whose source is no packed plant. Errors: name_unknown, value_out_of_range;
    // PlantStage::create's.
    static Result<std::unique_ptr<PlantEditor>> open(Registry& registry, const Session& session,
                                                   const std::string& population, const gpu::Device& device,
                                                   const PlantWork::Settings& work, uint32_t width, uint32_t height);

    // What the document says by now is cooked, and what has been cooked is shown.
    void follow(const Session& session);
    // Until the plant has been cooked with it.
    void try_importance(uint32_t part, float importance);

    const std::string& population() const { return population_; }
    // As the document has them; of a part that nothing is set of, automatic.
    PartSettings settings_of(const std::string& part) const;
    const std::optional<Plant>& plant() const { return plant_; }
    const PlantWork& work() const { return *work_; }
    PlantStage& stage() { return *stage_; }
    const PlantStage& stage() const { return *stage_; }
    const std::string& fault() const { return fault_; }  // why the plant is not what was set; empty: it is

    // What the part is drawn as where the plant is that tall, seen from the side.
    PartChoice choice_at(uint32_t part, float height_px) const;

    StageView view;

  private:
    PlantEditor() = default;
    std::string population_, path_;
    uint64_t variation_ = 0, seen_version_ = UINT64_MAX;
    std::vector<PartSettings> settings_;
    bool started_ = false;
    std::unique_ptr<PlantWork> work_;
    std::unique_ptr<PlantStage> stage_;
    std::optional<Plant> plant_;
    std::map<uint32_t, float> tried_;
    std::string fault_;
};

}  // namespace coppice
