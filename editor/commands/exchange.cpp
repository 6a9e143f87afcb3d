#include "editor/commands/exchange.h"

#include <filesystem>
#include <fmt/format.h>
#include "editor/commands/commands.h"
#include "editor/commands/target.h"
#include "plugins/vegetation/eco/ground_height.h"
#include "plugins/vegetation/eco/read_placements_csv.h"
#include "runtime/core/file.h"

namespace coppice {
namespace {

constexpr size_t k_gltf_limit_bytes = size_t(1) << 31;
constexpr size_t k_depth_limit = 256;

// {"name in the file": "population"}, beside the populations' own names.
std::map<std::string, PlantKind> read_species(JsonObject& arguments, const SceneNames& names) {
    std::map<std::string, PlantKind> kinds = names.kinds;
    const nlohmann::json* species = arguments.find("species");
    if (!species) return kinds;
    JsonObject map = arguments.object("species");
    if (!arguments.document().sound()) return kinds;
    for (const auto& [alias, ignored] : species->items())
        if (const PlantKind* kind = names.find_kind(map, alias.c_str(), map.text(alias.c_str())))
            kinds[alias] = *kind;
    return kinds;
}

std::string quoted(const std::string& field) {
    if (field.find_first_of(",\"\n\r") == field.npos && !field.starts_with(' ')) return field;
    std::string text = "\"";
    for (char c : field) text += c == '"' ? std::string("\"\"") : std::string(1, c);
    return text + "\"";
}

float turn_deg_of(PlantTurn turn) {
    const mat3 m = rotation_matrix(turn);
    const float deg = portable_atan2(-m[0].z, m[0].x) * (180.0f / k_pi);
    return deg < 0.0f ? deg + 360.0f : deg;
}

// Where a node stands in the world, with the scales and turns of all above it.
struct NodeFrame {
    dvec3 origin{0.0};
    float x = 0.0f, y = 0.0f, z = 0.0f, w = 1.0f;
    double scale = 1.0;

    dvec3 turned(dvec3 p) const {
        const dvec3 axis(x, y, z);
        const dvec3 t = 2.0 * glm::cross(axis, p);
        return p + double(w) * t + glm::cross(axis, t);
    }
};

class GltfReader {
  public:
    GltfReader(const nlohmann::json& root, const std::string& path,
               const std::map<std::string, PlantKind>& kinds, const Terrain* terrain)
        : root_(root), path_(path), kinds_(kinds), terrain_(terrain) {}

    Result<std::vector<PlacedPlant>> read() {
        const auto nodes = root_.find("nodes");
        if (nodes == root_.end() || !nodes->is_array())
            return wrong("nodes", "missing", "a glTF 2.0 file with nodes");
        nodes_ = &*nodes;
        std::vector<bool> is_child(nodes_->size(), false);
        for (const auto& node : *nodes_)
            for (uint64_t child : children_of(node))
                if (child < is_child.size()) is_child[child] = true;
        for (size_t n = 0; n < nodes_->size(); ++n)
            if (!is_child[n]) COPPICE_CHECK(visit(n, {}, 0));
        if (plants_.empty()) {
            std::vector<std::string> known;
            for (const auto& [name, kind] : kinds_) known.push_back(name);
            return wrong("nodes", fmt::format("none of {} nodes is called like a population", nodes_->size()),
                         "name them in \"species\": " + known_names("", known));
        }
        return std::move(plants_);
    }

  private:
    tl::unexpected<Error> wrong(std::string place, std::string fault, std::string remedy) const {
        return fail(ErrorId::value_out_of_range, path_, std::move(place), std::move(fault),
                    std::move(remedy));
    }

    static std::vector<uint64_t> children_of(const nlohmann::json& node) {
        std::vector<uint64_t> children;
        if (!node.is_object()) return children;
        const auto list = node.find("children");
        if (list == node.end() || !list->is_array()) return children;
        for (const auto& child : *list)
            if (child.is_number_unsigned()) children.push_back(child.get<uint64_t>());
        return children;
    }

    // As many finite numbers, or the others.
    Result<std::vector<double>> numbers(const nlohmann::json& node, const char* key,
                                        std::vector<double> otherwise, const std::string& place) const {
        const auto list = node.find(key);
        if (list == node.end()) return otherwise;
        std::vector<double> values;
        if (list->is_array())
            for (const auto& value : *list)
                if (value.is_number()) values.push_back(value.get<double>());
        bool good = values.size() == otherwise.size();
        for (double value : values) good = good && std::abs(value) <= k_farthest_m;
        if (!good)
            return wrong(place + "." + key, "found " + shown(*list),
                         fmt::format("{} numbers within 1e7", otherwise.size()));
        return values;
    }

    // The node's or its mesh's name, up to a number that exporters put behind: "birch.003", "birch_12".
    const PlantKind* kind_of(const nlohmann::json& node) const {
        std::vector<std::string> names;
        if (node.contains("name") && node["name"].is_string())
            names.push_back(node["name"].get<std::string>());
        if (node.contains("mesh") && node["mesh"].is_number_unsigned()) {
            const auto meshes = root_.find("meshes");
            const uint64_t mesh = node["mesh"].get<uint64_t>();
            if (meshes != root_.end() && meshes->is_array() && mesh < meshes->size() &&
                (*meshes)[mesh].is_object())
                if (auto name = (*meshes)[mesh].find("name");
                    name != (*meshes)[mesh].end() && name->is_string())
                    names.push_back(name->get<std::string>());
        }
        for (std::string name : names) {
            if (auto found = kinds_.find(name); found != kinds_.end()) return &found->second;
            const size_t end = name.find_last_not_of("0123456789");
            if (end == name.npos || end + 1 == name.size() || (name[end] != '.' && name[end] != '_'))
                continue;
            name.resize(end);
            if (auto found = kinds_.find(name); found != kinds_.end()) return &found->second;
        }
        return nullptr;
    }

    Status visit(size_t n, const NodeFrame& parent, size_t depth) {
        const std::string place = fmt::format("nodes[{}]", n);
        if (n >= nodes_->size() || depth > k_depth_limit || ++visited_ > nodes_->size())
            return wrong(place, "nodes that do not form a tree", "children that exist, each of one parent");
        const nlohmann::json& node = (*nodes_)[n];
        if (!node.is_object()) return wrong(place, "found " + shown(node), "an object");
        if (node.contains("matrix"))
            return wrong(place + ".matrix", "a matrix", "translation, rotation and scale apart");
        COPPICE_TRY(const auto move, numbers(node, "translation", {0, 0, 0}, place));
        COPPICE_TRY(const auto turn, numbers(node, "rotation", {0, 0, 0, 1}, place));
        COPPICE_TRY(const auto scale, numbers(node, "scale", {1, 1, 1}, place));
        NodeFrame frame;
        frame.origin = parent.origin + parent.turned(dvec3(move[0], move[1], move[2])) * parent.scale;
        // Plants have one scale: what stretches them keeps their volume.
        frame.scale = parent.scale * std::cbrt(std::abs(scale[0] * scale[1] * scale[2]));
        const double length =
            std::sqrt(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2] + turn[3] * turn[3]);
        if (!(length > 1e-6)) return wrong(place + ".rotation", "no rotation", "a unit quaternion");
        const float bx = float(turn[0] / length), by = float(turn[1] / length), bz = float(turn[2] / length),
                    bw = float(turn[3] / length);
        const NodeFrame& a = parent;
        frame.x = a.w * bx + a.x * bw + a.y * bz - a.z * by;
        frame.y = a.w * by - a.x * bz + a.y * bw + a.z * bx;
        frame.z = a.w * bz + a.x * by - a.y * bx + a.z * bw;
        frame.w = a.w * bw - a.x * bx - a.y * by - a.z * bz;
        const std::vector<uint64_t> children = children_of(node);
        const PlantKind* kind = children.empty() ? kind_of(node) : nullptr;
        if (kind) {
            if (!(frame.scale >= double(k_scale_least) && frame.scale <= double(k_scale_most)))
                return wrong(place + ".scale", fmt::format("{:.3g}", frame.scale), "from 0.001 to 1000");
            if (!(std::abs(frame.origin.x) <= k_farthest_m && std::abs(frame.origin.z) <= k_farthest_m))
                return wrong(place, "too far away", "within 1e7 m");
            const double lift_m = frame.origin.y - ground_height(terrain_, frame.origin.x, frame.origin.z);
            const uint32_t number = kind->individuals.front().model >> 16;
            const uint32_t variation = uint32_t(plants_.size() % kind->individuals.size());
            plants_.push_back(pack_placed({frame.origin.x, lift_m, frame.origin.z}, float(frame.scale),
                                          pack_turn(frame.x, frame.y, frame.z, frame.w), uint16_t(number),
                                          uint16_t(variation)));
        }
        for (uint64_t child : children) COPPICE_CHECK(visit(child, frame, depth + 1));
        return {};
    }

    const nlohmann::json& root_;
    const std::string& path_;
    const std::map<std::string, PlantKind>& kinds_;
    const Terrain* terrain_;
    const nlohmann::json* nodes_ = nullptr;
    size_t visited_ = 0;
    std::vector<PlacedPlant> plants_;
};

// Of a .gltf as it is, of a .glb its first chunk.
Result<std::string> read_gltf_json(const std::string& path) {
    COPPICE_TRY(std::string bytes, read_text_file(path, k_gltf_limit_bytes));
    if (!bytes.starts_with("glTF")) return bytes;
    auto number_at = [&](size_t at) {
        uint32_t value = 0;
        for (size_t i = 0; i < 4; ++i) value |= uint32_t(uint8_t(bytes[at + i])) << (8 * i);
        return value;
    };
    if (bytes.size() < 20 || number_at(16) != 0x4e4f534a || number_at(12) > bytes.size() - 20)
        return fail(ErrorId::file_truncated, path, "byte 12", "its JSON is not whole", "a .glb of glTF 2.0");
    return bytes.substr(20, number_at(12));
}

}  // namespace

Result<Edit> make_import_csv(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    if (!target.file) return Edit{};
    COPPICE_TRY(const SceneNames names, names_of(context.document, *target.file, target.path));
    const std::string name = arguments.text("csv");
    CsvSettings settings;
    const auto offset = arguments.numbers("offset", 2, -2.0 * k_farthest_m, 2.0 * k_farthest_m,
                                          std::vector<double>{0.0, 0.0});
    settings.offset = dvec2(offset[0], offset[1]);
    read_scale_range(arguments, settings.scale_low, settings.scale_high);
    settings.seed = arguments.whole("seed", 0, UINT64_MAX, 1);
    settings.kinds = read_species(arguments, names);
    settings.terrain = target.terrain;
    arguments.close();
    if (!arguments.document().sound()) return Edit{};
    COPPICE_TRY(const std::vector<Placement> placements,
                read_placements_csv(Document::resolve(target.path, name), settings));
    std::vector<PlacedPlant> added;
    for (const Placement& plant : placements) added.push_back(placed_from(plant));
    Edit edit = edit_of(target, {}, std::move(added));
    if (!edit.files.empty()) edit.name = "import " + count_text(context.document, edit.files[0].added);
    return edit;
}

Result<Edit> make_import_gltf(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    if (!target.file) return Edit{};
    COPPICE_TRY(const SceneNames names, names_of(context.document, *target.file, target.path));
    const std::string path = Document::resolve(target.path, arguments.text("gltf"));
    const std::map<std::string, PlantKind> kinds = read_species(arguments, names);
    arguments.close();
    if (!arguments.document().sound()) return Edit{};
    COPPICE_TRY(const std::string text, read_gltf_json(path));
    COPPICE_TRY(const JsonDocument json, JsonDocument::parse(text, path));
    COPPICE_TRY(std::vector<PlacedPlant> added, GltfReader(json.root(), path, kinds, target.terrain).read());
    Edit edit = edit_of(target, {}, std::move(added));
    edit.name = "import " + count_text(context.document, edit.files[0].added);
    return edit;
}

std::string placed_as_csv(const Document& document, const EcoFile& file) {
    std::map<uint16_t, double> heights;
    if (file.text)
        if (auto plants = file.text->json.find("plants");
            plants != file.text->json.end() && plants->is_object())
            for (size_t kind = 0; kind < document.kinds().size(); ++kind)
                if (auto entry = plants->find(document.kinds()[kind]);
                    entry != plants->end() && entry->is_object())
                    if (auto height = entry->find("height_m"); height != entry->end() && height->is_number())
                        heights[uint16_t(kind)] = height->get<double>();
    std::string text = "x,y,species,height,scale,turn_deg\n";
    for (const auto& [cell, plants] : file.plants.cells())
        for (const PlacedPlant& plant : plants) {
            const dvec2 at = ground_place(plant);
            const double scale = double(unpack_scale(plant.scale));
            const auto height = heights.find(plant.kind);
            text += fmt::format("{},{},{},{},{},{:.1f}\n", at.x, at.y, quoted(document.kinds()[plant.kind]),
                                height == heights.end() ? "" : fmt::format("{:.4g}", height->second * scale),
                                scale, turn_deg_of(unpack_placed_turn(plant.turn)));
        }
    return text;
}

std::string placed_as_gltf(const Document& document, const EcoFile& file, const Terrain* terrain) {
    using Json = nlohmann::ordered_json;
    std::map<std::string, std::vector<PlacedPlant>> of_kind;
    for (const auto& [cell, plants] : file.plants.cells())
        for (const PlacedPlant& plant : plants) of_kind[document.kinds()[plant.kind]].push_back(plant);
    Json nodes = Json::array(), roots = Json::array();
    for (const auto& [name, plants] : of_kind) {
        Json group = {{"name", name + " (all)"}, {"children", Json::array()}};
        for (const PlacedPlant& plant : plants) {
            const dvec2 at = ground_place(plant);
            const double y = ground_height(terrain, at.x, at.y) + plant.lift / k_lift_steps_per_m;
            const PlantTurn turn = unpack_placed_turn(plant.turn);
            const float scale = unpack_scale(plant.scale);
            group["children"].push_back(nodes.size());
            nodes.push_back(
                {{"name", name},
                 {"translation", {at.x, y, at.y}},
                 {"rotation",
                  {turn.x * k_turn_step, turn.y * k_turn_step, turn.z * k_turn_step, turn.w * k_turn_step}},
                 {"scale", {scale, scale, scale}}});
        }
        roots.push_back(nodes.size());
        nodes.push_back(std::move(group));
    }
    Json gltf = {{"asset", {{"version", "2.0"}, {"generator", "coppice-editor"}}}};
    if (!nodes.empty()) {
        gltf["scene"] = 0;
        gltf["scenes"] = {{{"nodes", std::move(roots)}}};
        gltf["nodes"] = std::move(nodes);
    }
    return gltf.dump(1) + "\n";
}

}  // namespace coppice
