// A forest in a host's own Vulkan program, in C11: what embedded_forest.h is in C++, for hosts in C and in languages that speak
// to C. docs/embedding.md says how to begin, and what holds of command buffer, barriers, depth and slots.
// Rules: interfaces are found by name and version. Every struct begins with its size, which the caller sets; new members go to
// the end, where no struct has padding, nobody touches a member beyond that size, and 0 is always what it was before there was the
// member. So a program that was built against an older header keeps working. What is missing, NULL or a size that nobody set, is
// COPPICE_BAD_INPUT; questions are answered with nothing then. One thread at a time calls a forest, but for questions about stems.
#pragma once
#include <stddef.h>
#include <stdint.h>
#include <vulkan/vulkan_core.h>

#ifdef __cplusplus
extern "C" {
#endif

#define COPPICE_FOREST_INTERFACE "coppice.forest"
#define COPPICE_FOREST_VERSION 1u

// What functions return; CoppiceForestInterface::message says more.
enum {
    COPPICE_DONE = 0,
    COPPICE_FAILED = 1,          // something that none of the others is
    COPPICE_BAD_INPUT = 2,       // a file, a number, a name
    COPPICE_DEVICE_MISSING = 3,  // the device lacks what is needed
    COPPICE_DEVICE_LOST = 4,     // destroy the forest, then the device, and create both again
    COPPICE_LIMIT_EXCEEDED = 5   // memory did not suffice, or a limit that the message names
};

typedef struct CoppiceForest CoppiceForest;

typedef struct CoppiceForestSettings {
    uint32_t size_bytes;
    uint32_t queue_family;  // that frames are submitted to; the queue stays the host's
    VkInstance instance;
    VkPhysicalDevice physical_device;
    VkDevice device;
    const char* scene;              // *.eco.json, a plant, or a populated folder
    uint32_t width, height;         // of the host's picture
    uint32_t frame_slots;           // frames in flight; 0: 2
    uint32_t loose_tiles;           // squares of 16 m that plants of the host's own may stand in; 0: 1024
    const char* cache_dir;          // of cooked plants; NULL: that of the user
    uint64_t tile_memory_bytes;     // of a populated folder; 0: 256 MiB
} CoppiceForestSettings;

// Metres, y up. forward and up need not be unit. Field of view and near distance are those of the host's projection.
typedef struct CoppiceCamera {
    uint32_t size_bytes;
    float vertical_fov_rad, near_m;
    float forward[3], up[3];
    double position[3];
} CoppiceCamera;

// The host's colour and depth, in the layouts that they have before and after. 0 of a layout or format: as embedded_forest.h has it.
typedef struct CoppicePicture {
    uint32_t size_bytes;
    VkFormat color_format;
    VkImage color;
    VkImage depth;
    VkImageLayout color_layout, depth_layout;
    VkFormat depth_format;
    float depth_offset, depth_scale;  // stored is depth_offset + depth_scale / w
    uint32_t reserved;                // 0
} CoppicePicture;

typedef struct CoppiceQuality {
    uint32_t size_bytes;
    float sample_distance_px;  // d'; 0: 1
    uint64_t vertex_budget;    // 0: none
    float time_budget_ms;      // 0: none; needs CoppiceForestInterface::set_frame_ms
    uint32_t without_shadows;
} CoppiceQuality;

typedef struct CoppiceFrame {
    uint32_t size_bytes;
    uint32_t slot;             // below frame_slots; the device has finished its last frame
    VkCommandBuffer commands;  // recording, outside of a render pass
    const CoppiceCamera* camera;
    const CoppicePicture* picture;
    const CoppiceQuality* quality;  // NULL: all 0
} CoppiceFrame;

// Linear radiance, 1 is white on the screen. Members beyond size_bytes are those of the scene.
typedef struct CoppiceLight {
    uint32_t size_bytes;
    float direction_to_sun[3];  // zero: no sun
    float sun_color[3], sky_zenith_color[3], sky_horizon_color[3], ground_color[3], haze_color[3];
    float haze_density_per_m;
} CoppiceLight;

typedef struct CoppiceReport {
    uint32_t size_bytes;
    uint32_t plants_visible;
    uint64_t plants, triangles, lines, points, leaves, vertices;
    uint64_t device_bytes;
    float sample_distance_px;  // as drawn
    float cpu_ms;              // of culling, levels and the work list
} CoppiceReport;

typedef struct CoppicePlant {
    uint32_t size_bytes;
    uint32_t model;      // below model_count
    double position[3];  // of its foot
    float scale;         // 0: 1
    float turn_rad;      // about its stem
    uint32_t seed;
    uint32_t reserved;  // 0
} CoppicePlant;

typedef struct CoppiceHit {
    uint32_t size_bytes;
    uint32_t plant;  // a row of the scene, or what add_plant gave; UINT32_MAX: nothing was met
    float distance_m;
    float normal[3];
} CoppiceHit;

// All points at most radius_m from the line between foot and head.
typedef struct CoppiceStem {
    uint32_t size_bytes;
    uint32_t plant;
    double foot[3], head[3];
    float radius_m;
    uint32_t reserved;  // 0
} CoppiceStem;

typedef struct CoppiceForestInterface {
    uint32_t size_bytes;
    uint32_t version;
    // What the last call on this thread that did not return COPPICE_DONE says: file, place, fault, remedy. Until the next call.
    const char* (*message)(void);
    int (*create)(const CoppiceForestSettings* settings, CoppiceForest** forest);
    // The device has finished all frames that were recorded. NULL is nothing.
    void (*destroy)(CoppiceForest* forest);
    // Nothing is submitted, waited for or presented. Where it fails nothing is recorded.
    int (*record)(CoppiceForest* forest, const CoppiceFrame* frame);
    int (*resize)(CoppiceForest* forest, uint32_t width, uint32_t height);
    int (*set_light)(CoppiceForest* forest, const CoppiceLight* light);
    // How long the frame of a slot took, for time budgets.
    void (*set_frame_ms)(CoppiceForest* forest, uint32_t slot, double ms);
    // size_bytes is the caller's.
    void (*report)(const CoppiceForest* forest, CoppiceReport* report);
    // Where the scene's own flight is after so many seconds.
    void (*scene_camera)(const CoppiceForest* forest, double time_s, CoppiceCamera* camera);
    // Loads the scene again where one of its files has changed; on failure the old one stays.
    int (*reload_if_changed)(CoppiceForest* forest, uint32_t* changed);

    uint32_t (*model_count)(const CoppiceForest* forest);
    const char* (*model_name)(const CoppiceForest* forest, uint32_t model);  // NULL: there is none
    int (*add_plant)(CoppiceForest* forest, const CoppicePlant* plant, uint32_t* number);
    int (*move_plant)(CoppiceForest* forest, uint32_t number, const CoppicePlant* plant);
    int (*remove_plant)(CoppiceForest* forest, uint32_t number);

    void (*first_hit)(const CoppiceForest* forest, const double from[3], const float direction[3],
                      float most_distance_m, CoppiceHit* hit);
    void (*nearest_stem)(const CoppiceForest* forest, const double at[3], float within_m, CoppiceHit* hit);
    // How many touch the box; as many of them as there is room for are written, `stride_bytes` apart, which is the caller's
    // sizeof(CoppiceStem). SIZE_MAX: memory did not suffice.
    size_t (*stems_in_box)(const CoppiceForest* forest, const double least[3], const double most[3],
                           CoppiceStem* stems, size_t room, size_t stride_bytes);
} CoppiceForestInterface;

#if defined(__GNUC__)
#define COPPICE_EXPORT __attribute__((visibility("default")))
#else
#define COPPICE_EXPORT
#endif

// An interface that lasts as long as the program, or NULL where this library has none of that name and version.
COPPICE_EXPORT const void* coppice_interface(const char* name, uint32_t version);

#ifdef __cplusplus
}
#endif
