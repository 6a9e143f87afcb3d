#include "runtime/plugin/plugin.h"
#include "tools/window/window_interface.h"

namespace coppice {
namespace {

const WindowInterface k_interface{sizeof(WindowInterface), &Window::display_available,
                                  &Window::instance_extensions, &Window::create};

int load(const CoppiceHost* host) {
    return host->provide(host->context, k_window_interface, k_window_version, &k_interface);
}

const CoppicePlugin k_plugin{
    sizeof(CoppicePlugin), COPPICE_PLUGIN_ABI, "window", COPPICE_VERSION, load, nullptr};

}  // namespace
}  // namespace coppice

extern "C" COPPICE_PLUGIN_EXPORT const CoppicePlugin* coppice_plugin(void) { return &coppice::k_plugin; }
