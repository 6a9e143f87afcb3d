// The shared module as a host meets it: entry, interface, and refusal of a host it does not know.
#include <dlfcn.h>
#include <string>
#include <gtest/gtest.h>

#include "plugins/modeller/modeller.h"
#include "runtime/plugin/plugin.h"

namespace coppice {
namespace {

struct Provided {
    std::string name;
    uint32_t version = 0;
    const void* interface = nullptr;
};

CoppiceHost host_of(Provided& provided) {
    CoppiceHost host{};
    host.size_bytes = sizeof(host);
    host.abi = COPPICE_PLUGIN_ABI;
    host.context = &provided;
    host.provide = [](void* context, const char* name, uint32_t version, const void* interface) {
        auto* to = static_cast<Provided*>(context);
        if (to->interface) return -1;
        *to = {name, version, interface};
        return 0;
    };
    host.find = [](void*, const char*, uint32_t) -> const void* { return nullptr; };
    host.log = [](void*, int, const char*) {};
    return host;
}

const CoppicePlugin* plugin() {
    static void* module = dlopen(COPPICE_MODELLER_MODULE, RTLD_NOW | RTLD_LOCAL);
    EXPECT_NE(module, nullptr) << dlerror();
    if (!module) return nullptr;
    auto entry = reinterpret_cast<CoppicePluginEntry>(dlsym(module, "coppice_plugin"));
    EXPECT_NE(entry, nullptr);
    return entry ? entry() : nullptr;
}

TEST(Plugin, provides_its_interface_and_grows) {
    const CoppicePlugin* modeller = plugin();
    ASSERT_NE(modeller, nullptr);
    EXPECT_EQ(modeller->abi, COPPICE_PLUGIN_ABI);
    EXPECT_STREQ(modeller->name, "modeller");
    Provided provided;
    CoppiceHost host = host_of(provided);
    ASSERT_EQ(modeller->load(&host), 0);
    EXPECT_EQ(provided.name, k_modeller_interface);
    EXPECT_EQ(provided.version, k_modeller_version);
    auto* interface = static_cast<const ModellerInterface*>(provided.interface);
    ASSERT_GE(interface->size_bytes, sizeof(ModellerInterface));
    auto plant = interface->grow(R"({"form": "grass", "name": "tuft"})", "tuft.json", 1);
    ASSERT_TRUE(plant) << to_string(plant.error());
    EXPECT_EQ(plant->name, "tuft");
    EXPECT_FALSE(interface->grow("{", "tuft.json", 1));
    modeller->unload();
}

TEST(Plugin, does_not_load_into_a_host_it_cannot_serve) {
    const CoppicePlugin* modeller = plugin();
    ASSERT_NE(modeller, nullptr);
    Provided provided;
    CoppiceHost host = host_of(provided);
    host.abi = COPPICE_PLUGIN_ABI + 1;
    EXPECT_NE(modeller->load(&host), 0);
    EXPECT_EQ(provided.interface, nullptr);
    host = host_of(provided);
    EXPECT_EQ(modeller->load(&host), 0);
    EXPECT_NE(modeller->load(&host), 0) << "the name is taken, and it must say so";
}

}  // namespace
}  // namespace coppice
