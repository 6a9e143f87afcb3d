// The plugin's entry: makes the interface "coppice.modeller" known.
#include "plugins/modeller/modeller.h"

#include "plugins/modeller/grow.h"
#include "runtime/plugin/plugin.h"

namespace {

constexpr coppice::ModellerInterface k_interface{sizeof(coppice::ModellerInterface),
                                                 &coppice::modeller::grow_plant};

int load(const CoppiceHost* host) {
    if (!host || host->size_bytes < sizeof(CoppiceHost) || host->abi != COPPICE_PLUGIN_ABI) return 1;
    return host->provide(host->context, coppice::k_modeller_interface, coppice::k_modeller_version,
                         &k_interface);
}

void unload() {}

constexpr CoppicePlugin k_plugin{
    sizeof(CoppicePlugin), COPPICE_PLUGIN_ABI, "modeller", "0.1.0", &load, &unload};

}  // namespace

extern "C" COPPICE_PLUGIN_EXPORT const CoppicePlugin* coppice_plugin(void) { return &k_plugin; }
