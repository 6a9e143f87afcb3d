#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <vector>
#include "plugins/vegetation/plant/check_part.h"
#include "plugins/vegetation/plant/description.h"
#include "plugins/vegetation/plant/format.h"
#include "plugins/vegetation/plant/leaf_bands.h"
#include "plugins/vegetation/plant/plant.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

constexpr const char* k_remedy = "packed plants are a cache: cook the plant again";
constexpr const char* k_block_names[k_block_count] = {"parts",        "triangle vertices", "points",
                                                      "point owners", "line vertices",     "cells",
                                                      "crowns",       "leaves"};
constexpr uint64_t k_item_bytes[k_block_count] = {sizeof(PackedPart),   sizeof(PackedVertex),
                                                  sizeof(PackedVertex), sizeof(uint32_t),
                                                  sizeof(PackedVertex), sizeof(PackedPart),
                                                  sizeof(PackedCrown),  sizeof(PackedLeaf)};

bool positions_usable(std::span<const PackedVertex> vertices) {
    std::atomic<bool> usable{true};
    parallel_for(vertices.size(), 1 << 16, [&](size_t first, size_t last) {
        bool all = true;
        for (size_t i = first; i < last; ++i) {
            const PackedVertex& v = vertices[i];
            all &= std::fabs(v.x_plant) <= k_position_limit_m && std::fabs(v.y_plant) <= k_position_limit_m &&
                   std::fabs(v.z_plant) <= k_position_limit_m;  // false for NaN
        }
        if (!all) usable = false;
    });
    return usable;
}

bool all_finite(std::span<const float> values) {
    for (float v : values)
        if (!std::isfinite(v)) return false;
    return true;
}

// Where a part's ranges must begin: parts follow each other without gaps, so that every primitive belongs to
// one part and is checked once.
struct PartBegin {
    uint64_t triangle = 0, point = 0, line = 0;
};

// Null where the part can be used, else what is wrong with it. Moves `begin` behind the part.
const char* fault_of_part(const PackedPart& part, const Plant& plant, PartBegin& begin) {
    auto take = [](uint64_t first, uint64_t count, uint64_t limit, uint64_t& at) {
        bool fits = first == at && count <= limit - first;
        at += count;
        return fits;
    };
    if (const char* fault = fault_of_measures(part)) return fault;
    if (!take(part.first_triangle, part.triangle_count, plant.triangle_vertices.size() / 3, begin.triangle))
        return "triangles that do not follow the part before, or outside the file";
    if (!take(part.first_point, part.point_count, plant.points.size(), begin.point))
        return "points that do not follow the part before, or outside the file";
    if (!take(part.first_line, part.line_count, plant.line_vertices.size() / 2, begin.line))
        return "lines that do not follow the part before, or outside the file";
    for (int axis = 0; axis < 3; ++axis)
        if (!(part.bounds_min[axis] >= -k_position_limit_m &&
              part.bounds_min[axis] <= part.bounds_max[axis] && part.bounds_max[axis] <= k_position_limit_m))
            return "bounds that are no box within 100 km of the origin";
    for (uint32_t owner : plant.point_owners.subspan(part.first_point, part.point_count))
        if (owner >= part.triangle_count) return "a point of a triangle that does not exist";
    return nullptr;
}

// Null where the cells share out the triangles of the parts that they name, else what is wrong with cell
// `at`, behind which `begin` stands then.
const char* fault_of_cells(const Plant& plant, PartBegin& begin, size_t& at) {
    for (at = 0; at < plant.cells.size(); ++at) {
        const PackedPart& cell = plant.cells[at];
        const bool first = at == 0 || plant.cells[at - 1].part != cell.part;
        if (cell.part >= plant.parts.size() || (at > 0 && plant.cells[at - 1].part > cell.part))
            return "a cell of no part, or of one before the last cell's";
        const PackedPart& part = plant.parts[cell.part];
        if (cell.kind != part.kind) return "a cell of another kind than its part";
        if (first) begin.triangle = part.first_triangle;
        if (const char* fault = fault_of_part(cell, plant, begin)) return fault;
        const bool last = at + 1 == plant.cells.size() || plant.cells[at + 1].part != cell.part;
        const uint64_t end = uint64_t(part.first_triangle) + part.triangle_count;
        if (begin.triangle > end || (last && begin.triangle < end))
            return "cells that do not hold their part's triangles";
    }
    return nullptr;
}

// Of a band's list: in its order of removal nothing is removed before it is born, and each level of the band but the first
// has one leaf that is born with it, so that every level has as many leaves as it says.
bool births_fit(std::span<const PackedLeaf> list, const LeafBand& band, uint32_t full_count) {
    const uint32_t first_level = full_count - band.most, born_in_band = band.most - band.fewest;
    std::vector<bool> born(born_in_band, false);
    for (size_t i = 0; i < list.size(); ++i) {
        const uint32_t level = list[i].birth_level;
        if (level <= first_level) continue;
        const uint32_t born_at = level - first_level - 1;
        if (born_at >= born_in_band || born[born_at] || (i / 2 < born_in_band && born_at >= i / 2)) return false;
        born[born_at] = true;
    }
    return std::find(born.begin(), born.end(), false) == born.end();
}

// Null where the crowns share out the leaves, else what is wrong with crown `at`.
const char* fault_of_crowns(const Plant& plant, size_t& at) {
    uint64_t next = 0;
    for (at = 0; at < plant.crowns.size(); ++at) {
        const PackedCrown& crown = plant.crowns[at];
        if (crown.part >= plant.parts.size() || (at > 0 && plant.crowns[at - 1].part >= crown.part))
            return "of no part, or not behind that of the part before";
        if (plant.parts[crown.part].kind != PackedPartKind::points) return "of a part of lines";
        if (crown.least_count == 0 || crown.least_count > crown.full_count ||
            crown.full_count > k_most_crown_leaves)
            return "levels that have no leaf or more than there are";
        const uint64_t count = banded_leaf_count(crown.full_count, crown.least_count);
        if (crown.first_leaf != next || count > plant.leaves.size() - next)
            return "leaves that do not follow the crown before, or outside the file";
        LeafBand band = first_band(crown.full_count, crown.least_count);
        while (true) {
            if (!births_fit(plant.leaves.subspan(next + band.first, band.size()), band, crown.full_count))
                return "a leaf that is removed before it is born, or two of one birth";
            if (band.is_last(crown.least_count)) break;
            band = next_band(band, crown.least_count);
        }
        next += count;
    }
    at = plant.crowns.size();
    return next == plant.leaves.size() ? nullptr : "leaves that belong to no crown";
}

Result<Plant> view_plant(std::span<const std::byte> bytes, const std::string& file) {
    if (bytes.size() < sizeof(PlantFileHead)) {
        if (bytes.size() < 4 || std::memcmp(bytes.data(), k_plant_magic, 4) != 0)
            return fail(ErrorId::format_unknown, file, "", "not a packed plant", "name a .plant file");
        return fail(ErrorId::file_truncated, file, "", "it ends inside its head", k_remedy);
    }
    PlantFileHead head;
    std::memcpy(&head, bytes.data(), sizeof head);
    if (std::memcmp(head.magic, k_plant_magic, sizeof head.magic) != 0)
        return fail(ErrorId::format_unknown, file, "byte 0", "not a packed plant", "name a .plant file");
    if (head.version != k_plant_version)
        return fail(
            ErrorId::format_unknown, file, "byte 4", "version " + std::to_string(head.version),
            "this program reads version " + std::to_string(k_plant_version) + "; cook the plant again");
    uint64_t checksum = head.head_checksum;
    head.head_checksum = 0;
    if (hash_bytes(&head, sizeof head) != checksum)
        return fail(ErrorId::file_corrupt, file, "head", "its checksum is wrong", k_remedy);
    if (head.file_bytes != bytes.size())
        return fail(bytes.size() < head.file_bytes ? ErrorId::file_truncated : ErrorId::file_corrupt, file,
                    "",
                    "it has " + std::to_string(bytes.size()) + " bytes and announces " +
                        std::to_string(head.file_bytes),
                    k_remedy);

    uint64_t offset = sizeof head;
    for (uint32_t b = 0; b < k_block_count; ++b) {
        const PlantBlockPlace& place = head.blocks[b];
        // Checked by division first, so that no product below can wrap.
        if (place.offset_bytes != offset || place.item_count > (bytes.size() - offset) / k_item_bytes[b])
            return fail(ErrorId::file_corrupt, file, k_block_names[b], "the block lies outside the file",
                        k_remedy);
        uint64_t block_bytes = padded_to_block(place.item_count * k_item_bytes[b]);
        if (block_bytes > bytes.size() - offset)
            return fail(ErrorId::file_corrupt, file, k_block_names[b], "the block lies outside the file",
                        k_remedy);
        if (hash_bytes(bytes.data() + offset, block_bytes) != place.checksum)
            return fail(ErrorId::file_corrupt, file, k_block_names[b], "the checksum is wrong", k_remedy);
        offset += block_bytes;
    }
    if (offset != bytes.size())
        return fail(ErrorId::file_corrupt, file, "byte " + std::to_string(offset),
                    "bytes behind the last block", k_remedy);
    if (std::memchr(head.name, 0, sizeof head.name) == nullptr)
        return fail(ErrorId::value_out_of_range, file, "head", "the name does not end", k_remedy);

    auto span_of = [&]<class T>(PlantBlock b, const T*) {
        return std::span(reinterpret_cast<const T*>(bytes.data() + head.blocks[b].offset_bytes),
                         size_t(head.blocks[b].item_count));
    };
    Plant plant;
    plant.name = head.name;
    plant.bounds_plant.min = vec3(head.bounds_min[0], head.bounds_min[1], head.bounds_min[2]);
    plant.bounds_plant.max = vec3(head.bounds_max[0], head.bounds_max[1], head.bounds_max[2]);
    plant.content_hash = checksum;
    plant.parts = span_of(k_block_parts, static_cast<const PackedPart*>(nullptr));
    plant.triangle_vertices = span_of(k_block_triangle_vertices, static_cast<const PackedVertex*>(nullptr));
    plant.points = span_of(k_block_points, static_cast<const PackedVertex*>(nullptr));
    plant.point_owners = span_of(k_block_point_owners, static_cast<const uint32_t*>(nullptr));
    plant.line_vertices = span_of(k_block_line_vertices, static_cast<const PackedVertex*>(nullptr));
    plant.cells = span_of(k_block_cells, static_cast<const PackedPart*>(nullptr));
    plant.crowns = span_of(k_block_crowns, static_cast<const PackedCrown*>(nullptr));
    plant.leaves = span_of(k_block_leaves, static_cast<const PackedLeaf*>(nullptr));
    plant.dropped_triangles = head.dropped_triangles;
    plant.dropped_vertices = head.dropped_vertices;

    auto wrong = [&file](std::string place, std::string fault) {
        return fail(ErrorId::value_out_of_range, file, std::move(place), std::move(fault), k_remedy);
    };
    if (plant.triangle_vertices.size() % 3 != 0) return wrong("triangle vertices", "not three a triangle");
    if (plant.line_vertices.size() % 2 != 0) return wrong("line vertices", "not two a line");
    if (plant.point_owners.size() != plant.points.size()) return wrong("point owners", "not one a point");
    if (!all_finite(head.bounds_min) || !all_finite(head.bounds_max) || plant.bounds_plant.empty())
        return wrong("head", "the bounds are not a box");
    PartBegin begin;
    for (size_t i = 0; i < plant.parts.size(); ++i)
        if (const char* fault = fault_of_part(plant.parts[i], plant, begin))
            return wrong("parts[" + std::to_string(i) + "]", fault);
    const bool all_triangles = begin.triangle == plant.triangle_vertices.size() / 3;
    size_t cell = 0;
    if (const char* fault = fault_of_cells(plant, begin, cell))
        return wrong("cells[" + std::to_string(cell) + "]", fault);
    if (!all_triangles || begin.point != plant.points.size() || begin.line != plant.line_vertices.size() / 2)
        return wrong("parts", "triangles, points or lines that belong to no part");
    size_t crown = 0;
    if (const char* fault = fault_of_crowns(plant, crown))
        return wrong("crowns[" + std::to_string(crown) + "]", fault);
    constexpr const char* k_far = "a position that is not finite, or further than 100 km from the origin";
    if (!positions_usable(plant.triangle_vertices)) return wrong("triangle vertices", k_far);
    if (!positions_usable(plant.points)) return wrong("points", k_far);
    if (!positions_usable(plant.line_vertices)) return wrong("line vertices", k_far);
    for (size_t i = 1; i < plant.line_vertices.size(); i += 2)
        if (float width = std::bit_cast<float>(plant.line_vertices[i].surface);
            !(width > 0.0f && width <= 100.0f))
            return wrong("line vertices", "a width that is not in (0, 100]");
    return plant;
}

}  // namespace

Result<Plant> load_plant(const std::string& path) {
    COPPICE_TRY(MappedFile mapped, MappedFile::open(path));
    auto file = std::make_shared<const MappedFile>(std::move(mapped));
    COPPICE_TRY(Plant plant, view_plant(file->bytes(), path));
    plant.file = std::move(file);
    return plant;
}

Result<Plant> load_plant_from_memory(std::shared_ptr<const std::vector<std::byte>> bytes,
                                     const std::string& name) {
    COPPICE_TRY(Plant plant, view_plant(*bytes, name));
    plant.memory = std::move(bytes);
    return plant;
}

}  // namespace coppice
