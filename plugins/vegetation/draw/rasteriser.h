// Draws a work list into the visibility buffer by compute kernels and resolves it to a picture (DESIGN section 4).
// Knows geometry, instances and entries; not plants.
#pragma once
#include <array>
#include <memory>
#include <vector>
#include "plugins/vegetation/components.h"
#include "plugins/vegetation/draw/work_list.h"
#include "plugins/vegetation/shadow/shadow_view.h"
#include "runtime/frame/frame_graph.h"
#include "runtime/gpu/pipeline.h"

namespace coppice {

// All vertices of a scene in one buffer: triangles' (three each), points, lines' (two each); and points' owners.
struct GeometryData {
    std::span<const PackedVertex> vertices;
    std::span<const uint32_t> owners;
    uint32_t reserved_points = 0;  // room behind both for points and owners that come later
};

// How the frame's surfaces become a picture.
struct PictureSettings {
    RepresentationView view = RepresentationView::lit;
    vec2 shift_px{0.0f};  // where in the pixel it is sampled, from its centre: right and down
    // Share of this frame in the mean that is kept and shown, (0, 1]; 1 forgets those before. 0: nothing is kept.
    float new_share = 0.0f;
    float filter_radius_px =
        1.0f;  // of the tent that weighs samples, [1, 2]; 1: each pixel is its own sample
};

// The frame's shadow map.
struct ShadowSettings {
    uint32_t side_texels = 0;  // 0: none, and no pass is made
    ShadowView view{};
    float far_m = 1000.0f;  // along the view; shadows fade before
};

class Rasteriser {
  public:
    ~Rasteriser();  // waits for the device
    static Result<std::unique_ptr<Rasteriser>> create(const gpu::Device& device, FrameGraph& graph,
                                                      uint32_t frame_slots, uint32_t width, uint32_t height);

    // Both wait for the device. Errors: limit_exceeded, device_lost.
    Status set_geometry(const GeometryData& data);
    Status resize(uint32_t width, uint32_t height);

    // Points and their owners into the room that was reserved, by this slot's frame, before it draws: through a ring of
    // mapped memory. False: no more room in the ring for this frame, or what another slot staged was never recorded. Requires places inside the geometry.
    bool stream_points(uint32_t slot, uint32_t first_vertex, std::span<const PackedVertex> points,
                       uint32_t first_owner, std::span<const uint32_t> owners);
    // The same at once; waits for the device.
    Status upload_points(uint32_t first_vertex, std::span<const PackedVertex> points, uint32_t first_owner,
                         std::span<const uint32_t> owners);

    // One frame: choose the slot, write into its mapped buffers, then say what was written. The passes are recorded
    // when the frame graph is.
    std::span<WorkInstance> instances(uint32_t slot) {
        return slots_[slot].instances.mapped_as<WorkInstance>();
    }
    std::span<WorkEntry> entries(uint32_t slot) { return slots_[slot].entries.mapped_as<WorkEntry>(); }
    // Makes room for more; waits for the device. Contents are lost.
    Status grow(uint32_t slot, uint32_t instance_count, uint32_t entry_count);
    // Requires make_shadow_map of the shadow's size.
    void set_frame(uint32_t slot, const WorkList::Layout& layout, const Camera& camera, const Light& light,
                   const PictureSettings& picture, const ShadowSettings& shadow = {});
    // A frame that draws nothing: the picture stays as it is.
    void skip_frame();
    // Makes room for the mean of frames; waits for the device the first time at a size. Errors: limit_exceeded where the
    // device takes no buffer of 12 bytes a pixel.
    Status keep_radiance();
    // Room for a shadow map of that side, 0: none; waits for the device when it changes. Errors: limit_exceeded, device_lost; the map
    // before stays.
    Status make_shadow_map(uint32_t side_texels);

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    const gpu::Buffer& color() const { return color_; }
    const gpu::Buffer& visibility() const { return picture_.image; }
    // Depths as bits of floats, 1 nearest to the sun, 0 nothing; rows from the first.
    const gpu::Buffer& shadow_map() const { return shadows_.image; }
    // Large triangles that found no room in the list of the last finished frame of this slot.
    uint32_t dropped_triangles() const { return dropped_triangles_; }
    ResourceIndex color_resource() const { return color_resource_; }
    uint64_t gpu_bytes() const;

  private:
    struct RasterConstants {
        vec4 row_x, row_y, row_w, row_z, to_sun, viewer;
        vec2 size_px;
        float near_w, metres_a_pixel;
        uint32_t first_entry, entry_count, view, big_triangle_limit;
    };
    // Into the picture, or into the shadow map.
    struct Target {
        bool is_shadow = false;
        gpu::Buffer image, big_triangles;
        uint32_t big_limit = 0;
        ResourceIndex image_resource = 0, big_resource = 0;
        std::array<gpu::Pipeline, k_work_kinds> group_pipelines, lane_pipelines;
        gpu::Pipeline big_pipeline;
        uint32_t clear_pass = 0, big_pass = 0;
        std::array<uint32_t, k_work_kinds> draw_passes{};
        RasterConstants constants{};  // of the frame about to be recorded
        WorkRanges ranges;            // likewise
    };
    struct ResolveConstants {
        vec4 right, up, forward;
        vec2 shift_px;
        uint32_t view;
        float new_share, side_weight;
    };
    struct Slot {
        gpu::Buffer instances, entries, light;
        gpu::Buffer uploads;  // what is streamed in
        gpu::Buffer
            big_count;  // how many large triangles picture and shadows had; read when the slot comes round again
    };
    Rasteriser(const gpu::Device& device, FrameGraph& graph) : device_(device), graph_(graph) {}
    Status make_pipelines();
    Status make_raster_pipelines(Target& target);
    Status make_shadow_pipelines();
    Result<gpu::Pipeline> make_resolve(const char* name, bool mean, bool shadowed) const;
    Result<gpu::Pipeline> make_accumulate(const char* name, bool shadowed) const;
    Status make_big_triangles(Target& target, uint32_t limit);
    void read_big_counts(uint32_t slot);
    void add_passes();
    void add_raster_passes(Target& target, std::span<const char* const> names);
    uint32_t resolve_groups() const;
    void draw(VkCommandBuffer commands, const Target& target, WorkKind kind);
    void set_active(const Target& target);

    const gpu::Device& device_;
    FrameGraph& graph_;
    uint32_t width_ = 0, height_ = 0;
    Target picture_, shadows_;
    gpu::Buffer color_, radiance_, vertices_, owners_;
    std::vector<Slot> slots_;
    gpu::Pipeline resolve_pipeline_, resolve_shadowed_pipeline_, resolve_mean_pipeline_, accumulate_pipeline_,
        accumulate_shadowed_pipeline_;
    ResourceIndex color_resource_ = 0, radiance_resource_ = 0, vertices_resource_ = 0, owners_resource_ = 0,
                  big_count_resource_ = 0;
    uint32_t upload_pass_ = 0, big_count_pass_ = 0, accumulate_pass_ = 0, resolve_pass_ = 0;
    uint32_t dropped_triangles_ = 0;

    // Of the frame about to be recorded.
    uint32_t slot_ = 0;
    bool has_shadows_ = false, has_shadow_pipelines_ = false;
    std::vector<VkBufferCopy> vertex_uploads_, owner_uploads_;
    uint64_t upload_bytes_ = 0;  // of the ring of upload_slot_
    uint32_t upload_slot_ = 0;
    ResolveConstants resolve_{};
};

}  // namespace coppice
