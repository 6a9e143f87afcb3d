#include "editor/document/document.h"

#include <algorithm>
#include <cassert>
#include <filesystem>
#include <fmt/format.h>
#include "plugins/vegetation/eco/scene_file.h"
#include "runtime/core/file.h"
#include "runtime/core/hash.h"

namespace coppice {
namespace {

constexpr const char* k_ending = ".eco.json";

// "woods.eco.json" -> "woods.plants"
std::string default_placed_name(const std::string& path) {
    std::string name = std::filesystem::path(path).filename().string();
    if (name.ends_with(k_ending))
        name.resize(name.size() - std::string_view(k_ending).size());
    else
        name = std::filesystem::path(name).stem().string();
    return name + ".plants";
}

std::string placed_path_of(const std::string& path, const SceneText& text) {
    return Document::resolve(path, placed_name(text).value_or(default_placed_name(path)));
}

bool is_there(const std::string& path) {
    std::error_code ignored;
    return std::filesystem::exists(path, ignored);
}

// None: there is no file, or none that can be read.
std::optional<uint64_t> hash_of_file(const std::string& path) {
    const auto bytes = read_text_file(path, k_scene_file_limit_bytes);
    return bytes ? std::optional(hash_text(*bytes)) : std::nullopt;
}

// What is there goes beside itself before it is written over.
Status back_up(const std::string& path) {
    if (!is_there(path)) return {};
    COPPICE_TRY(const std::string bytes, read_text_file(path, k_scene_file_limit_bytes));
    return write_text_file(path + ".bak", bytes);
}

}  // namespace

std::optional<std::string> placed_name(const SceneText& text) {
    const auto placements = text.json.find("placements");
    if (placements == text.json.end() || !placements->is_array()) return {};
    for (const auto& placement : *placements)
        if (placement.is_object())
            if (auto packed = placement.find("packed"); packed != placement.end() && packed->is_string())
                return packed->get<std::string>();
    return {};
}

SceneTextPtr with_placed(const SceneTextPtr& text, const std::string& path) {
    if (placed_name(*text)) return text;
    nlohmann::ordered_json json = text->json;
    auto& placements = json["placements"];
    if (!placements.is_array()) placements = nlohmann::ordered_json::array();
    placements.push_back({{"packed", default_placed_name(path)}});
    return print_scene_text(std::move(json));
}

std::string Document::resolve(const std::string& of_file, const std::string& name) {
    return (std::filesystem::path(of_file).parent_path() / name).lexically_normal().string();
}

std::vector<std::string> Document::references_of(const std::string& path, const SceneText& text) {
    std::vector<std::string> paths;
    const auto references = text.json.find("references");
    if (references == text.json.end() || !references->is_array()) return paths;
    for (const auto& reference : *references) {
        if (!reference.is_object()) continue;
        const auto scene = reference.find("scene");
        if (scene == reference.end() || !scene->is_string()) continue;
        std::string resolved = resolve(path, scene->get<std::string>());
        if (std::find(paths.begin(), paths.end(), resolved) == paths.end())
            paths.push_back(std::move(resolved));
    }
    return paths;
}

Document Document::make(const std::string& path) {
    Document document;
    document.root_path_ = std::filesystem::path(path).lexically_normal().string();
    EcoFile& file = document.files_[document.root_path_];
    file.text = print_scene_text(
        {{"plants", nlohmann::ordered_json::object()}, {"placements", nlohmann::ordered_json::array()}});
    file.placed_path = placed_path_of(document.root_path_, *file.text);
    return document;
}

Document Document::for_plant(const std::string& plant_path) {
    const std::filesystem::path plant = std::filesystem::path(plant_path).lexically_normal();
    Document document;
    document.root_path_ = plant.string() + k_ending;
    EcoFile& file = document.files_[document.root_path_];
    file.text = print_scene_text({{"plants", {{plant.stem().string(), {{"source", plant.filename().string()}}}}},
                                  {"placements", nlohmann::ordered_json::array()}});
    file.placed_path = placed_path_of(document.root_path_, *file.text);
    file.is_made_up = true;
    return document;
}

Result<Document> Document::open(const std::string& path) {
    Document document;
    document.root_path_ = std::filesystem::path(path).lexically_normal().string();
    COPPICE_CHECK(document.read_one(document.root_path_));
    for (const std::string& reference : references_of(document.root_path_, *document.root().text))
        if (Status read = document.read(reference); !read) document.faults_.push_back(read.error());
    return document;
}

Status Document::read(const std::string& path) {
    if (files_.contains(path)) return {};
    COPPICE_CHECK(read_one(path));
    for (const std::string& reference : references_of(path, *files_.at(path).text))
        if (Status read_child = read(reference); !read_child) faults_.push_back(read_child.error());
    return {};
}

Status Document::read_one(const std::string& path) {
    COPPICE_TRY(std::string bytes, read_text_file(path, k_scene_file_limit_bytes));
    const uint64_t text_hash = hash_text(bytes);
    COPPICE_TRY(SceneTextPtr text, parse_scene_text(std::move(bytes), path));
    EcoFile& file = files_[path];
    file.text = std::move(text);
    file.saved_text_hash = text_hash;
    file.placed_path = placed_path_of(path, *file.text);
    if (!placed_name(*file.text)) return {};
    auto placed_bytes = read_text_file(file.placed_path, k_scene_file_limit_bytes);
    auto placed = placed_bytes ? read_placed(*placed_bytes, file.placed_path)
                               : Result<PlacedPlants>(fail(placed_bytes.error()));
    if (placed && !has_room_for_kinds(placed->kinds.size()))
        placed = fail(ErrorId::limit_exceeded, file.placed_path, "",
                      "too many kinds of plants with those before", "at most 65536 in a scene");
    if (!placed) {
        file.plants_lost = is_there(file.placed_path);
        faults_.push_back(placed.error());
        return {};
    }
    file.saved_plants_hash = hash_text(*placed_bytes);
    std::vector<uint16_t> numbers;
    for (const std::string& name : placed->kinds) numbers.push_back(kind_of(name));
    for (PlacedPlant& plant : placed->plants) plant.kind = numbers[plant.kind];
    file.plants.add(placed->plants);
    return {};
}

EcoFile* Document::find(const std::string& path) {
    const auto found = files_.find(path);
    return found == files_.end() ? nullptr : &found->second;
}
const EcoFile* Document::find(const std::string& path) const {
    return const_cast<Document*>(this)->find(path);
}

uint16_t Document::kind_of(const std::string& name) {
    if (const auto found = kind_numbers_.find(name); found != kind_numbers_.end()) return found->second;
    assert(kinds_.size() < k_kind_limit);
    kinds_.push_back(name);
    return kind_numbers_[name] = uint16_t(kinds_.size() - 1);
}

bool Document::apply(const Edit& edit) {
    for (size_t f = 0; f < edit.files.size(); ++f) {
        const FileEdit& change = edit.files[f];
        EcoFile* file = find(change.path);
        const SceneTextPtr there = file ? file->text : nullptr;
        const bool text_fits = change.before == change.after || there == change.before ||
                               (there && change.before && there->text == change.before->text);
        // A scene without its own file is none.
        const bool leaves_root = change.before == change.after || change.after || change.path != root_path_;
        bool fits = text_fits && leaves_root && (change.removed.empty() || (file && file->plants.remove(change.removed)));
        if (!fits) {
            Edit done{"", {edit.files.begin(), edit.files.begin() + ptrdiff_t(f)}};
            apply(inverse(std::move(done)));
            return false;
        }
        EcoFile& changed = files_[change.path];
        changed.plants.add(change.added);
        if (change.before == change.after) continue;
        changed.text = change.after;
        if (changed.text) changed.placed_path = placed_path_of(change.path, *changed.text);
    }
    return true;
}

std::optional<std::string> Document::text_bytes(const EcoFile& file) const {
    if (!file.text || file.is_made_up) return {};
    return file.text->text;
}

std::optional<std::string> Document::plants_bytes(const EcoFile& file) const {
    if (!file.text || !placed_name(*file.text) || file.plants_lost) return {};
    return write_placed({kinds_, file.plants.all()});
}

uint64_t Document::hash() const {
    uint64_t hash = 0;
    for (const auto& [path, file] : files_) {
        if (!file.text) continue;
        hash = hash_text(path, hash);
        hash = hash_text(file.text->text, hash);
        hash = hash_text(plants_bytes(file).value_or(""), hash);
    }
    return hash;
}

bool Document::saved() const {
    for (const auto& [path, file] : files_) {
        if (file.is_made_up) continue;
        if (!file.text && file.saved_text_hash) return false;
        if (!file.text) continue;
        if (file.saved_text_hash != hash_text(file.text->text)) return false;
        if (const auto plants = plants_bytes(file); plants && file.saved_plants_hash != hash_text(*plants))
            return false;
    }
    return true;
}

std::vector<Document::Write> Document::list_writes() const {
    std::vector<Write> writes;
    for (const auto& [path, file] : files_)
        if (auto plants = plants_bytes(file))
            writes.push_back({file.placed_path, std::move(*plants), file.saved_plants_hash});
    for (const auto& [path, file] : files_)
        if (auto text = text_bytes(file)) writes.push_back({path, std::move(*text), file.saved_text_hash});
    std::erase_if(writes, [](const Write& write) { return write.saved_hash == hash_text(write.bytes); });
    return writes;
}

std::vector<std::string> Document::changed_elsewhere() const {
    std::vector<std::string> changed;
    for (const Write& write : list_writes())
        if (hash_of_file(write.path) != write.saved_hash) changed.push_back(write.path);
    return changed;
}

Status Document::save(bool overwrite) {
    if (const std::vector<std::string> changed = changed_elsewhere(); !changed.empty() && !overwrite)
        return fail(ErrorId::write_failed, changed[0], "", "was changed by another program since it was read",
                    "overwrite it, which keeps the other one as .bak; or open the scene again");
    const std::vector<Write> writes = list_writes();
    for (const Write& write : writes) COPPICE_CHECK(back_up(write.path));
    for (const Write& write : writes) {
        COPPICE_CHECK(write_text_file(write.path, write.bytes));
        for (auto& [path, file] : files_) {
            if (path == write.path) file.saved_text_hash = hash_text(write.bytes);
            if (file.placed_path == write.path) file.saved_plants_hash = hash_text(write.bytes);
        }
    }
    // Of files whose making was undone.
    for (auto& [path, file] : files_) {
        if (file.text || !file.saved_text_hash) continue;
        COPPICE_CHECK(back_up(path));
        std::error_code ignored;
        std::filesystem::remove(path, ignored);
        file.saved_text_hash.reset();
    }
    return {};
}

}  // namespace coppice
