#include "editor/commands/exchange.h"

#include <map>
#include <tuple>
#include <fmt/format.h>
#include "editor/commands/commands.h"
#include "editor/commands/target.h"
#include "plugins/vegetation/cook/import/read_named_places.h"
#include "plugins/vegetation/eco/ground_height.h"
#include "plugins/vegetation/eco/place_named.h"
#include "plugins/vegetation/eco/read_placements_csv.h"

namespace coppice {
namespace {

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

// RFC 4648, for buffers inside a text.
std::string as_base64(std::string_view bytes) {
    constexpr char k_digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t three = 0;
        for (size_t k = 0; k < 3; ++k) three = three << 8 | (i + k < bytes.size() ? uint8_t(bytes[i + k]) : 0u);
        for (size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : k_digits[three >> (18 - 6 * k) & 63u];
    }
    return text;
}

using Json = nlohmann::ordered_json;

// A glTF file with one buffer, its accessors one behind the other.
class GltfWriter {
  public:
    // Whole numbers of elements; gives the accessor.
    template <class Value>
    size_t add(const std::vector<Value>& values, const char* type, size_t components, uint32_t component_type,
               bool normalized = false) {
        const size_t size_bytes = values.size() * sizeof(Value);
        views_.push_back({{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", size_bytes}});
        buffer_.append(reinterpret_cast<const char*>(values.data()), size_bytes);
        buffer_.resize((buffer_.size() + 3) & ~size_t(3), '\0');
        Json accessor = {{"bufferView", views_.size() - 1},
                         {"componentType", component_type},
                         {"count", values.size() / components},
                         {"type", type}};
        if (normalized) accessor["normalized"] = true;
        accessors.push_back(std::move(accessor));
        return accessors.size() - 1;
    }

    std::string write(Json gltf, bool binary) const {
        if (!buffer_.empty()) {
            Json buffer = {{"byteLength", buffer_.size()}};
            if (!binary) buffer["uri"] = "data:application/octet-stream;base64," + as_base64(buffer_);
            gltf["buffers"] = {std::move(buffer)};
            gltf["bufferViews"] = views_;
            gltf["accessors"] = accessors;
        }
        if (!binary) return gltf.dump(1) + "\n";
        std::string json = gltf.dump();
        json.resize((json.size() + 3) & ~size_t(3), ' ');
        std::string file = "glTF";
        auto number = [&file](size_t value) {
            for (int shift = 0; shift < 32; shift += 8) file += char(value >> shift & 255u);
        };
        number(2);
        number(12 + 8 + json.size() + (buffer_.empty() ? 0 : 8 + buffer_.size()));
        number(json.size());
        file += "JSON" + json;
        if (buffer_.empty()) return file;
        number(buffer_.size());
        return file + std::string("BIN\0", 4) + buffer_;
    }

    Json accessors = Json::array();

  private:
    std::string buffer_;
    Json views_ = Json::array();
};

// A metre high, for programs that have no plants of ours to put there.
size_t add_pyramid(GltfWriter& writer, Json& attributes) {
    const std::vector<float> corners{-0.2f, 0, -0.2f, 0.2f, 0, -0.2f, 0.2f, 0, 0.2f, -0.2f, 0, 0.2f, 0, 1, 0};
    attributes["POSITION"] = writer.add(corners, "VEC3", 3, 5126);
    writer.accessors.back()["min"] = {-0.2f, 0, -0.2f};
    writer.accessors.back()["max"] = {0.2f, 1, 0.2f};
    return writer.add(std::vector<uint16_t>{0, 4, 1, 1, 4, 2, 2, 4, 3, 3, 4, 0, 0, 1, 2, 0, 2, 3}, "SCALAR", 1, 5123);
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
    COPPICE_TRY(const std::vector<NamedPlaces> named, read_named_places(path));
    COPPICE_TRY(const std::vector<Placement> placements, place_named(named, {kinds, dvec3(0.0), 1}, path));
    std::vector<PlacedPlant> added;
    for (const Placement& plant : placements) {
        const dvec3& at = plant.position_world;
        added.push_back(placed_from(plant, at.y - ground_height(target.terrain, at.x, at.z)));
    }
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

std::string placed_as_gltf(const Document& document, const EcoFile& file, const Terrain* terrain, bool binary) {
    // A node for each block of ground, so that places are exact as floats beside its corner.
    constexpr double k_block_m = 65536.0;
    using Place = std::tuple<std::string, uint16_t, int64_t, int64_t>;  // name, individual, block
    std::map<Place, std::vector<PlacedPlant>> groups;
    for (const auto& [cell, plants] : file.plants.cells())
        for (const PlacedPlant& plant : plants) {
            const dvec2 block = glm::floor(ground_place(plant) / k_block_m);
            groups[{document.kinds()[plant.kind], plant.variation, int64_t(block.x), int64_t(block.y)}].push_back(plant);
        }
    GltfWriter writer;
    Json gltf = {{"asset", {{"version", "2.0"}, {"generator", "coppice-editor"}}}};
    if (groups.empty()) return writer.write(std::move(gltf), binary);
    Json attributes, nodes = Json::array(), roots = Json::array(), meshes = Json::array();
    const size_t indices = add_pyramid(writer, attributes);
    std::map<std::string, size_t> mesh_of;
    for (const auto& [place, plants] : groups) {
        const auto& [name, variation, column, row] = place;
        if (mesh_of.try_emplace(name, meshes.size()).second)
            meshes.push_back({{"name", name}, {"primitives", {{{"attributes", attributes}, {"indices", indices}}}}});
        const dvec2 corner = dvec2(double(column), double(row)) * k_block_m;
        std::vector<float> translations, scales;
        std::vector<int16_t> rotations;
        for (const PlacedPlant& plant : plants) {
            const dvec2 at = ground_place(plant);
            const double y = ground_height(terrain, at.x, at.y) + plant.lift / k_lift_steps_per_m;
            for (double along : {at.x - corner.x, y, at.y - corner.y}) translations.push_back(float(along));
            const PlantTurn turn = unpack_placed_turn(plant.turn);
            rotations.insert(rotations.end(), {turn.x, turn.y, turn.z, turn.w});
            scales.insert(scales.end(), 3, unpack_scale(plant.scale));
        }
        roots.push_back(nodes.size());
        nodes.push_back({{"name", fmt::format("{}.{:03}", name, variation)},
                         {"mesh", mesh_of[name]},
                         {"translation", {corner.x, 0, corner.y}},
                         {"extensions",
                          {{"EXT_mesh_gpu_instancing",
                            {{"attributes",
                              {{"TRANSLATION", writer.add(translations, "VEC3", 3, 5126)},
                               {"ROTATION", writer.add(rotations, "VEC4", 4, 5122, true)},
                               {"SCALE", writer.add(scales, "VEC3", 3, 5126)}}}}}}}});
    }
    gltf["extensionsUsed"] = gltf["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
    gltf["scene"] = 0;
    gltf["scenes"] = {{{"nodes", std::move(roots)}}};
    gltf["nodes"] = std::move(nodes);
    gltf["meshes"] = std::move(meshes);
    return writer.write(std::move(gltf), binary);
}

}  // namespace coppice
