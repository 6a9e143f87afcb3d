#include "plugins/vegetation/eco/load_scene.h"

#include "plugins/vegetation/eco/make_tiles.h"
#include "plugins/vegetation/eco/place_plants.h"

namespace coppice {

Result<Scene> load_scene(const std::string& path, const SceneLoadSettings& settings) {
    COPPICE_TRY(SceneTree tree, read_scene_tree(path, settings));
    const std::vector<Placement> plants = place_plants(tree);
    Scene scene = std::move(tree.nodes.back().file.scene);
    scene.models = std::move(tree.models);
    make_tiles(plants, scene);
    return scene;
}

}  // namespace coppice
