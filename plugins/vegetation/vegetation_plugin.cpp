// The C entry of the plugin; all it provides is made by vegetation.cpp.
#include "plugins/vegetation/vegetation.h"
#include "runtime/plugin/plugin.h"

namespace coppice {
namespace {

constexpr VegetationInterface k_interface{sizeof(VegetationInterface), &create_vegetation};

int load(const CoppiceHost* host) {
    return host->provide(host->context, k_vegetation_interface, k_vegetation_version, &k_interface);
}
void unload() {}

constexpr CoppicePlugin k_plugin{
    sizeof(CoppicePlugin), COPPICE_PLUGIN_ABI, "vegetation", "0.1.0", &load, &unload};

}  // namespace
}  // namespace coppice

extern "C" COPPICE_PLUGIN_EXPORT const CoppicePlugin* coppice_plugin(void) { return &coppice::k_plugin; }
