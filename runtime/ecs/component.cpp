#include "runtime/ecs/component.h"

#include <array>
#include <cstdlib>
#include <mutex>
#include <fmt/format.h>
#include "runtime/core/hash.h"

namespace coppice {
namespace {
// A fixed array, because ids are looked up without a lock while other threads register.
struct Components {
    std::mutex mutex;
    std::array<ComponentInfo, k_component_limit> infos;
    uint32_t count = 0;
};

Components& components() {
    static Components all;
    return all;
}

[[noreturn]] void end_program(const std::string& message) {
    fmt::print(stderr, "coppice: {}\n", message);
    std::abort();
}
}  // namespace

ComponentId register_component(std::string_view name, uint32_t size_bytes, uint32_t alignment, bool hashed) {
    Components& all = components();
    std::lock_guard lock(all.mutex);
    for (ComponentId id = 0; id < all.count; ++id) {
        const ComponentInfo& info = all.infos[id];
        if (info.name != name) continue;
        if (info.size_bytes != size_bytes || info.alignment != alignment || info.hashed != hashed)
            end_program(
                fmt::format("component '{}' is registered with {} bytes and now comes with {}; rename one "
                            "or build both modules from the same source",
                            name, info.size_bytes, size_bytes));
        return id;
    }
    if (all.count == k_component_limit)
        end_program(
            fmt::format("component '{}' is one more than the {} a process can have; join some or raise "
                        "k_component_limit",
                        name, k_component_limit));
    all.infos[all.count] = {std::string(name), hash_text(name), size_bytes, alignment, hashed};
    return all.count++;
}

const ComponentInfo& component_info(ComponentId id) { return components().infos[id]; }

void detail::end_with_padding(std::string_view name) {
    end_program(
        fmt::format("component '{}' is hashed but has padding bytes, which have no value; fill them with "
                    "members or set k_component_hashed to false",
                    name));
}

}  // namespace coppice
