#include "plugins/vegetation/draw/rasteriser.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <utility>
#include "plugins/vegetation/cull/frustum.h"
#include "runtime/core/log.h"
#include "runtime/gpu/vulkan.h"
#include "shaders/accumulate.comp.h"
#include "shaders/raster_big_triangles.comp.h"
#include "shaders/raster_leaves.comp.h"
#include "shaders/raster_lines.comp.h"
#include "shaders/raster_triangles.comp.h"
#include "shaders/resolve.comp.h"
#include "shaders/splat_points.comp.h"

namespace coppice {
namespace {

// So that lists of them can follow each other in a buffer (gpu::k_range_alignment_bytes).
constexpr uint32_t big_limit_from(uint64_t count) { return uint32_t(std::min<uint64_t>(count | 31, UINT32_MAX)) - 1; }
constexpr uint32_t k_first_big_triangles = big_limit_from(1u << 18), k_first_big_shadows = big_limit_from(1u << 16);
constexpr uint32_t k_first_instances = 1u << 14, k_first_entries = 1u << 16;
constexpr uint32_t k_no_pass = UINT32_MAX;  // of a kind that a target has none of
constexpr uint64_t k_pixel_radiance_bytes = 12;
constexpr uint64_t k_upload_bytes = uint64_t(4) << 20;  // of a frame: what 25 tiles' clouds take
constexpr uint32_t k_pixels_a_group = 256;              // accumulate.comp's k_run
// Of resolve.comp. A CPU wants few borders of blocks, a GPU many blocks.
constexpr uint32_t k_cpu_columns = 4, k_cpu_rows = 64, k_gpu_columns = 1, k_gpu_rows = 16;

struct LightBlock {
    vec4 to_sun, sun_color, zenith_color, horizon_color, ground_color, haze_color;
    vec4 shadow_x, shadow_y, shadow_z, shadow_w, sun_across, sun_along, shadow_growth_xy, shadow_growth_wz;
    vec4 nested;  // of several maps: the first's reach and texels, m, its place, and how many follow it
    // Of nested maps, in their order: columns, rows and depths; and, where all are of one sun, those of the viewer and how depths
    // grow, beside the first map's.
    vec4 nested_rows[3 * k_most_work_maps], nested_viewers[k_most_work_maps];
};

gpu::BufferSettings device_buffer(VkDeviceSize size_bytes, const char* name) {
    gpu::BufferSettings settings;
    settings.size_bytes = size_bytes;
    settings.name = name;
    return settings;
}

gpu::BufferSettings texel_buffer(VkDeviceSize size_bytes, VkFormat format, gpu::MemoryUse memory,
                                 const char* name) {
    gpu::BufferSettings settings = device_buffer(std::max<VkDeviceSize>(size_bytes, 16), name);
    settings.usage |= VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT;
    settings.texel_format = format;
    settings.memory = memory;
    return settings;
}

}  // namespace

Result<std::unique_ptr<Rasteriser>> Rasteriser::create(const gpu::Device& device, FrameGraph& graph,
                                                       uint32_t frame_slots, uint32_t width,
                                                       uint32_t height) {
    frame_slots = std::clamp(frame_slots, 1u, 32u);
    std::unique_ptr<Rasteriser> rasteriser(new Rasteriser(device, graph, frame_slots));
    rasteriser->slots_.resize(frame_slots);
    rasteriser->shadows_.is_shadow = true;
    COPPICE_CHECK(rasteriser->make_pipelines());
    for (uint32_t slot = 0; slot < rasteriser->slots_.size(); ++slot) {
        gpu::BufferSettings light = device_buffer(sizeof(LightBlock), "light");
        light.memory = gpu::MemoryUse::upload;
        COPPICE_TRY(rasteriser->slots_[slot].light, gpu::Buffer::create(device, light));
        gpu::BufferSettings count = device_buffer((1 + k_most_work_maps) * sizeof(uint32_t), "big count");
        count.memory = gpu::MemoryUse::readback;
        COPPICE_TRY(rasteriser->slots_[slot].big_count, gpu::Buffer::create(device, count));
        std::ranges::fill(rasteriser->slots_[slot].big_count.mapped_as<uint32_t>(), 0u);
        COPPICE_CHECK(rasteriser->grow(slot, k_first_instances, k_first_entries));
    }
    COPPICE_CHECK(rasteriser->make_big_triangles(rasteriser->picture_, k_first_big_triangles));
    COPPICE_CHECK(rasteriser->make_shadow_maps(0, 0));
    COPPICE_CHECK(rasteriser->set_geometry({}));
    COPPICE_CHECK(rasteriser->resize(width, height));
    rasteriser->add_passes();
    return rasteriser;
}

Rasteriser::~Rasteriser() { device_.wait_idle(); }

Status Rasteriser::make_big_triangles(Target& target, uint32_t limit) {
    const uint64_t room = device_.limits.storage_range_bytes / 8 / target.most_images;
    const uint32_t count = limit == 0 ? 0 : big_limit_from(std::min<uint64_t>(limit, room - 64));
    const VkDeviceSize size_bytes = (16 + 8ull * count) * target.most_images;
    if (size_bytes == target.big_triangles.size_bytes()) return {};
    COPPICE_TRY(gpu::Buffer list, gpu::Buffer::create(device_, device_buffer(size_bytes, "big triangles")));
    retired_.keep(std::exchange(target.big_triangles, std::move(list)));
    target.big_limit = count;
    return {};
}

void Rasteriser::read_big_counts(uint32_t slot) {
    dropped_triangles_ = 0;
    dropped_shadows_ = false;
    const std::span<const uint32_t> counts = slots_[slot].big_count.mapped_as<uint32_t>();
    for (Target* target : {&picture_, &shadows_}) {
        const auto of = target->is_shadow ? counts.subspan(1) : counts.first(1);
        const uint32_t count = *std::ranges::max_element(of);
        if (count <= target->big_limit) continue;
        for (uint32_t each : of) dropped_triangles_ += each - std::min(each, target->big_limit);
        const uint64_t wanted = std::min<uint64_t>(uint64_t(count) + count / 2, UINT32_MAX);
        const uint32_t limit = target->big_limit;
        if (auto grown = make_big_triangles(*target, uint32_t(wanted)); !grown)
            log_warning("{}", to_string(grown.error()));
        // Where there is no more room, maps that are drawn again would lack as much.
        dropped_shadows_ = dropped_shadows_ || (target->is_shadow && target->big_limit > limit);
    }
}

namespace {

using gpu::BindingKind;
constexpr BindingKind k_point_bindings[] = {BindingKind::storage, BindingKind::texel, BindingKind::texel,
                                            BindingKind::texel, BindingKind::texel};
constexpr BindingKind k_line_bindings[] = {BindingKind::storage, BindingKind::texel, BindingKind::texel,
                                           BindingKind::texel};
constexpr BindingKind k_triangle_bindings[] = {BindingKind::storage, BindingKind::texel, BindingKind::texel,
                                               BindingKind::texel, BindingKind::storage};
constexpr BindingKind k_resolve_bindings[] = {BindingKind::storage, BindingKind::storage,
                                              BindingKind::storage, BindingKind::storage,
                                              BindingKind::storage};

Result<gpu::Pipeline> make_pipeline(const gpu::Device& device, const char* name,
                                    std::span<const uint32_t> spirv, std::span<const BindingKind> bindings,
                                    uint32_t constant_bytes, std::initializer_list<uint32_t> specialization) {
    std::vector<uint32_t> values(specialization);
    return gpu::Pipeline::create(device, {name, spirv, bindings, constant_bytes, values});
}

}  // namespace

Status Rasteriser::make_raster_pipelines(RasterPipelines& made, bool is_shadow, bool is_tinted) {
    const uint32_t lanes = device_.limits.group_size, shadow = is_shadow ? 1 : 0, tinted = is_tinted ? 1 : 0;
    auto make = [&](const char* name, std::span<const uint32_t> spirv, std::span<const BindingKind> bindings,
                    std::initializer_list<uint32_t> specialization) {
        return make_pipeline(device_, name, spirv, bindings, sizeof(RasterConstants), specialization);
    };
    for (uint32_t small = 0; small < 2; ++small) {
        auto& pipelines = small ? made.lanes : made.groups;
        auto points = [&](WorkKind kind, const char* name, uint32_t side_limit, uint32_t blend) -> Status {
            COPPICE_TRY(pipelines[size_t(kind)], make(name, k_splat_points_spirv, k_point_bindings,
                                                      {lanes, small, side_limit, blend, shadow, tinted}));
            return {};
        };
        if (!is_shadow) {
            COPPICE_CHECK(points(WorkKind::points_1, "points, one pixel", 1, 0));
            COPPICE_CHECK(points(WorkKind::points_2, "points, up to two pixels", 2, 0));
        }
        COPPICE_CHECK(points(WorkKind::points_any, "points, any size", 0, 0));
        COPPICE_CHECK(points(WorkKind::points_blend, "points, blended", 0, 1));
        COPPICE_TRY(pipelines[size_t(WorkKind::lines)],
                    make("lines", k_raster_lines_spirv, k_line_bindings, {lanes, small, 0, 0, shadow, tinted}));
        COPPICE_TRY(pipelines[size_t(WorkKind::leaves)],
                    make("leaves", k_raster_leaves_spirv, k_line_bindings, {lanes, small, 0, 0, shadow, tinted}));
        COPPICE_TRY(
            pipelines[size_t(WorkKind::triangles)],
            make("triangles", k_raster_triangles_spirv, k_triangle_bindings, {lanes, small, 0, 0, shadow, tinted}));
    }
    COPPICE_TRY(made.big_triangles, make("big triangles", k_raster_big_triangles_spirv, k_triangle_bindings,
                                          {lanes, 0, 0, 0, shadow, tinted}));
    return {};
}

Result<gpu::Pipeline> Rasteriser::make_resolve(const char* name, bool mean, uint32_t shadow_maps) const {
    const bool is_cpu = device_.limits.is_cpu;
    return make_pipeline(device_, name, k_resolve_spirv, k_resolve_bindings, sizeof(ResolveConstants),
                         {device_.limits.group_size, mean ? 1u : 0u, is_cpu ? k_cpu_columns : k_gpu_columns,
                          is_cpu ? k_cpu_rows : k_gpu_rows, shadow_maps});
}

Result<gpu::Pipeline> Rasteriser::make_accumulate(const char* name, uint32_t shadow_maps) const {
    return make_pipeline(device_, name, k_accumulate_spirv, std::span(k_resolve_bindings).first(4),
                         sizeof(ResolveConstants), {device_.limits.group_size, 0, 0, 0, shadow_maps});
}

Status Rasteriser::make_pipelines() {
    COPPICE_CHECK(make_raster_pipelines(picture_pipelines_, false, false));
    picture_.pipelines = &picture_pipelines_;
    COPPICE_TRY(resolve_pipelines_[0], make_resolve("resolve", false, 0));
    COPPICE_TRY(resolve_mean_pipeline_, make_resolve("resolve of the mean", true, 0));
    COPPICE_TRY(accumulate_pipelines_[0], make_accumulate("accumulate", 0));
    return {};
}

// Those that a scene without shadows never waits for.
Status Rasteriser::make_shadow_pipelines() {
    if (has_shadow_pipelines_) return {};
    COPPICE_CHECK(make_raster_pipelines(shadow_pipelines_, true, false));
    shadows_.pipelines = &shadow_pipelines_;
    for (uint32_t maps : {1u, 2u}) {
        COPPICE_TRY(resolve_pipelines_[maps], make_resolve("resolve, shadowed", false, maps));
        COPPICE_TRY(accumulate_pipelines_[maps], make_accumulate("accumulate, shadowed", maps));
    }
    has_shadow_pipelines_ = true;
    return {};
}

Status Rasteriser::set_geometry(const GeometryData& data) {
    const uint64_t vertex_count = data.vertices.size() + uint64_t(data.reserved_points),
                   owner_count = data.owners.size() + uint64_t(data.reserved_points);
    if (vertex_count > device_.limits.texel_elements)
        return fail(ErrorId::limit_exceeded, "", "geometry",
                    std::to_string(vertex_count) + " vertices in one scene",
                    "this device takes " + std::to_string(device_.limits.texel_elements));
    if (data.has_tints && !has_tinted_pipelines_) {
        COPPICE_CHECK(make_raster_pipelines(tinted_pipelines_, false, true));
        has_tinted_pipelines_ = true;
    }
    COPPICE_TRY(gpu::Buffer vertices,
                gpu::Buffer::create(
                    device_, texel_buffer(vertex_count * sizeof(PackedVertex), VK_FORMAT_R32G32B32A32_UINT,
                                          gpu::MemoryUse::device, "vertices")));
    COPPICE_TRY(gpu::Buffer owners,
                gpu::Buffer::create(device_, texel_buffer(owner_count * sizeof(uint32_t), VK_FORMAT_R32_UINT,
                                                          gpu::MemoryUse::device, "owners")));
    if (data.reserved_points > 0)
        for (Slot& slot : slots_) {
            if (slot.uploads.size_bytes() >= k_upload_bytes) continue;
            gpu::BufferSettings settings = device_buffer(k_upload_bytes, "uploads");
            settings.memory = gpu::MemoryUse::upload;
            COPPICE_TRY(slot.uploads, gpu::Buffer::create(device_, settings));
        }
    gpu::Buffer staged_vertices, staged_owners;
    COPPICE_CHECK(stage_geometry(vertices, std::as_bytes(data.vertices), staged_vertices));
    COPPICE_CHECK(stage_geometry(owners, std::as_bytes(data.owners), staged_owners));
    device_.wait_idle();
    has_tints_ = data.has_tints;
    retired_.keep(std::exchange(staged_vertices_, std::move(staged_vertices)));
    retired_.keep(std::exchange(staged_owners_, std::move(staged_owners)));
    retired_.keep(std::exchange(vertices_, std::move(vertices)));
    retired_.keep(std::exchange(owners_, std::move(owners)));
    if (device_.submits()) retired_.drop_all();
    vertex_uploads_.clear();
    owner_uploads_.clear();
    upload_bytes_ = 0;
    return {};
}

// At once, or beside the target for the next frame, where only the host submits.
Status Rasteriser::stage_geometry(const gpu::Buffer& target, std::span<const std::byte> bytes,
                                  gpu::Buffer& staging) {
    if (bytes.empty()) return {};
    if (device_.submits()) return gpu::upload_now(device_, target, 0, bytes);
    gpu::BufferSettings settings;
    settings.size_bytes = bytes.size();
    settings.usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
    settings.memory = gpu::MemoryUse::upload;
    settings.name = "staged geometry";
    COPPICE_TRY(staging, gpu::Buffer::create(device_, settings));
    std::memcpy(staging.mapped(), bytes.data(), bytes.size());
    return {};
}

bool Rasteriser::stream_points(uint32_t slot, uint32_t first_vertex, std::span<const PackedVertex> points,
                               uint32_t first_owner, std::span<const uint32_t> owners) {
    const gpu::Buffer& ring = slots_[slot].uploads;
    if (upload_bytes_ > 0 && slot != upload_slot_) return false;
    upload_slot_ = slot;
    if (points.size_bytes() + owners.size_bytes() > ring.size_bytes() - upload_bytes_ || !ring.mapped())
        return false;
    auto stage = [&](auto items, uint64_t first_item, std::vector<VkBufferCopy>& uploads) {
        if (items.empty()) return;
        std::memcpy(ring.mapped() + upload_bytes_, items.data(), items.size_bytes());
        uploads.push_back({upload_bytes_, first_item * sizeof(items[0]), items.size_bytes()});
        upload_bytes_ += items.size_bytes();
    };
    stage(points, first_vertex, vertex_uploads_);
    stage(owners, first_owner, owner_uploads_);
    return true;
}

Status Rasteriser::upload_points(uint32_t first_vertex, std::span<const PackedVertex> points,
                                 uint32_t first_owner, std::span<const uint32_t> owners) {
    if (points.empty()) return {};
    COPPICE_CHECK(gpu::upload_now(device_, vertices_, uint64_t(first_vertex) * sizeof(PackedVertex),
                                  std::as_bytes(points)));
    return gpu::upload_now(device_, owners_, uint64_t(first_owner) * sizeof(uint32_t), std::as_bytes(owners));
}

Status Rasteriser::resize(uint32_t width, uint32_t height) {
    if (width == 0 || height == 0 || width > 16384 || height > 16384)
        return fail(ErrorId::value_out_of_range, "", "picture size",
                    std::to_string(width) + "x" + std::to_string(height), "sides from 1 to 16384");
    uint64_t pixels = uint64_t(width) * height;
    if (pixels * 8 > device_.limits.storage_range_bytes)
        return fail(
            ErrorId::limit_exceeded, "", "picture size", std::to_string(width) + "x" + std::to_string(height),
            "this device takes " + std::to_string(device_.limits.storage_range_bytes / 8) + " pixels");
    COPPICE_TRY(gpu::Buffer visibility,
                gpu::Buffer::create(device_, device_buffer(pixels * 8, "visibility")));
    COPPICE_TRY(gpu::Buffer color, gpu::Buffer::create(device_, device_buffer(pixels * 4, "color")));
    COPPICE_TRY(gpu::Buffer no_radiance,
                gpu::Buffer::create(device_, device_buffer(k_pixel_radiance_bytes, "radiance")));
    retired_.keep(std::exchange(picture_.image, std::move(visibility)));
    retired_.keep(std::exchange(color_, std::move(color)));
    retired_.keep(std::exchange(radiance_, std::move(no_radiance)));
    width_ = width;
    height_ = height;
    return {};
}

Status Rasteriser::keep_radiance() {
    const uint64_t size_bytes = uint64_t(width_) * height_ * k_pixel_radiance_bytes;
    if (radiance_.size_bytes() >= size_bytes) return {};
    if (size_bytes > device_.limits.storage_range_bytes)
        return fail(ErrorId::limit_exceeded, "", "mean of frames",
                    std::to_string(width_) + "x" + std::to_string(height_),
                    "this device takes " +
                        std::to_string(device_.limits.storage_range_bytes / k_pixel_radiance_bytes) +
                        " pixels");
    COPPICE_TRY(gpu::Buffer radiance, gpu::Buffer::create(device_, device_buffer(size_bytes, "radiance")));
    retired_.keep(std::exchange(radiance_, std::move(radiance)));
    return {};
}

Status Rasteriser::make_host_picture(const HostPicture& picture) {
    COPPICE_CHECK(host_.prepare(picture, width_, height_, retired_));
    return keep_radiance();
}

Status Rasteriser::make_shadow_maps(uint32_t side_texels, uint32_t count) {
    const uint64_t size_bytes = std::max<uint64_t>(uint64_t(side_texels) * side_texels * 4 * count, 16);
    if (side_texels > 0) COPPICE_CHECK(make_shadow_pipelines());
    if (shadow_side_texels_ == side_texels && shadows_.image.size_bytes() == size_bytes) return {};
    if (side_texels > 16384 || count > k_most_work_maps || size_bytes > device_.limits.storage_range_bytes)
        return fail(ErrorId::limit_exceeded, "", "shadow map", std::to_string(side_texels) + " texels a side",
                    "sides up to 16384, and a buffer that this device takes: " +
                        std::to_string(device_.limits.storage_range_bytes) + " bytes");
    COPPICE_TRY(gpu::Buffer maps, gpu::Buffer::create(device_, device_buffer(size_bytes, "shadow maps")));
    shadows_.most_images = std::max(count, 1u);
    COPPICE_CHECK(make_big_triangles(
        shadows_, side_texels > 0 ? std::max(shadows_.big_limit, k_first_big_shadows) : 0));
    // Of frames before, which no list of now was too short for.
    for (Slot& slot : slots_) std::ranges::fill(slot.big_count.mapped_as<uint32_t>().subspan(1), 0u);
    retired_.keep(std::exchange(shadows_.image, std::move(maps)));
    shadow_side_texels_ = side_texels;
    return {};
}

Status Rasteriser::grow(uint32_t slot, uint32_t instance_count, uint32_t entry_count) {
    // Frames in flight use other slots' buffers.
    uint64_t instance_limit = device_.limits.texel_elements / 4,
             entry_limit = device_.limits.texel_elements / 2;
    COPPICE_TRY(
        gpu::Buffer instances,
        gpu::Buffer::create(
            device_, texel_buffer(sizeof(WorkInstance) * std::min<uint64_t>(instance_count, instance_limit),
                                  VK_FORMAT_R32G32B32A32_SFLOAT, gpu::MemoryUse::upload, "instances")));
    COPPICE_TRY(gpu::Buffer entries,
                gpu::Buffer::create(
                    device_, texel_buffer(sizeof(WorkEntry) * std::min<uint64_t>(entry_count, entry_limit),
                                          VK_FORMAT_R32G32B32A32_UINT, gpu::MemoryUse::upload, "entries")));
    slots_[slot].instances = std::move(instances);
    slots_[slot].entries = std::move(entries);
    return {};
}

void Rasteriser::draw(VkCommandBuffer commands, const Target& target, WorkKind kind) {
    const Slot& slot = slots_[slot_];
    for (size_t i = 0; i < target.image_count; ++i) {
        const TargetImage& image = target.images[i];
        const gpu::BoundBuffer buffers[] = {
            {&target.image, image.first_byte}, &vertices_, &slot.entries, &slot.instances,
            kind == WorkKind::triangles ? gpu::BoundBuffer(&target.big_triangles, i * target.big_bytes())
                                        : gpu::BoundBuffer(&owners_)};
        const std::span<const gpu::BoundBuffer> bound(
            buffers, kind == WorkKind::lines || kind == WorkKind::leaves ? 4 : 5);
        auto dispatch = [&](const gpu::Pipeline& pipeline, WorkRange range, uint32_t entries_a_group) {
            if (range.entry_count == 0) return;
            RasterConstants constants = image.constants;
            constants.first_entry = range.first_entry;
            constants.entry_count = range.entry_count;
            pipeline.bind(commands, bound, &constants, sizeof constants);
            pipeline.dispatch(commands, (range.entry_count - 1) / entries_a_group + 1);
        };
        dispatch(target.pipelines->groups[size_t(kind)], image.ranges.groups[size_t(kind)], 1);
        dispatch(target.pipelines->lanes[size_t(kind)], image.ranges.lanes[size_t(kind)],
                 device_.limits.group_size);
    }
}

void Rasteriser::draw_big_triangles(VkCommandBuffer commands, const Target& target) {
    const Slot& slot = slots_[slot_];
    for (size_t i = 0; i < target.image_count; ++i) {
        const TargetImage& image = target.images[i];
        if (!image.ranges.any(WorkKind::triangles)) continue;
        const gpu::BoundBuffer buffers[] = {{&target.image, image.first_byte}, &vertices_, &slot.entries,
                                            &slot.instances, {&target.big_triangles, i * target.big_bytes()}};
        target.pipelines->big_triangles.bind(commands, buffers, &image.constants, sizeof image.constants);
        target.pipelines->big_triangles.dispatch(commands,
                                     device_.limits.is_cpu ? 64 : 4096);  // groups stride over the list
    }
}

// names: of the passes clear, triangles, big triangles, leaves, lines, and four of points, by their size.
void Rasteriser::add_raster_passes(Target& target, std::span<const char* const> names) {
    target.draw_passes.fill(k_no_pass);
    target.image_resource = graph_.add_buffer(target.is_shadow ? "shadow map" : "visibility", &target.image);
    target.big_resource = graph_.add_buffer(target.is_shadow ? "big triangles of shadows" : "big triangles",
                                            &target.big_triangles);
    const ResourceUse image{target.image_resource, BufferAccess::compute_atomic};
    const ResourceUse vertices{vertices_resource_, BufferAccess::compute_read};
    const ResourceUse owners{owners_resource_, BufferAccess::compute_read};
    target.clear_pass =
        graph_.add_pass(names[0],
                        {{target.image_resource, BufferAccess::transfer_write},
                         {target.big_resource, BufferAccess::transfer_write}},
                        [&target](VkCommandBuffer commands) {
                            for (size_t i = 0; i < target.image_count; ++i) {
                                const TargetImage& image = target.images[i];
                                vkCmdFillBuffer(commands, target.image.handle(), image.first_byte,
                                                image.size_bytes, 0);
                                vkCmdFillBuffer(commands, target.big_triangles.handle(),
                                                i * target.big_bytes(), 16, 0);
                            }
                        });
    if (!target.is_shadow)
        host_.add_input_passes(
            {&target.image, &radiance_, target.image_resource, radiance_resource_, big_count_resource_});
    auto add_draw = [&](const char* name, WorkKind kind, std::vector<ResourceUse> uses) {
        target.draw_passes[size_t(kind)] = graph_.add_pass(
            name, std::move(uses),
            [this, &target, kind](VkCommandBuffer commands) { draw(commands, target, kind); });
    };
    add_draw(names[1], WorkKind::triangles,
             {image, vertices, owners, {target.big_resource, BufferAccess::compute_read_write}});
    target.big_pass = graph_.add_pass(
        names[2], {image, vertices, {target.big_resource, BufferAccess::compute_read}},
        [this, &target](VkCommandBuffer commands) { draw_big_triangles(commands, target); });
    add_draw(names[3], WorkKind::leaves, {image, vertices, owners});
    add_draw(names[4], WorkKind::lines, {image, vertices, owners});
    if (!target.is_shadow) {
        add_draw(names[5], WorkKind::points_1, {image, vertices, owners});
        add_draw(names[6], WorkKind::points_2, {image, vertices, owners});
    }
    add_draw(names[7], WorkKind::points_any, {image, vertices, owners});
    add_draw(names[8], WorkKind::points_blend, {image, vertices, owners});
}

void Rasteriser::add_passes() {
    vertices_resource_ = graph_.add_buffer("vertices", &vertices_);
    owners_resource_ = graph_.add_buffer("owners", &owners_);
    color_resource_ = graph_.add_buffer("color", &color_);
    radiance_resource_ = graph_.add_buffer("radiance", &radiance_);
    big_count_resource_ = graph_.add_buffer("big count", &slots_[0].big_count);

    upload_pass_ =
        graph_.add_pass("stream in",
                        {{vertices_resource_, BufferAccess::transfer_write},
                         {owners_resource_, BufferAccess::transfer_write}},
                        [this](VkCommandBuffer commands) {
                            copy_staged_geometry(commands);
                            if (upload_bytes_ == 0) return;
                            const VkBuffer ring = slots_[upload_slot_].uploads.handle();
                            vkCmdCopyBuffer(commands, ring, vertices_.handle(),
                                            uint32_t(vertex_uploads_.size()), vertex_uploads_.data());
                            vkCmdCopyBuffer(commands, ring, owners_.handle(), uint32_t(owner_uploads_.size()),
                                            owner_uploads_.data());
                            vertex_uploads_.clear();
                            owner_uploads_.clear();
                            upload_bytes_ = 0;
                        });
    static constexpr const char* k_picture_passes[] = {"clear",       "triangles",    "big triangles",
                                                       "leaves",      "lines",        "points 1 px",
                                                       "points 2 px", "points large", "points blended"};
    static constexpr const char* k_shadow_passes[] = {"shadow clear",
                                                      "shadow triangles",
                                                      "shadow big triangles",
                                                      "shadow leaves",
                                                      "shadow lines",
                                                      "",
                                                      "",
                                                      "shadow points",
                                                      "shadow points blended"};
    add_raster_passes(shadows_, k_shadow_passes);
    add_raster_passes(picture_, k_picture_passes);
    big_count_pass_ = graph_.add_pass("count big triangles",
                                      {{picture_.big_resource, BufferAccess::transfer_read},
                                       {shadows_.big_resource, BufferAccess::transfer_read},
                                       {big_count_resource_, BufferAccess::transfer_write}},
                                      [this](VkCommandBuffer commands) {
                                          const VkBuffer counts = slots_[slot_].big_count.handle();
                                          const VkDeviceSize image_count = 1 + shadows_.image_count;
                                          if (image_count <= k_most_work_maps)
                                              vkCmdFillBuffer(commands, counts, 4 * image_count,
                                                              VK_WHOLE_SIZE, 0);
                                          for (VkDeviceSize i = 0; i < image_count; ++i) {
                                              const Target& target = i == 0 ? picture_ : shadows_;
                                              const VkBufferCopy first_word{
                                                  i == 0 ? 0 : (i - 1) * target.big_bytes(), 4 * i, 4};
                                              vkCmdCopyBuffer(commands, target.big_triangles.handle(), counts,
                                                              1, &first_word);
                                          }
                                      });
    auto lit = [this] {
        return std::array<gpu::BoundBuffer, 5>{&picture_.image, &slots_[slot_].light, &radiance_,
                                               &shadows_.image, &color_};
    };
    accumulate_pass_ = graph_.add_pass(
        "accumulate",
        {{picture_.image_resource, BufferAccess::compute_read},
         {shadows_.image_resource, BufferAccess::compute_read},
         {radiance_resource_, BufferAccess::compute_read_write}},
        [this, lit](VkCommandBuffer commands) {
            const auto buffers = lit();
            const gpu::Pipeline& pipeline = accumulate_pipelines_[seen_maps_];
            pipeline.bind(commands, std::span(buffers).first(4), &resolve_, sizeof resolve_);
            pipeline.dispatch(commands, ((width_ - 1) / k_pixels_a_group + 1) * height_);
        });
    resolve_pass_ = graph_.add_pass("resolve",
                                    {{picture_.image_resource, BufferAccess::compute_read},
                                     {shadows_.image_resource, BufferAccess::compute_read},
                                     {radiance_resource_, BufferAccess::compute_read},
                                     {color_resource_, BufferAccess::compute_write},
                                     {big_count_resource_, BufferAccess::host_read}},
                                    [this, lit](VkCommandBuffer commands) {
                                        const auto buffers = lit();
                                        const gpu::Pipeline& pipeline = resolve_.new_share > 0.0f
                                                                            ? resolve_mean_pipeline_
                                                                            : resolve_pipelines_[seen_maps_];
                                        pipeline.bind(commands, buffers, &resolve_, sizeof resolve_);
                                        pipeline.dispatch(commands, resolve_groups());
                                    });
    host_.add_output_passes();
}

void Rasteriser::copy_staged_geometry(VkCommandBuffer commands) {
    for (auto [staged, target] : {std::pair{&staged_vertices_, &vertices_}, {&staged_owners_, &owners_}}) {
        if (!*staged) continue;
        const VkBufferCopy whole{0, 0, staged->size_bytes()};
        vkCmdCopyBuffer(commands, staged->handle(), target->handle(), 1, &whole);
        retired_.keep(std::exchange(*staged, gpu::Buffer()));
    }
}

// One for each block; where subgroups are wider than a group is here, some find nothing to do.
uint32_t Rasteriser::resolve_groups() const {
    const bool is_cpu = device_.limits.is_cpu;
    const uint32_t columns = device_.limits.group_size * (is_cpu ? k_cpu_columns : k_gpu_columns);
    const uint32_t rows = is_cpu ? k_cpu_rows : k_gpu_rows;
    return (width_ / (columns - 2) + 1) * (height_ / rows + 1);
}

void Rasteriser::set_frame(uint32_t slot, const WorkList::Layout& layout, const Camera& camera,
                           const Light& light, const PictureSettings& picture, const ShadowSettings& shadow) {
    slot_ = slot;
    read_big_counts(slot);
    graph_.set_buffer(big_count_resource_, &slots_[slot].big_count);
    Frustum frustum = make_frustum(camera, width_, height_);
    float half_width = 0.5f * float(width_), half_height = 0.5f * float(height_);
    vec3 row_x = frustum.right * frustum.focal_px + frustum.forward * (half_width - picture.shift_px.x);
    vec3 row_y = frustum.up * -frustum.focal_px + frustum.forward * (half_height - picture.shift_px.y);
    picture_.image_count = 1;
    RasterConstants& raster = picture_.images[0].constants;
    raster.row_x = vec4(row_x, 0.0f);
    raster.row_y = vec4(row_y, 0.0f);
    raster.row_w = vec4(frustum.forward, 0.0f);
    raster.size_px = vec2(float(width_), float(height_));
    raster.near_w = camera.near_m;
    raster.view = resolve_.view = uint32_t(picture.view);
    picture_.pipelines = has_tints_ && picture.view == RepresentationView::lit ? &tinted_pipelines_ : &picture_pipelines_;
    raster.big_triangle_limit = picture_.big_limit;
    resolve_.new_share = picture.new_share;
    resolve_.shift_px = picture.shift_px;
    // A tent of radius R weighs a neighbour at distance 1 with 1 - 1 / R.
    resolve_.side_weight = 1.0f - 1.0f / glm::clamp(picture.filter_radius_px, 1.0f, 2.0f);
    resolve_.right = vec4(frustum.right * (1.0f / frustum.focal_px), float(width_));
    resolve_.up = vec4(frustum.up * (1.0f / frustum.focal_px), float(height_));
    resolve_.forward = vec4(frustum.forward, camera.near_m);

    picture_.images[0].ranges = layout.picture;
    set_shadows(layout, light, frustum.focal_px, shadow);
    set_light(light, shadow);
    set_active(picture_);
    set_active(shadows_);
    graph_.set_active(picture_.clear_pass, true);
    graph_.set_active(shadows_.clear_pass, shadows_.image_count > 0);
    graph_.set_active(big_count_pass_,
                      picture_.any(WorkKind::triangles) || shadows_.any(WorkKind::triangles));
    if (picture.host) resolve_.new_share = 1.0f;
    graph_.set_active(accumulate_pass_, resolve_.new_share > 0.0f);
    graph_.set_active(resolve_pass_, !picture.host);
    graph_.set_active(upload_pass_, upload_bytes_ > 0 || staged_vertices_ || staged_owners_);
    std::optional<HostComposite::Frame> host;
    if (picture.host)
        host = {*picture.host, &slots_[slot].light, camera.near_m, resolve_.side_weight, resolve_.view};
    host_.set_frame(host);
}

void Rasteriser::set_shadows(const WorkList::Layout& layout, const Light& light, float focal_px,
                             const ShadowSettings& shadow) {
    seen_maps_ = shadow.side_texels == 0 || shadow.seen.empty() ? 0 : shadow.is_nested() ? 2 : 1;
    shadows_.image_count = shadow.side_texels > 0 ? shadow.drawn.size() : 0;
    const VkDeviceSize map_bytes = VkDeviceSize(shadow.side_texels) * shadow.side_texels * 4;
    for (size_t i = 0; i < shadows_.image_count; ++i) {
        const ShadowMapDraw& draw = shadow.drawn[i];
        TargetImage& image = shadows_.images[i];
        image.first_byte = draw.map * map_bytes;
        image.size_bytes = map_bytes;
        image.ranges = layout.maps[i];
        RasterConstants& map = image.constants;
        map = picture_.images[0].constants;
        map.row_x = draw.view.row_x;
        map.row_y = draw.view.row_y;
        map.row_z = draw.view.row_z;
        map.row_w = draw.view.row_w;
        map.to_sun = vec4(normalize_or(light.direction_to_sun, vec3(0.0f, 1.0f, 0.0f)), draw.least_distance_m);
        map.viewer = draw.viewer;
        map.size_px = vec2(float(shadow.side_texels));
        map.near_w = draw.view.least_w;
        map.metres_a_pixel = 1.0f / focal_px;
        map.big_triangle_limit = shadows_.big_limit;
    }
}

void Rasteriser::set_light(const Light& light, const ShadowSettings& shadow) {
    const vec3 to_sun = normalize_or(light.direction_to_sun, vec3(0.0f));
    const vec3 across = perpendicular_to(normalize_or(to_sun, vec3(0.0f, 1.0f, 0.0f))),
               along = glm::cross(normalize_or(to_sun, vec3(0.0f, 1.0f, 0.0f)), across);
    auto growth = [&](const vec4& row) {
        return vec2(glm::dot(vec3(row), across), glm::dot(vec3(row), along));
    };
    const ShadowView one = shadow.seen.empty() ? ShadowView{} : shadow.seen[0];
    LightBlock block{vec4(to_sun, light.exposure),
                     vec4(light.sun_color, light.haze_density_per_m),
                     vec4(light.sky_zenith_color, 0.0f),
                     vec4(light.sky_horizon_color, shadow.far_m),
                     vec4(light.ground_color, 0.0f),
                     vec4(light.haze_color, 0.0f),
                     one.row_x,
                     one.row_y,
                     one.row_z,
                     one.row_w,
                     vec4(across, glm::dot(vec3(one.row_z), to_sun)),
                     vec4(along, float(shadow.side_texels)),
                     vec4(growth(one.row_x), growth(one.row_y)),
                     vec4(growth(one.row_w), growth(one.row_z)),
                     vec4(shadow.first_reach_m, shadow.first_texel_m, float(shadow.first_map),
                          shadow.seen.empty() ? 0.0f : float(shadow.seen.size() - 1)),
                     {},
                     {}};
    bool is_one_sun = true;
    const float first_depth_per_m = std::max(glm::length(vec3(one.row_z)), 1e-20f);
    for (size_t i = 0; i < shadow.seen.size() && i < k_most_work_maps; ++i) {
        const ShadowView& map = shadow.seen[i];
        block.nested_rows[3 * i] = map.row_x;
        block.nested_rows[3 * i + 1] = map.row_y;
        block.nested_rows[3 * i + 2] = map.row_z;
        const float texels = std::ldexp(1.0f, int(i));  // of the first map, one of this
        is_one_sun = is_one_sun && vec3(map.row_x) * texels == vec3(one.row_x) &&
                     vec3(map.row_y) * texels == vec3(one.row_y);
        block.nested_viewers[i] = vec4(map.row_x.w, map.row_y.w, map.row_z.w,
                                       glm::length(vec3(map.row_z)) / first_depth_per_m);
    }
    block.zenith_color.w = is_one_sun ? 1.0f : 0.0f;
    std::memcpy(slots_[slot_].light.mapped(), &block, sizeof block);
}

void Rasteriser::set_active(const Target& target) {
    for (size_t kind = 0; kind < k_work_kinds; ++kind)
        if (target.draw_passes[kind] != k_no_pass)
            graph_.set_active(target.draw_passes[kind], target.any(WorkKind(kind)));
    graph_.set_active(target.big_pass, target.any(WorkKind::triangles));
}

void Rasteriser::skip_frame() {
    for (Target* target : {&picture_, &shadows_}) {
        target->image_count = 0;
        set_active(*target);
        graph_.set_active(target->clear_pass, false);
    }
    for (uint32_t pass : {upload_pass_, big_count_pass_, accumulate_pass_, resolve_pass_})
        graph_.set_active(pass, false);
    host_.set_frame(std::nullopt);
}

uint64_t Rasteriser::gpu_bytes() const {
    uint64_t total = retired_.size_bytes() + host_.gpu_bytes() + staged_vertices_.size_bytes() +
                     staged_owners_.size_bytes() + color_.size_bytes() + radiance_.size_bytes() +
                     vertices_.size_bytes() + owners_.size_bytes();
    for (const Target* target : {&picture_, &shadows_})
        total += target->image.size_bytes() + target->big_triangles.size_bytes();
    for (const Slot& slot : slots_)
        total += slot.instances.size_bytes() + slot.entries.size_bytes() + slot.light.size_bytes() +
                 slot.uploads.size_bytes() + slot.big_count.size_bytes();
    return total;
}

}  // namespace coppice
