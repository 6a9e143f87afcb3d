#include "plugins/vegetation/eco/scene_tree.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <fmt/format.h>
#include "plugins/shared/region.h"

namespace coppice {
namespace {

constexpr double k_reach_limit_m = 2.0 * k_farthest_m;
constexpr double k_scale_product_least = 1e-6, k_scale_product_most = 1e6;

class TreeReader {
  public:
    explicit TreeReader(const SceneLoadSettings& settings) : settings_(settings) {}

    Result<SceneTree> read(const std::string& path) {
        COPPICE_TRY(SceneFile root, read_scene_file(path, settings_, SceneRole::root));
        COPPICE_CHECK(add(std::move(root), file_key(path)));
        return std::move(tree_);
    }

  private:
    Result<uint32_t> add(SceneFile file, const std::string& key) {
        chain_.enter(file.scene.path);
        SceneNode node;
        node.file = std::move(file);
        COPPICE_CHECK(add_own(node));
        std::vector<SceneReference> kept;
        for (SceneReference& reference : node.file.references) {
            COPPICE_TRY(const uint32_t child, find_or_read(node, reference));
            COPPICE_CHECK(add_reference(node, reference, tree_.nodes[child]));
            if (tree_.nodes[child].plant_count == 0) continue;
            kept.push_back(std::move(reference));
            node.children.push_back(child);
        }
        node.file.references = std::move(kept);
        chain_.leave();
        tree_.nodes.push_back(std::move(node));
        known_[key] = uint32_t(tree_.nodes.size() - 1);
        return uint32_t(tree_.nodes.size() - 1);
    }

    Status add_own(SceneNode& node) {
        const bool root = chain_.length() == 1;
        for (const SceneModel& model : node.file.scene.models) {
            auto [found, added] =
                models_.try_emplace(std::tuple(model.source_path, model.variation, model.importance, model.color_variation),
                                    uint32_t(tree_.models.size()));
            // The root's plants keep their models, also where two are alike.
            if (added || root) tree_.models.push_back(model);
            node.models.push_back(root ? uint32_t(node.models.size()) : found->second);
        }
        if (tree_.models.size() > k_model_limit)
            return fail(ErrorId::limit_exceeded, node.file.scene.path, "plants",
                        fmt::format("{} models with those of the files before", tree_.models.size()),
                        fmt::format("at most {} in all", k_model_limit));
        for (const PlantGroup& group : node.file.groups) {
            node.plant_count += group.plants.size();
            for (const Placement& plant : group.plants) {
                node.reach_m = std::max(node.reach_m, glm::length(plant.position_world));
                node.scale_least = std::min(node.scale_least, double(plant.scale));
                node.scale_most = std::max(node.scale_most, double(plant.scale));
            }
        }
        // Every file read stands at least once, so their sum is a lower bound of the scene's plants.
        own_plants_ += node.plant_count;
        return check_count(node, "placements", own_plants_);
    }

    Result<uint32_t> find_or_read(const SceneNode& node, const SceneReference& reference) {
        const std::string& file = node.file.scene.path;
        const std::string place = reference.place + ".scene";
        const std::string key = file_key(reference.path);
        COPPICE_CHECK(chain_.check_is_new(reference.path, place));
        if (auto found = known_.find(key); found != known_.end()) return found->second;
        COPPICE_CHECK(chain_.check_depth(reference.path, place, 0));
        auto read = read_scene_file(reference.path, settings_, SceneRole::referenced);
        if (!read &&
            (read.error().id == ErrorId::file_missing || read.error().id == ErrorId::file_unreadable))
            return fail(read.error().id, file, place,
                        fmt::format("'{}': {}", reference.path, read.error().fault), read.error().remedy);
        if (!read) return fail(std::move(read.error()));
        return add(std::move(*read), key);
    }

    Status add_reference(SceneNode& node, const SceneReference& reference, const SceneNode& child) {
        node.depth = std::max(node.depth, child.depth + 1);
        // A file read before, on a shorter way.
        COPPICE_CHECK(chain_.check_depth(reference.path, reference.place + ".scene", child.depth));
        if (child.plant_count == 0) return {};
        // Both factors are at most k_plant_limit.
        node.plant_count += reference.copy_count() * child.plant_count;
        COPPICE_CHECK(check_count(node, reference.place, node.plant_count));

        double grid_x = (reference.columns - 1) * 0.5 * reference.spacing_m;
        double grid_z = (reference.rows - 1) * 0.5 * reference.spacing_m;
        double reach_m = glm::length(reference.at) + std::sqrt(grid_x * grid_x + grid_z * grid_z) +
                         reference.scale * child.reach_m;
        if (!(reach_m <= k_reach_limit_m))
            return fail(ErrorId::value_out_of_range, node.file.scene.path, reference.place,
                        fmt::format("reaches {:.3g} m from the origin", reach_m),
                        fmt::format("at most {:g} m: nearer, fewer or smaller", k_reach_limit_m));
        node.reach_m = std::max(node.reach_m, reach_m);
        double least = reference.scale * child.scale_least, most = reference.scale * child.scale_most;
        if (!(least >= k_scale_product_least && most <= k_scale_product_most))
            return fail(ErrorId::value_out_of_range, node.file.scene.path, reference.place + ".scale",
                        fmt::format("its plants come to scales from {:.3g} to {:.3g}", least, most),
                        fmt::format("all scales multiplied from {:g} to {:g}", k_scale_product_least,
                                    k_scale_product_most));
        node.scale_least = std::min(node.scale_least, least);
        node.scale_most = std::max(node.scale_most, most);
        return {};
    }

    Status check_count(const SceneNode& node, const std::string& place, uint64_t count) const {
        if (count <= k_plant_limit) return {};
        return fail(ErrorId::limit_exceeded, node.file.scene.path, place,
                    fmt::format("{} plants with those before", count),
                    fmt::format("at most {} in a scene", k_plant_limit));
    }

    const SceneLoadSettings& settings_;
    SceneTree tree_;
    FileChain chain_;
    std::map<std::string, uint32_t> known_;
    std::map<std::tuple<std::string, uint64_t, float, ColorVariation>, uint32_t> models_;
    uint64_t own_plants_ = 0;
};

}  // namespace

Result<SceneTree> read_scene_tree(const std::string& path, const SceneLoadSettings& settings) {
    return TreeReader(settings).read(path);
}

}  // namespace coppice
