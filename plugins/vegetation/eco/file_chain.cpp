#include "plugins/vegetation/eco/file_chain.h"

#include <filesystem>
#include <fmt/format.h>

namespace coppice {

std::string file_key(const std::string& path) {
    std::error_code error;
    std::filesystem::path key = std::filesystem::weakly_canonical(path, error);
    return error ? path : key.string();
}

Status FileChain::check_is_new(const std::string& path, const std::string& place) const {
    const std::string key = file_key(path);
    for (size_t i = 0; i < links_.size(); ++i) {
        if (links_[i].key != key) continue;
        std::string way;
        for (size_t k = i; k < links_.size(); ++k) way += links_[k].path + " -> ";
        return fail(ErrorId::value_out_of_range, links_.back().path, place,
                    "a scene in itself: " + way + links_[i].path, "take one of these references out");
    }
    return {};
}

Status FileChain::check_depth(const std::string& path, const std::string& place, uint32_t depth) const {
    if (links_.size() + depth <= k_reference_depth_limit) return {};
    return fail(ErrorId::limit_exceeded, links_.back().path, place,
                fmt::format("'{}': more than {} scenes inside each other", path, k_reference_depth_limit),
                "refer to it from a scene nearer to the first");
}

}  // namespace coppice
