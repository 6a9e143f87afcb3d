#include "runtime/plugin/plugin.h"
#include "tools/reference/trace.h"

namespace coppice {
namespace {

const ReferenceInterface k_interface{sizeof(ReferenceInterface), &create_ray_scene};

int load(const CoppiceHost* host) {
    return host->provide(host->context, k_reference_interface, k_reference_version, &k_interface);
}

const CoppicePlugin k_plugin{
    sizeof(CoppicePlugin), COPPICE_PLUGIN_ABI, "reference", COPPICE_VERSION, load, nullptr};

}  // namespace
}  // namespace coppice

extern "C" COPPICE_PLUGIN_EXPORT const CoppicePlugin* coppice_plugin(void) { return &coppice::k_plugin; }
