// One *.eco.json file in memory, before the files it refers to are read: its own plants, and where others' stand.
#pragma once
#include <string>
#include <vector>
#include "plugins/vegetation/eco/ground_rule.h"
#include "plugins/vegetation/eco/load_scene.h"
#include "plugins/vegetation/eco/place.h"

namespace coppice {

// Plants that ask the same of the ground they will stand on.
struct PlantGroup {
    std::vector<Placement> plants;  // the file's own space; models: of the file's own list
    GroundRule rule;                // of the root's plants none is left: its ground is known already
};

// Another file, once or on a grid about `at`, in the space of the file that names it.
struct SceneReference {
    std::string path;   // resolved
    std::string place;  // in the file that names it: "references[2]"
    dvec3 at{0.0};
    bool on_ground = true;  // y follows the ground; else at.y holds for all of it
    double turn_deg = 0.0;  // about y; the grid turns along
    double scale = 1.0;     // of plants and of what is between them, not of the grid
    uint32_t columns = 1, rows = 1;
    double spacing_m = 0.0;
    double turn_step_deg = 0.0;  // copy i is turned i times as much more

    uint64_t copy_count() const { return uint64_t(columns) * rows; }
};

struct SceneFile {
    Scene scene;  // no tiles, no plants; terrain, light and flight of the root only
    std::vector<PlantGroup> groups;
    std::vector<SceneReference> references;
};

inline constexpr uint64_t k_model_limit = 65536;  // of a scene, with all it refers to

enum class SceneRole { root, referenced };

// A referenced file's terrain, light and flight are left out, with a note: its plants stand on the plane y = 0 until the
// root's ground is known, and so its scatters need a region. Errors: load_scene's.
Result<SceneFile> read_scene_file(const std::string& path, const SceneLoadSettings& settings, SceneRole role);

// A scene's file, or one of its packed plants: from the disk, or from who has a newer one.
inline constexpr size_t k_scene_file_limit_bytes = size_t(1) << 29;
Result<std::string> read_scene_bytes(const std::string& path, const SceneLoadSettings& settings);

}  // namespace coppice
