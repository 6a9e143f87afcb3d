#include "plugins/vegetation/eco/mosaic_tree.h"

#include <algorithm>
#include <map>
#include <fmt/format.h>
#include "plugins/vegetation/eco/file_chain.h"
#include "plugins/vegetation/eco/tile_pack.h"
#include "runtime/core/hash.h"

namespace coppice {
namespace {

class MosaicReader {
  public:
    explicit MosaicReader(const std::string& path) : root_folder_(folder_of(path)) {}

    Result<MosaicTree> read(const std::string& path) {
        COPPICE_TRY(MosaicFile root, read_file(path));
        COPPICE_CHECK(add(path, std::move(root)));
        tree_.nodes.back().folder.clear();
        return std::move(tree_);
    }

  private:
    static std::filesystem::path folder_of(const std::string& path) {
        return std::filesystem::path(file_key(path)).parent_path();
    }

    static Result<MosaicFile> read_file(const std::string& path) {
        return read_mosaic_file(path, [](double, double) { return 0.0; });
    }

    // The same wherever the whole of the files lies.
    std::string folder_name(const std::string& path) const {
        const std::string stem = std::filesystem::path(path).stem().stem().string();
        const std::string way =
            std::filesystem::path(file_key(path)).lexically_relative(root_folder_).generic_string();
        return stem + "-" + hash_to_hex(hash_text(way));
    }

    Result<uint32_t> add(const std::string& path, MosaicFile file) {
        chain_.enter(path);
        MosaicNode node;
        node.path = path;
        node.folder = folder_name(path);
        node.file = std::move(file);
        if (!node.file.places.empty()) node.scene_count = 0;
        for (const PlacedScene& placed : node.file.places) {
            COPPICE_TRY(const uint32_t below, find_or_read(placed));
            COPPICE_CHECK(add_place(node, placed, tree_.nodes[below]));
            node.scenes.push_back(below);
        }
        chain_.leave();
        tree_.nodes.push_back(std::move(node));
        known_[file_key(path)] = uint32_t(tree_.nodes.size() - 1);
        return uint32_t(tree_.nodes.size() - 1);
    }

    Result<uint32_t> find_or_read(const PlacedScene& placed) {
        const std::string place = placed.place + ".scene";
        COPPICE_CHECK(chain_.check_is_new(placed.path, place));
        if (auto found = known_.find(file_key(placed.path)); found != known_.end()) return found->second;
        COPPICE_CHECK(chain_.check_depth(placed.path, place, 0));
        auto read = read_file(placed.path);
        if (!read && read.error().file == placed.path &&
            (read.error().id == ErrorId::file_missing || read.error().id == ErrorId::file_unreadable))
            return fail(read.error().id, chain_.last(), place,
                        fmt::format("'{}': {}", placed.path, read.error().fault), read.error().remedy);
        if (!read) return fail(std::move(read.error()));
        return add(placed.path, std::move(*read));
    }

    Status add_place(MosaicNode& node, const PlacedScene& placed, const MosaicNode& below) {
        // A file read before, on a shorter way.
        COPPICE_CHECK(chain_.check_depth(placed.path, placed.place + ".scene", below.depth));
        node.depth = std::max(node.depth, below.depth + 1);
        if (!add_product(node.scene_count, placed.copy_count(), below.scene_count))
            return fail(ErrorId::limit_exceeded, node.path, placed.place, "more than 2^64 scenes in all",
                        "fewer places");
        const double grid_m = glm::length(placed.origin_of(0) - placed.at);  // to each of its corners
        node.reach_m = std::max(node.reach_m, glm::length(placed.at) + grid_m + below.reach_m);
        if (node.reach_m > k_origin_reach_m)
            return fail(ErrorId::value_out_of_range, node.path, placed.place,
                        fmt::format("reaches {:.3g} m from the origin", node.reach_m),
                        fmt::format("at most {:g} m: nearer, or fewer", k_origin_reach_m));
        return {};
    }

    const std::filesystem::path root_folder_;
    MosaicTree tree_;
    FileChain chain_;
    std::map<std::string, uint32_t> known_;
};

}  // namespace

Result<MosaicTree> read_mosaic_tree(const std::string& path) { return MosaicReader(path).read(path); }

bool add_product(uint64_t& sum, uint64_t a, uint64_t b) {
    if (a != 0 && b > UINT64_MAX / a) return false;
    if (a * b > UINT64_MAX - sum) return false;
    sum += a * b;
    return true;
}

}  // namespace coppice
