#include "runtime/plugin/registry.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <dlfcn.h>
#include <filesystem>
#include <system_error>
#include "runtime/core/jobs.h"
#include "runtime/core/log.h"

namespace coppice {
namespace {

struct Interface {
    std::string name;
    uint32_t version;
    const void* pointer;
};

// What every plugin's description has, however old the header it was built against.
constexpr size_t k_first_description_bytes = offsetof(CoppicePlugin, unload) + sizeof(CoppicePlugin::unload);
const char* const k_abi_remedy = "build the plugin against this version of runtime/plugin/plugin.h";

std::vector<std::filesystem::path> search_folders() {
    std::vector<std::filesystem::path> folders;
    if (const char* listed = std::getenv("COPPICE_PLUGIN_PATH")) {
        std::string_view rest = listed;
        while (!rest.empty()) {
            size_t colon = std::min(rest.find(':'), rest.size());
            if (colon) folders.emplace_back(rest.substr(0, colon));
            rest.remove_prefix(std::min(colon + 1, rest.size()));
        }
    }
    std::error_code error;
    std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
    if (!error) folders.push_back(program.parent_path().parent_path() / "lib" / "coppice");
    Dl_info library{};
    if (dladdr(reinterpret_cast<const void*>(&search_folders), &library) && library.dli_fname) {
        std::filesystem::path path = std::filesystem::absolute(library.dli_fname, error);
        folders.push_back(path.parent_path() / "coppice");
        folders.push_back(path.parent_path());
    }
    return folders;
}

bool is_name(std::string_view name) {
    return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
               c == '-';
    });
}

std::string last_dl_error() {
    const char* text = dlerror();
    return text ? text : "unknown reason";
}

}  // namespace

struct Registry::Impl {
    // One loaded plugin, and the context of the host it was given.
    struct Module {
        Impl* registry = nullptr;
        std::string name;
        void* handle = nullptr;
        const CoppicePlugin* plugin = nullptr;  // set once its load() has succeeded
        CoppiceHost host{};
        std::vector<Interface> interfaces;
        std::string last_error;  // of its log, for the message when it does not load

        Module(Impl* owner, std::string_view plugin_name) : registry(owner), name(plugin_name) {
            host.size_bytes = sizeof(host);
            host.abi = COPPICE_PLUGIN_ABI;
            host.context = this;
            host.provide = &Module::provide;
            host.find = &Module::find;
            host.log = &Module::log;
            host.run_jobs = &Module::run_jobs;
        }

        static int provide(void* context, const char* name, uint32_t version, const void* pointer) {
            Module& self = *static_cast<Module*>(context);
            if (!name || !*name || !pointer || self.registry->find(name, version)) return -1;
            self.interfaces.push_back({name, version, pointer});
            return 0;
        }
        static const void* find(void* context, const char* name, uint32_t version) {
            return name ? static_cast<Module*>(context)->registry->find(name, version) : nullptr;
        }
        static void log(void* context, int level, const char* line) {
            Module& self = *static_cast<Module*>(context);
            if (level >= 2) self.last_error = line ? line : "";
            LogLevel as = level <= 0 ? LogLevel::note : level == 1 ? LogLevel::warning : LogLevel::error;
            log_line(as, fmt::format("{}: {}", self.name, line ? line : ""));
        }
        static void run_jobs(void*, size_t count, size_t grain, void (*body)(void*, size_t, size_t), void* items) {
            coppice::run_jobs(count, grain, body, items);
        }
    };

    const void* find(std::string_view name, uint32_t version) const {
        for (const auto& module : modules)
            for (const Interface& interface : module->interfaces)
                if (interface.version == version && interface.name == name) return interface.pointer;
        return nullptr;
    }

    void unload_last() {
        Module& module = *modules.back();
        if (module.plugin && module.plugin->unload) module.plugin->unload();
        if (module.handle) dlclose(module.handle);
        modules.pop_back();
    }

    std::vector<std::unique_ptr<Module>> modules;  // in order of loading; the last may be loading
};

Registry::Registry() : impl_(std::make_unique<Impl>()) {}

Registry::~Registry() {
    while (!impl_->modules.empty()) impl_->unload_last();
}

Status Registry::load(std::string_view name) {
    for (const auto& module : impl_->modules)
        if (module->name == name) return {};
    if (!is_name(name))
        return fail(ErrorId::name_unknown, "", "", fmt::format("\"{}\" cannot be a plugin's name", name),
                    "use letters, digits, _ and -");

    std::filesystem::path file;
    std::string looked;
    for (const std::filesystem::path& folder : search_folders()) {
        std::filesystem::path candidate = folder / (std::string(name) + ".so");
        std::error_code error;
        if (std::filesystem::exists(candidate, error)) {
            file = candidate;
            break;
        }
        looked += (looked.empty() ? "" : ", ") + folder.string();
    }
    if (file.empty())
        return fail(ErrorId::file_missing, std::string(name) + ".so", "",
                    "there is no such plugin in " + looked,
                    "install it there, or name its folder in COPPICE_PLUGIN_PATH");

    void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle)
        return fail(ErrorId::file_unreadable, file.string(), "", "not loaded: " + last_dl_error(),
                    "install what it needs, or build it for this machine");
    auto module = std::make_unique<Impl::Module>(impl_.get(), name);
    module->handle = handle;
    impl_->modules.push_back(std::move(module));
    Status status = start(file.string());
    if (!status) impl_->unload_last();
    return status;
}

// The last module's entry, checks and load().
Status Registry::start(const std::string& file) {
    Impl::Module& module = *impl_->modules.back();
    auto entry = reinterpret_cast<CoppicePluginEntry>(dlsym(module.handle, "coppice_plugin"));
    const CoppicePlugin* plugin = entry ? entry() : nullptr;
    if (!plugin)
        return fail(ErrorId::format_unknown, file, "",
                    "it has no function coppice_plugin that returns a plugin", "name a Coppice plugin");
    if (plugin->size_bytes < 2 * sizeof(uint32_t) || plugin->abi != COPPICE_PLUGIN_ABI)
        return fail(ErrorId::format_unknown, file, "",
                    fmt::format("plugin ABI {}; this runtime has {}", plugin->abi, COPPICE_PLUGIN_ABI),
                    k_abi_remedy);
    if (plugin->size_bytes < k_first_description_bytes || !plugin->load)
        return fail(ErrorId::format_unknown, file, "",
                    fmt::format("plugin description of {} bytes; this runtime reads at least {}", plugin->size_bytes,
                                k_first_description_bytes),
                    k_abi_remedy);
    int result = plugin->load(&module.host);
    if (result != 0)
        return fail(ErrorId::name_unknown, file, "",
                    fmt::format("plugin \"{}\" did not load (code {}){}{}", module.name, result,
                                module.last_error.empty() ? "" : ": ", module.last_error),
                    "see what it logged");
    module.plugin = plugin;
    return {};
}

const void* Registry::find(std::string_view interface, uint32_t version) const {
    return impl_->find(interface, version);
}

std::vector<std::string> Registry::loaded() const {
    std::vector<std::string> names;
    for (const auto& module : impl_->modules) names.push_back(module->name);
    return names;
}

}  // namespace coppice
