// Draws a work list into the visibility buffer by compute kernels and resolves it to a picture (DESIGN section 4).
// Knows geometry, instances and entries; not plants.
#pragma once
#include <algorithm>
#include <array>
#include <memory>
#include <vector>
#include "plugins/vegetation/components.h"
#include "plugins/vegetation/draw/host_picture.h"
#include "plugins/vegetation/draw/work_list.h"
#include "plugins/vegetation/shadow/shadow_view.h"
#include "runtime/frame/frame_graph.h"
#include "runtime/gpu/pipeline.h"
#include "runtime/gpu/retired_buffers.h"

namespace coppice {

// All vertices of a scene in one buffer: triangles' (three each), points, lines' (two each); and points' owners.
struct GeometryData {
    std::span<const PackedVertex> vertices;
    std::span<const uint32_t> owners;
    uint32_t reserved_points = 0;  // room behind both for points and owners that come later
    bool has_tints = false;        // all instances of plants carry theirs (set_tint)
};

// How the frame's surfaces become a picture.
struct PictureSettings {
    RepresentationView view = RepresentationView::lit;
    vec2 shift_px{0.0f};  // where in the pixel it is sampled, from its centre: right and down
    // Share of this frame in the mean that is kept and shown, (0, 1]; 1 forgets those before. 0: nothing is kept.
    float new_share = 0.0f;
    float filter_radius_px =
        1.0f;  // of the tent that weighs samples, [1, 2]; 1: each pixel is its own sample
    // Drawn into in place of color(); nothing is kept then. Requires make_host_picture of it. nullptr: none.
    const HostPicture* host = nullptr;
};

// A map that is drawn in this frame.
struct ShadowMapDraw {
    uint32_t map;  // where, of the k_most_work_maps places
    ShadowView view;
    vec4 viewer;  // what casters' sizes in pixels refer to: the view's axis; w: Frustum::corner_cos
    float least_distance_m = 0.0f;  // likewise, from nearer than that
};

// The frame's shadow maps. Spans hold until the frame has been set.
struct ShadowSettings {
    uint32_t side_texels = 0;                // of each; 0: none, and no pass is made
    std::span<const ShadowMapDraw> drawn;    // the i-th by WorkList::Layout::maps[i]; others stay as they are
    // Of the maps that points are looked up in, a single one or nested ones, in places first_map, first_map + 1, ... and, behind the
    // last of k_most_work_maps, 0: each of the nested ones for what is up to twice as far from the viewer as the one before, with texels twice as large, and w = 1.
    std::span<const ShadowView> seen;
    uint32_t first_map = 0;
    float first_reach_m = 0.0f;  // the distance that the first of nested ones is for
    float first_texel_m = 0.0f;  // its texels'
    bool is_nested() const { return first_texel_m > 0.0f; }
    float far_m = 1000.0f;       // along the view; shadows fade before
};

// Of each kind by groups and by lanes.
struct RasterPipelines {
    std::array<gpu::Pipeline, k_work_kinds> groups, lanes;
    gpu::Pipeline big_triangles;
};

class Rasteriser {
  public:
    ~Rasteriser();  // waits for the device, where the host does not keep its queue: then it has finished all frames
    static Result<std::unique_ptr<Rasteriser>> create(const gpu::Device& device, FrameGraph& graph,
                                                      uint32_t frame_slots, uint32_t width, uint32_t height);

    // The device has finished the slot's last frame. Before any other call for the slot's next one.
    void begin_slot(uint32_t slot) { retired_.begin_slot(slot); }

    // Waits for the device; where the host keeps its queue, the geometry comes with the next frame recorded. Needs room beside
    // the old one. Errors: limit_exceeded, device_lost; the old one stays.
    Status set_geometry(const GeometryData& data);
    Status resize(uint32_t width, uint32_t height);  // errors: value_out_of_range, limit_exceeded

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
    // Makes room for more. Contents are lost.
    Status grow(uint32_t slot, uint32_t instance_count, uint32_t entry_count);
    // Requires make_shadow_map of the shadow's size.
    void set_frame(uint32_t slot, const WorkList::Layout& layout, const Camera& camera, const Light& light,
                   const PictureSettings& picture, const ShadowSettings& shadow = {});
    // A frame that draws nothing: the picture stays as it is.
    void skip_frame();
    // Makes room for the mean of frames. Errors: limit_exceeded where the device takes no buffer of 12 bytes a pixel.
    Status keep_radiance();
    // Room for shadow maps of that side, 0: none; when it changes they hold nothing. At most
    // k_most_work_maps. Errors: limit_exceeded, device_lost; the maps before stay.
    Status make_shadow_maps(uint32_t side_texels, uint32_t count);
    // Makes room for the host's picture. Errors: HostComposite::prepare's, keep_radiance's.
    Status make_host_picture(const HostPicture& picture);

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    const gpu::Buffer& color() const { return color_; }
    const gpu::Buffer& visibility() const { return picture_.image; }
    // One map behind the other: depths as bits of floats, 1 nearest to the sun, 0 nothing; rows from the first.
    const gpu::Buffer& shadow_maps() const { return shadows_.image; }
    // Large triangles that found no room in the list of the last finished frame of this slot.
    uint32_t dropped_triangles() const { return dropped_triangles_; }
    // Likewise, of shadow maps: these lack something that there is room for now.
    bool dropped_shadows() const { return dropped_shadows_; }
    ResourceIndex color_resource() const { return color_resource_; }
    uint64_t gpu_bytes() const;

  private:
    struct RasterConstants {
        vec4 row_x, row_y, row_w, row_z, to_sun, viewer;
        vec2 size_px;
        float near_w, metres_a_pixel;
        uint32_t first_entry, entry_count, view, big_triangle_limit;
    };
    // An image of a target that is drawn in the frame about to be recorded.
    struct TargetImage {
        RasterConstants constants{};
        WorkRanges ranges;
        VkDeviceSize first_byte = 0, size_bytes = VK_WHOLE_SIZE;  // of the target's buffer
    };
    // The picture, or the shadow maps.
    struct Target {
        bool is_shadow = false;
        gpu::Buffer image, big_triangles;  // the latter a list for each image that can be drawn in a frame
        uint32_t big_limit = 0, most_images = 1;
        VkDeviceSize big_bytes() const { return 16 + 8 * VkDeviceSize(big_limit); }  // of one list
        ResourceIndex image_resource = 0, big_resource = 0;
        const RasterPipelines* pipelines = nullptr;
        uint32_t clear_pass = 0, big_pass = 0;
        std::array<uint32_t, k_work_kinds> draw_passes{};
        std::array<TargetImage, k_most_work_maps> images;
        size_t image_count = 0;
        bool any(WorkKind kind) const {
            return std::any_of(images.begin(), images.begin() + image_count,
                               [kind](const TargetImage& of) { return of.ranges.any(kind); });
        }
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
    Rasteriser(const gpu::Device& device, FrameGraph& graph, uint32_t frame_slots)
        : device_(device), graph_(graph), retired_(frame_slots), host_(device, graph) {}
    Status stage_geometry(const gpu::Buffer& target, std::span<const std::byte> bytes, gpu::Buffer& staging);
    Status make_pipelines();
    Status make_raster_pipelines(RasterPipelines& pipelines, bool shadow, bool tinted);
    Status make_shadow_pipelines();
    // shadow_maps: 0, 1 or, for several, 2.
    Result<gpu::Pipeline> make_resolve(const char* name, bool mean, uint32_t shadow_maps) const;
    Result<gpu::Pipeline> make_accumulate(const char* name, uint32_t shadow_maps) const;
    Status make_big_triangles(Target& target, uint32_t limit);
    void read_big_counts(uint32_t slot);
    void add_passes();
    void add_raster_passes(Target& target, std::span<const char* const> names);
    void copy_staged_geometry(VkCommandBuffer commands);
    uint32_t resolve_groups() const;
    void draw(VkCommandBuffer commands, const Target& target, WorkKind kind);
    void draw_big_triangles(VkCommandBuffer commands, const Target& target);
    void set_shadows(const WorkList::Layout& layout, const Light& light, float focal_px, const ShadowSettings& shadow);
    void set_light(const Light& light, const ShadowSettings& shadow);
    void set_active(const Target& target);

    const gpu::Device& device_;
    FrameGraph& graph_;
    uint32_t width_ = 0, height_ = 0;
    gpu::RetiredBuffers retired_;
    HostComposite host_;
    Target picture_, shadows_;
    gpu::Buffer color_, radiance_, vertices_, owners_;
    gpu::Buffer staged_vertices_, staged_owners_;  // of a whole scene, for the next frame that is recorded
    std::vector<Slot> slots_;
    // By how many shadow maps are looked up: none, one, several.
    std::array<gpu::Pipeline, 3> resolve_pipelines_, accumulate_pipelines_;
    gpu::Pipeline resolve_mean_pipeline_;
    // The tinted ones are made for the first scene that has tints: others neither wait for them nor pay for them.
    RasterPipelines picture_pipelines_, tinted_pipelines_, shadow_pipelines_;
    bool has_tints_ = false, has_tinted_pipelines_ = false;
    ResourceIndex color_resource_ = 0, radiance_resource_ = 0, vertices_resource_ = 0, owners_resource_ = 0,
                  big_count_resource_ = 0;
    uint32_t upload_pass_ = 0, big_count_pass_ = 0, accumulate_pass_ = 0, resolve_pass_ = 0;
    uint32_t dropped_triangles_ = 0;
    bool dropped_shadows_ = false;
    uint32_t shadow_side_texels_ = 0;

    // Of the frame about to be recorded.
    uint32_t slot_ = 0;
    size_t seen_maps_ = 0;  // 0: no shadows, 1, or 2: several
    bool has_shadow_pipelines_ = false;
    std::vector<VkBufferCopy> vertex_uploads_, owner_uploads_;
    uint64_t upload_bytes_ = 0;  // of the ring of upload_slot_
    uint32_t upload_slot_ = 0;
    ResolveConstants resolve_{};
};

}  // namespace coppice
