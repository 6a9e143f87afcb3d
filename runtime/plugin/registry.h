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

class Registry {
  public:
    Registry();
    ~Registry();  // unloads in reverse order of loading
    Registry(const Registry&) = delete;
    Registry& operator=(const Registry&) = delete;

    // name: "vegetation"; looked for as NAME.so in $COPPICE_PLUGIN_PATH (colon-separated), then in ../lib/coppice
    // beside the program, then beside the runtime library. Loading twice is one loading.
    // Errors: file_missing (says where it looked), format_unknown (no entry, or another ABI), name_unknown (load failed).
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
    std::unique_ptr<Impl> impl_;
};

}  // namespace coppice
