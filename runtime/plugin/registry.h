// Loads plugins and keeps what they provide, by name and version.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>
#include "runtime/core/result.h"
#include "runtime/plugin/plugin.h"

namespace coppice {

// One thread at a time. Plugins talk to one another only through what they provide.
class Registry {
  public:
    Registry();
    ~Registry();  // unloads in reverse order of loading
    Registry(const Registry&) = delete;
    Registry& operator=(const Registry&) = delete;

    // NAME.so is looked for in $COPPICE_PLUGIN_PATH (colon-separated), then in ../lib/coppice beside the
    // program, then in coppice/ beside the runtime library and beside it. Loading twice is one loading; what
    // a plugin provided before its loading failed is forgotten. Errors: file_missing (says where it looked),
    // file_unreadable (the system does not load it), format_unknown (no entry, or another ABI), name_unknown
    // (no name, or the plugin's load failed).
    Status load(std::string_view name);

    // nullptr where nobody provides it.
    const void* find(std::string_view interface, uint32_t version) const;
    template <class Interface>
    const Interface* find(std::string_view name, uint32_t version) const {
        return static_cast<const Interface*>(find(name, version));
    }
    std::vector<std::string> loaded() const;

  private:
    struct Impl;
    Status start(const std::string& file);
    std::unique_ptr<Impl> impl_;
};

}  // namespace coppice
