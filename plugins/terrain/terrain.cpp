// The module: provides "coppice.terrain".
#include "plugins/terrain/terrain.h"

#include <exception>
#include "plugins/terrain/load_terrain.h"
#include "runtime/plugin/plugin.h"

namespace coppice {
namespace {

Result<std::shared_ptr<Terrain>> load_guarded(std::string_view json, const std::string& base_dir,
                                              const std::string& file) {
    try {
        return load_terrain(json, base_dir, file);
    } catch (const std::exception& error) {  // no exception leaves a plugin; what remains is lack of memory
        return fail(ErrorId::limit_exceeded, file, "terrain", error.what(), "a smaller terrain");
    }
}

constexpr TerrainInterface k_interface{sizeof(TerrainInterface), load_guarded};

int load(const CoppiceHost* host) {
    return host->provide(host->context, k_terrain_interface, k_terrain_version, &k_interface);
}

constexpr CoppicePlugin k_plugin{sizeof(CoppicePlugin), COPPICE_PLUGIN_ABI, "terrain", "0.1.0", load, [] {}};

}  // namespace
}  // namespace coppice

extern "C" COPPICE_PLUGIN_EXPORT const CoppicePlugin* coppice_plugin(void) { return &coppice::k_plugin; }
