#include "runtime/ecs/commands.h"

#include <cstring>

namespace coppice {
namespace {
constexpr size_t padded(size_t size_bytes) { return (size_bytes + 7) / 8 * 8; }
}  // namespace

void Commands::record(const Edit& edit, const void* value, size_t size_bytes) {
    size_t place = bytes_.size();
    bytes_.resize(place + sizeof(Edit) + padded(size_bytes));
    std::memcpy(bytes_.data() + place, &edit, sizeof(Edit));
    if (size_bytes) std::memcpy(bytes_.data() + place + sizeof(Edit), value, size_bytes);
}

Entity Commands::resolve(Entity entity) const {
    if (entity.generation != 0 || entity.index == 0) return entity;
    assert(entity.index <= created_.size() &&
           "an entity that another buffer, or an earlier frame, was to create");
    return entity.index <= created_.size() ? created_[entity.index - 1] : Entity{};
}

void Commands::apply(World& world) {
    auto edit_at = [&](size_t place) {
        Edit edit;
        std::memcpy(&edit, bytes_.data() + place, sizeof(Edit));
        return edit;
    };
    auto size_of = [](const Edit& edit) {
        return sizeof(Edit) + (edit.kind == Kind::add ? padded(component_info(edit.number).size_bytes) : 0);
    };
    created_.clear();
    for (size_t place = 0; place < bytes_.size();) {
        Edit edit = edit_at(place);
        size_t next = place + size_of(edit);
        switch (edit.kind) {
            case Kind::create: {
                // All components at once, so that the entity is not moved for each; the adds then set the
                // values.
                ComponentMask mask;
                size_t value = next;
                for (uint32_t i = 0; i < edit.number; ++i) {
                    Edit add = edit_at(value);
                    mask.set(add.number);
                    value += size_of(add);
                }
                created_.push_back(world.create_raw(mask));
                break;
            }
            case Kind::destroy:
                world.destroy(resolve(edit.entity));
                break;
            case Kind::add:
                world.add_raw(resolve(edit.entity), edit.number, bytes_.data() + place + sizeof(Edit));
                break;
            case Kind::remove:
                world.remove_raw(resolve(edit.entity), edit.number);
                break;
            case Kind::destroy_chunk:
                world.destroy_chunk(edit.chunk);
                break;
        }
        place = next;
    }
    clear();
}

void Commands::clear() {
    bytes_.clear();
    created_count_ = 0;
}

}  // namespace coppice
