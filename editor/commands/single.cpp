// Plants one by one, or a choice of them: place, move, turn, scale, delete, become.
#include "editor/commands/commands.h"
#include "editor/commands/target.h"
#include "runtime/core/hash.h"
#include "runtime/core/random.h"

namespace coppice {
namespace {

constexpr float k_radians = k_pi / 180.0f;

// The plant turned by angle_rad about the vertical.
PlantTurn turned(PlantTurn turn, float angle_rad) {
    const float s = portable_sin(angle_rad * 0.5f), c = portable_cos(angle_rad * 0.5f);
    const float x = turn.x * k_turn_step, y = turn.y * k_turn_step, z = turn.z * k_turn_step,
                w = turn.w * k_turn_step;
    return pack_turn(c * x + s * z, c * y + s * w, c * z - s * x, c * w - s * y);
}

struct Choice {
    Target target;
    std::vector<PlacedPlant> plants;
};

Result<Choice> read_choice(const CommandContext& context, JsonObject& arguments) {
    Choice choice{read_target(context, arguments), {}};
    if (!choice.target.file) return choice;
    COPPICE_TRY(const SceneNames names, names_of(context.document, *choice.target.file, choice.target.path));
    choice.plants = read_selection(arguments, context.document, *choice.target.file, names);
    return choice;
}

// Each plant as `change` leaves it.
template <class Change>
Edit changed(const CommandContext& context, const Choice& choice, const char* verb, Change&& change) {
    std::vector<PlacedPlant> after = choice.plants;
    for (PlacedPlant& plant : after) change(plant);
    if (after == choice.plants) return {};
    Edit edit = edit_of(choice.target, choice.plants, std::move(after));
    if (!edit.files.empty())
        edit.name = std::string(verb) + " " + count_text(context.document, edit.files[0].removed);
    return edit;
}

dvec2 read_pair(JsonObject& arguments, const char* key, std::optional<std::vector<double>> otherwise = {}) {
    const auto pair = arguments.numbers(key, 2, -k_farthest_m, k_farthest_m, std::move(otherwise));
    return {pair[0], pair[1]};
}

void move_by(PlacedPlant& plant, dvec2 by_m) {
    const dvec2 at = ground_place(plant) + by_m;
    const PlacedPlant there = pack_placed({at.x, 0.0, at.y}, 1.0f, {}, 0, 0);
    plant.x = there.x;
    plant.z = there.z;
}

}  // namespace

Result<Edit> make_place(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    if (!target.file) return Edit{};
    COPPICE_TRY(const SceneNames names, names_of(context.document, *target.file, target.path));
    const std::string name = arguments.text("population");
    const PlantKind* kind = names.find_kind(arguments, "population", name);
    const dvec2 at = read_pair(arguments, "at");
    const double lift_m = arguments.number("lift_m", -500.0, 500.0, 0.0);
    // What is not said follows from the place, by chance.
    Random random(hash_text(name), uint64_t(int64_t(at.x * 128.0)) << 32 ^ uint64_t(int64_t(at.y * 128.0)));
    const float turn_rad =
        arguments.real("turn_deg", -360.0f, 360.0f, random.next_unit() * 360.0f) * k_radians;
    const float tilt_rad = arguments.real("tilt_deg", 0.0f, 180.0f, 0.0f) * k_radians;
    const float bearing_rad = arguments.real("tilt_towards_deg", -360.0f, 360.0f, 0.0f) * k_radians;
    const float scale = arguments.real("scale", k_scale_least, k_scale_most, 1.0f);
    const uint32_t count = kind ? uint32_t(kind->individuals.size()) : 1;
    const uint64_t variation = arguments.whole("variation", 0, count - 1, random.next_below(count));
    arguments.close();
    if (!arguments.document().sound()) return Edit{};
    const PlantTurn turn =
        make_turn(turn_rad, tilt_rad, vec3(portable_sin(bearing_rad), 0.0f, -portable_cos(bearing_rad)));
    Edit edit = edit_of(target, {},
                        {pack_placed({at.x, lift_m, at.y}, scale, turn, context.document.kind_of(name),
                                     uint16_t(variation))});
    edit.name = "place " + name;
    return edit;
}

Result<Edit> make_move(const CommandContext& context, JsonObject& arguments) {
    COPPICE_TRY(const Choice choice, read_choice(context, arguments));
    const bool to = arguments.one_of({"by", "to"}) == 1;
    const dvec2 place = read_pair(arguments, to ? "to" : "by");
    arguments.close();
    if (!arguments.document().sound() || choice.plants.empty()) return Edit{};
    // To a place: the middle of them goes there.
    dvec2 middle(0.0);
    for (const PlacedPlant& plant : choice.plants)
        middle += ground_place(plant) / double(choice.plants.size());
    const dvec2 by_m = to ? place - middle : place;
    return changed(context, choice, "move", [&](PlacedPlant& plant) { move_by(plant, by_m); });
}

Result<Edit> make_turn(const CommandContext& context, JsonObject& arguments) {
    COPPICE_TRY(const Choice choice, read_choice(context, arguments));
    const float by_rad = arguments.real("by_deg", -360.0f, 360.0f) * k_radians;
    const bool round = arguments.has("about");
    const dvec2 about = round ? read_pair(arguments, "about") : dvec2(0.0);
    arguments.close();
    if (!arguments.document().sound()) return Edit{};
    const double c = double(portable_cos(by_rad)), s = double(portable_sin(by_rad));
    return changed(context, choice, "turn", [&](PlacedPlant& plant) {
        plant.turn = pack_placed_turn(turned(unpack_placed_turn(plant.turn), by_rad));
        if (!round) return;
        const dvec2 from = ground_place(plant) - about;
        move_by(plant, dvec2(c * from.x + s * from.y, c * from.y - s * from.x) - from);
    });
}

Result<Edit> make_scale(const CommandContext& context, JsonObject& arguments) {
    COPPICE_TRY(const Choice choice, read_choice(context, arguments));
    const float by = arguments.real("by", k_scale_least, k_scale_most);
    arguments.close();
    if (!arguments.document().sound()) return Edit{};
    return changed(context, choice, "scale", [&](PlacedPlant& plant) {
        plant.scale = pack_scale(std::clamp(unpack_scale(plant.scale) * by, k_scale_least, k_scale_most));
    });
}

Result<Edit> make_delete(const CommandContext& context, JsonObject& arguments) {
    COPPICE_TRY(const Choice choice, read_choice(context, arguments));
    arguments.close();
    if (!arguments.document().sound()) return Edit{};
    Edit edit = edit_of(choice.target, choice.plants, {});
    if (!edit.files.empty()) edit.name = "delete " + count_text(context.document, choice.plants);
    return edit;
}

// Other plants in the same places.
Result<Edit> make_become(const CommandContext& context, JsonObject& arguments) {
    COPPICE_TRY(const Choice choice, read_choice(context, arguments));
    if (!choice.target.file) return Edit{};
    COPPICE_TRY(const SceneNames names, names_of(context.document, *choice.target.file, choice.target.path));
    const std::string name = arguments.text("population");
    const PlantKind* kind = names.find_kind(arguments, "population", name);
    arguments.close();
    if (!arguments.document().sound() || !kind) return Edit{};
    const uint16_t number = context.document.kind_of(name);
    return changed(context, choice, "change", [&](PlacedPlant& plant) {
        plant.kind = number;
        plant.variation = uint16_t(plant.variation % kind->individuals.size());
    });
}

}  // namespace coppice
