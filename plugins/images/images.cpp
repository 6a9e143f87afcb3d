// READ FIRST: the plugin "images", a module that provides coppice.images.
#include "plugins/images/images.h"

#include "plugins/images/compare_images.h"
#include "plugins/images/read_image.h"
#include "plugins/images/write_image.h"
#include "runtime/plugin/plugin.h"

namespace coppice {
namespace {

constexpr ImagesInterface k_interface = {
    sizeof(ImagesInterface), read_image,        read_image_memory, write_image, encode_png,
    read_float_image,        write_float_image, compare_images,
};

int load(const CoppiceHost* host) {
    return host->provide(host->context, k_images_interface, k_images_version, &k_interface);
}
void unload() {}

constexpr CoppicePlugin k_plugin = {sizeof(CoppicePlugin), COPPICE_PLUGIN_ABI, "images", "1", load, unload};

}  // namespace
}  // namespace coppice

extern "C" COPPICE_PLUGIN_EXPORT const CoppicePlugin* coppice_plugin(void) { return &coppice::k_plugin; }
