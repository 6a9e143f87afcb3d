#include "plugins/vegetation/cook/part_settings.h"

#include <algorithm>
#include <bit>
#include "plugins/shared/json_object.h"
#include "runtime/core/file.h"
#include "runtime/core/hash.h"

namespace coppice {
namespace {

constexpr uint64_t k_file_limit_bytes = 1 << 20;
constexpr PartKind k_kinds[] = {PartKind::automatic, PartKind::points, PartKind::lines, PartKind::leaves};

PartKind read_kind(JsonObject& part) {
    const std::string name = part.text("kind", "automatic");
    std::vector<std::string> known;
    for (PartKind kind : k_kinds) {
        if (name == name_of(kind)) return kind;
        known.push_back(name_of(kind));
    }
    part.report(ErrorId::name_unknown, "kind", "\"" + name.substr(0, 40) + "\"", known_names(name, known));
    return PartKind::automatic;
}

}  // namespace

std::string part_settings_path(const std::string& plant_path) { return plant_path + ".lod.json"; }

const char* name_of(PartKind kind) {
    switch (kind) {
        case PartKind::automatic:
            return "automatic";
        case PartKind::points:
            return "points";
        case PartKind::lines:
            return "lines";
        case PartKind::leaves:
            return "leaves";
    }
    return "";
}

Result<std::vector<PartSettings>> parse_part_settings(std::string_view json, const std::string& file) {
    COPPICE_TRY(JsonDocument document, JsonDocument::parse(json, file));
    JsonObject root(document, document.root(), "");
    std::vector<PartSettings> settings;
    if (const nlohmann::json* parts = root.find("parts")) {
        JsonObject by_name = root.object("parts");
        if (parts->is_object())
            for (const auto& [name, ignored] : parts->items()) {
                JsonObject part = by_name.object(name.c_str());
                settings.push_back({name, read_kind(part), part.real("importance", 0.0f, k_importance_limit, 0.0f)});
                part.close();
            }
    }
    root.close();
    COPPICE_CHECK(document.status());
    return settings;
}

Result<std::vector<PartSettings>> read_part_settings(const std::string& plant_path) {
    const std::string path = part_settings_path(plant_path);
    auto json = read_text_file(path, k_file_limit_bytes);
    if (json) return parse_part_settings(*json, path);
    if (json.error().id == ErrorId::file_missing) return std::vector<PartSettings>();
    return fail(std::move(json.error()));
}

uint64_t hash_part_settings(const std::vector<PartSettings>& parts) {
    uint64_t hash = 0;
    for (const PartSettings& part : parts) {
        hash = hash_text(part.name, hash);
        hash = hash_combine(hash, uint64_t(part.kind) << 32 | std::bit_cast<uint32_t>(part.importance));
    }
    return hash;
}

}  // namespace coppice
