// The document drawn by the renderer that games have: a scene, and the plants under the brush as loose tiles.
#pragma once
#include <memory>
#include "editor/session/session.h"
#include "editor/view/base_scene.h"
#include "plugins/vegetation/vegetation.h"
#include "runtime/frame/frame_graph.h"
#include "runtime/gpu/commands.h"
#include "runtime/plugin/registry.h"

namespace coppice {

struct EditorViewSettings {
    uint32_t width = 1280, height = 800;
    std::string cache_dir, device;
    bool validation = false;
    std::vector<const char*> present_extensions;  // none: pictures go to no window
};

// One thread at a time.
class EditorView {
  public:
    // Loads the plugins it needs into the registry, which must outlive it.
    static Result<std::unique_ptr<EditorView>> create(Registry& registry, Session& session,
                                                      const EditorViewSettings& settings);
    ~EditorView();

    // Shows what the document has become since the last call. Errors: those of a scene of which nothing loads; what was shown
    // stays then, and it is tried again when it has changed. Of plants that find no room: these are tried again each time.
    Status follow(Session& session);

    // Runs the systems and records the passes; the caller submits.
    Result<gpu::CommandRing::Frame> begin_frame(const Camera& camera, const FrameSettings& settings);
    // How long the last whole frame took, for the budget.
    void tell_frame_ms(double ms);
    Status resize(uint32_t width, uint32_t height);

    const std::vector<Error>& faults() const { return faults_; }
    // Triangles of all variations of a kind, in the mean; 0: not known.
    double triangles_of(const std::string& kind) const;
    // Of all variations of a kind, in the mean; 0: not known.
    double crown_width_m(const std::string& kind) const;
    // At scale 1, metres.
    Box bounds_of(const PlacedPlant& plant, const Document& document) const;
    size_t base_plant_count(const std::string& kind) const;
    const std::vector<CameraKey>& camera_path() const { return camera_path_; }
    float sample_distance_px() const { return sample_distance_px_; }
    const BaseSceneSettings& base_settings() const { return base_settings_; }
    struct Times {
        double scene_ms = 0.0, plants_ms = 0.0, tiles_ms = 0.0, upload_ms = 0.0, loose_ms = 0.0;
    };
    const Times& times() const { return times_; }

    std::unique_ptr<gpu::Device> device;
    gpu::CommandRing ring;
    std::unique_ptr<Vegetation> vegetation;
    uint32_t width = 0, height = 0;

  private:
    EditorView() = default;
    Status show_base(const Session& session);
    Status show_cell(const Session& session, PlantCell cell);
    const PlantKind& kind_of(const std::string& name) const;

    static constexpr uint32_t k_frame_slots = 2;
    BaseSceneSettings base_settings_;
    World world_;
    Schedule schedule_{world_};
    FrameGraph graph_;
    std::map<std::string, PlantKind> kinds_;
    PlantKind box_;
    std::vector<Box> bounds_of_model_;
    std::vector<uint64_t> triangles_of_model_;
    std::map<std::string, size_t> base_counts_;
    std::vector<CameraKey> camera_path_;
    float sample_distance_px_ = 1.0f;
    std::vector<Error> faults_;
    uint64_t base_hash_ = 0, edit_hash_ = 0;
    bool shown_ = false;
    std::set<PlantCell> unshown_;  // changed since they were shown, or never
    uint32_t last_slot_ = 0;
    Times times_;
};

}  // namespace coppice
