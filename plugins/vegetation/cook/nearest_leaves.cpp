#include "plugins/vegetation/cook/nearest_leaves.h"

#include <algorithm>
#include <bit>
#include <tuple>

namespace coppice {
namespace {

constexpr uint32_t k_bucket_size = 8;
constexpr uint32_t k_gone = UINT32_MAX;

float distance_square(const Box& box, vec3 p) {
    const vec3 away = glm::max(glm::max(box.min - p, p - box.max), vec3(0));
    return glm::dot(away, away);
}

}  // namespace

NearestLeaves::NearestLeaves(std::vector<Entry> entries, uint32_t leaf_limit)
    : entries_(std::move(entries)), slot_of_(leaf_limit, k_gone), bucket_of_slot_(entries_.size()) {
    const uint32_t count = uint32_t(entries_.size());
    bucket_count_ = std::bit_ceil(count / k_bucket_size + 1);
    nodes_.resize(2 * size_t(bucket_count_) - 1);
    bucket_first_.resize(bucket_count_ + 1, 0);
    build(0, 0, count);
    bucket_first_[bucket_count_] = count;
    for (uint32_t slot = 0; slot < count; ++slot) slot_of_[entries_[slot].leaf] = slot;
}

void NearestLeaves::build(uint32_t node, uint32_t first, uint32_t last) {
    nodes_[node].count = last - first;
    Box& box = nodes_[node].box;
    for (uint32_t i = first; i < last; ++i) box.include(entries_[i].place);
    if (node + 1 >= bucket_count_) {
        const uint32_t bucket = node + 1 - bucket_count_;
        bucket_first_[bucket] = first;
        for (uint32_t i = first; i < last; ++i) bucket_of_slot_[i] = bucket;
        return;
    }
    const uint32_t middle = first + (last - first) / 2;
    if (first < last) {
        const vec3 size = box.size();
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        std::nth_element(entries_.begin() + first, entries_.begin() + middle, entries_.begin() + last,
                         [axis](const Entry& a, const Entry& b) {
                             return std::tie(a.place[axis], a.leaf) < std::tie(b.place[axis], b.leaf);
                         });
    }
    build(2 * node + 1, first, middle);
    build(2 * node + 2, middle, last);
}

void NearestLeaves::remove(uint32_t leaf) {
    const uint32_t slot = slot_of_[leaf];
    entries_[slot].leaf = k_gone;
    slot_of_[leaf] = k_gone;
    for (uint32_t node = bucket_count_ - 1 + bucket_of_slot_[slot];; node = (node - 1) / 2) {
        --nodes_[node].count;
        if (node == 0) break;
    }
}

void NearestLeaves::replace(uint32_t leaf, Entry by) {
    const uint32_t slot = slot_of_[leaf];
    slot_of_[leaf] = k_gone;
    slot_of_[by.leaf] = slot;
    entries_[slot] = by;
    for (uint32_t node = bucket_count_ - 1 + bucket_of_slot_[slot];; node = (node - 1) / 2) {
        nodes_[node].box.include(by.place);
        if (node == 0) break;
    }
}

std::vector<NearestLeaves::Entry> NearestLeaves::entries() const {
    std::vector<Entry> left;
    std::copy_if(entries_.begin(), entries_.end(), std::back_inserter(left),
                 [](const Entry& e) { return e.leaf != k_gone; });
    return left;
}

void NearestLeaves::find(vec3 place, uint32_t leaf, uint32_t count, std::vector<Neighbor>& neighbors) const {
    neighbors.clear();
    if (count > 0) search(0, place, leaf, count, neighbors);
    std::sort(neighbors.begin(), neighbors.end());
}

void NearestLeaves::search(uint32_t node, vec3 place, uint32_t leaf, uint32_t count,
                           std::vector<Neighbor>& heap) const {
    if (node + 1 >= bucket_count_) {
        const uint32_t bucket = node + 1 - bucket_count_;
        for (uint32_t slot = bucket_first_[bucket]; slot < bucket_first_[bucket + 1]; ++slot) {
            const Entry& entry = entries_[slot];
            if (entry.leaf == k_gone || entry.leaf == leaf) continue;
            const vec3 away = entry.place - place;
            const Neighbor found{glm::dot(away, away), entry.leaf};
            if (heap.size() == count) {
                if (!(found < heap.front())) continue;
                std::pop_heap(heap.begin(), heap.end());
                heap.pop_back();
            }
            heap.push_back(found);
            std::push_heap(heap.begin(), heap.end());
        }
        return;
    }
    uint32_t child[2] = {2 * node + 1, 2 * node + 2};
    float distance[2] = {distance_square(nodes_[child[0]].box, place),
                         distance_square(nodes_[child[1]].box, place)};
    if (distance[1] < distance[0]) std::swap(child[0], child[1]), std::swap(distance[0], distance[1]);
    for (int i = 0; i < 2; ++i)
        // At the same distance a lower number may still be found.
        if (nodes_[child[i]].count > 0 &&
            (heap.size() < count || distance[i] <= heap.front().distance_square_m2))
            search(child[i], place, leaf, count, heap);
}

}  // namespace coppice
