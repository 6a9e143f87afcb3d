#include "plugins/vegetation/eco/tile_format.h"

#include <algorithm>
#include <cstring>
#include "plugins/vegetation/plant/check_part.h"

namespace coppice {
namespace {

bool is_box(const float low[3], const float high[3]) {
    for (int axis = 0; axis < 3; ++axis)
        if (!(low[axis] >= -k_tile_reach_m && low[axis] <= high[axis] && high[axis] <= k_tile_reach_m))
            return false;  // also for NaN
    return true;
}

bool is_within_reach(float x, float y, float z) {
    return std::fabs(x) <= k_tile_reach_m && std::fabs(y) <= k_tile_reach_m && std::fabs(z) <= k_tile_reach_m;
}

const char* fault_of_cloud(const PackedTileNode& node) {
    const PackedPart& part = node.cloud_part;
    if (!(node.finest_density >= 0.0f) || !std::isfinite(node.finest_density))
        return "a density that is negative or not finite";
    if (node.cloud.item_count > k_tiles_item_limit) return "a cloud of too many points";
    if (node.cloud.item_count == 0) {
        const PackedPart none{};
        return std::memcmp(&part, &none, sizeof part) != 0 ? "a part without a cloud" : nullptr;
    }
    if (part.kind != PackedPartKind::points || part.point_count != node.cloud.item_count ||
        part.first_point != 0 || part.triangle_count != 0 || part.line_count != 0)
        return "a cloud that is not the points stored";
    if (!is_box(part.bounds_min, part.bounds_max)) return "a cloud whose bounds are no box within reach";
    return fault_of_measures(part);
}

const char* fault_of_numbers(const PackedTileNode& node) {
    for (double v : node.origin_world)
        if (!(std::fabs(v) <= k_origin_reach_m)) return "an origin that is not finite, or out of reach";
    if (!is_box(node.bounds_min, node.bounds_max)) return "bounds that are no box within reach";
    if (node.reserved != 0) return "bytes of no meaning";
    return fault_of_cloud(node);
}

}  // namespace

NodeFault fault_of_nodes(std::span<const PackedTileNode> nodes) {
    std::vector<bool> has_parent(nodes.size());
    for (size_t n = 0; n < nodes.size(); ++n) {
        const PackedTileNode& node = nodes[n];
        if (const char* fault = fault_of_numbers(node)) return {n, fault};
        if (n > 0 && !has_parent[n]) return {n, "it is the child of no node before it"};
        if (node.child_count == 0) {
            if (node.first_child != 0) return {n, "children that are none"};
            if (node.plants.item_count == 0 || node.plants.item_count > k_tiles_item_limit)
                return {n, "no plants in a leaf, or too many"};
            if (node.plant_count != node.plants.item_count)
                return {n, "a number of plants that is not its own"};
            continue;
        }
        if (node.plants.item_count != 0) return {n, "plants in a node with children"};
        if (node.first_child <= n ||
            node.child_count > nodes.size() - std::min<size_t>(node.first_child, nodes.size()))
            return {n, "children that are not behind it in the file"};
        // A tree has as many children as nodes but for the root, so the sums below take linear time.
        uint64_t plant_count = 0, triangle_count = 0;
        for (size_t c = node.first_child; c < size_t(node.first_child) + node.child_count; ++c) {
            if (has_parent[c]) return {c, "it is the child of two nodes"};
            has_parent[c] = true;
            plant_count += nodes[c].plant_count;
            triangle_count += nodes[c].triangle_count;
        }
        if (plant_count != node.plant_count || triangle_count != node.triangle_count)
            return {n, "plants or triangles that are not the sum of its children's"};
    }
    return {};
}

const char* fault_of_contents(const TileCloud& cloud) {
    bool usable = true;
    for (const PackedVertex& p : cloud.points) usable &= is_within_reach(p.x_plant, p.y_plant, p.z_plant);
    if (!usable) return "a point that is not finite, or out of reach";
    auto is_measure = [](float v) { return v >= 0.0f && std::isfinite(v); };  // false for NaN
    float before = 0.0f;
    for (float density : cloud.densities) {
        usable &= density >= before && std::isfinite(density);
        before = density;
    }
    if (!usable) return "densities that fall, or are negative or not finite";
    for (float area_m2 : cloud.exhausted_area_m2) usable &= is_measure(area_m2);
    if (!usable || !is_measure(cloud.exhausted_density))
        return "an exhausted area or its density that is negative or not finite";
    return nullptr;
}

const char* fault_of_plants(std::span<const PlantPosition> positions, std::span<const PlantTurn> turns,
                            std::span<const PlantModel> models, size_t model_count) {
    for (const PlantPosition& p : positions) {
        if (!is_within_reach(p.x_tile, p.y_tile, p.z_tile))
            return "a plant that is not finite, or out of reach";
        if (!(p.scale > 0.0f && p.scale <= 1e5f)) return "a scale that is not in (0, 100000]";
    }
    for (const PlantTurn& turn : turns) {
        int64_t square = 0;
        for (int64_t q : {turn.x, turn.y, turn.z, turn.w}) square += q * q;
        constexpr int64_t k_unit = 32767 * 32767;
        if (square < k_unit - k_unit / 64 || square > k_unit + k_unit / 64)
            return "a turn that is not of unit length";
    }
    for (const PlantModel& model : models)
        if (model.model >= model_count) return "a model that does not exist";
    return nullptr;
}

std::string place_of_block(size_t node, TileBlockKind kind) {
    return "node " + std::to_string(node) + (kind == TileBlockKind::cloud ? ", cloud" : ", plants");
}

}  // namespace coppice
